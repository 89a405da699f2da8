/* FMI 3.0 (3.0.2), co-simulation and model exchange: each function of the standard hands over to component.c. What the
 * model has not (other types, clocks, arrays) is in fmi3_absent.c. */

FMI3_EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

FMI3_EXPORT fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t n,
                                           const fmi3String categories[]) {
    dp_component *c = (dp_component *)instance;
    if (!c) return fmi3Error;
    if (n > 0 && !categories) return (fmi3Status)dp_null(c, "SetDebugLogging");
    c->host.talkative = on; /* refusals and failures are never kept quiet */
    return fmi3OK;
}

FMI3_EXPORT fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources,
                                                      fmi3Boolean visible, fmi3Boolean logging,
                                                      fmi3InstanceEnvironment environment,
                                                      fmi3LogMessageCallback log) {
    dp_host host;
    (void)resources, (void)visible;
    host.environment = environment;
    host.log = log;
    host.talkative = logging;
    return dp_instantiate(&host, name, token, 1, "InstantiateModelExchange");
}

FMI3_EXPORT fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources,
                                                     fmi3Boolean visible, fmi3Boolean logging, fmi3Boolean event_mode,
                                                     fmi3Boolean early_return, const fmi3ValueReference required[],
                                                     size_t n, fmi3InstanceEnvironment environment,
                                                     fmi3LogMessageCallback log,
                                                     fmi3IntermediateUpdateCallback update) {
    dp_host host;
    (void)resources, (void)visible, (void)event_mode, (void)early_return, (void)required, (void)n, (void)update;
    host.environment = environment;
    host.log = log;
    host.talkative = logging;
    return dp_instantiate(&host, name, token, 0, "InstantiateCoSimulation");
}

FMI3_EXPORT void fmi3FreeInstance(fmi3Instance instance) { dp_free((dp_component *)instance); }

/* Modes ---------------------------------------------------------------------------------------------------------- */

FMI3_EXPORT fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean has_tolerance,
                                                   fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean has_stop,
                                                   fmi3Float64 stop) {
    dp_component *c = (dp_component *)instance;
    const char *const here = "EnterInitializationMode";
    (void)has_tolerance, (void)tolerance; /* the internal step is fixed, far below any sensible tolerance */
    if (dp_refused(c, DP_NEW, here) || dp_begin(c, start, has_stop, stop, here) != DP_FINE) return fmi3Error;
    c->state.mode = DP_INITIALISING;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    return (fmi3Status)dp_initialised((dp_component *)c, "ExitInitializationMode");
}

FMI3_EXPORT fmi3Status fmi3Terminate(fmi3Instance c) {
    return (fmi3Status)dp_terminate((dp_component *)c, "Terminate");
}

FMI3_EXPORT fmi3Status fmi3Reset(fmi3Instance c) { return (fmi3Status)dp_reset((dp_component *)c); }

/* Values --------------------------------------------------------------------------------------------------------- */

/* Every variable is one number, so that there are as many values as references. */
static int dp_uneven(const dp_component *c, size_t references, size_t values, const char *function) {
    if (!c || references == values) return 0;
    return dp_report(c, DP_ERROR, "fmi3%s: %u values for %u references", function, (unsigned)values,
                     (unsigned)references);
}

FMI3_EXPORT fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                      fmi3Float64 value[], size_t values) {
    dp_component *c = (dp_component *)instance;
    if (dp_uneven(c, n, values, "GetFloat64")) return fmi3Error;
    return (fmi3Status)dp_get_reals(c, vr, n, value, "GetFloat64");
}

FMI3_EXPORT fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                      const fmi3Float64 value[], size_t values) {
    dp_component *c = (dp_component *)instance;
    if (dp_uneven(c, n, values, "SetFloat64")) return fmi3Error;
    return (fmi3Status)dp_set_reals(c, vr, n, value, "SetFloat64");
}

FMI3_EXPORT fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknown[], size_t n,
                                                    const fmi3ValueReference known[], size_t m,
                                                    const fmi3Float64 seed[], size_t seeds, fmi3Float64 sensitivity[],
                                                    size_t sensitivities) {
    dp_component *c = (dp_component *)instance;
    const char *const here = "GetDirectionalDerivative";
    if (dp_uneven(c, m, seeds, here) || dp_uneven(c, n, sensitivities, here)) return fmi3Error;
    return (fmi3Status)dp_derivative(c, unknown, n, known, m, seed, sensitivity, here);
}

/* The directions of the known variables one by one: there are few. */
FMI3_EXPORT fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference unknown[], size_t n,
                                                const fmi3ValueReference known[], size_t m, const fmi3Float64 seed[],
                                                size_t seeds, fmi3Float64 sensitivity[], size_t sensitivities) {
    dp_component *c = (dp_component *)instance;
    const char *const here = "GetAdjointDerivative";
    const double one = 1.0;
    size_t i, j;
    int status;
    if (dp_uneven(c, n, seeds, here) || dp_uneven(c, m, sensitivities, here)) return fmi3Error;
    if (dp_refused(c, DP_INITIALISING | DP_RUNNING | DP_ENDED, here)) return fmi3Error;
    if (dp_bad_references(c, unknown, n, seed, here) || dp_bad_references(c, known, m, sensitivity, here))
        return fmi3Error;
    for (j = 0; j < m; ++j) {
        double sum = 0.0;
        for (i = 0; i < n; ++i) {
            double part;
            status = dp_derivative(c, &unknown[i], 1, &known[j], 1, &one, &part, here);
            if (status != DP_FINE) return (fmi3Status)status;
            sum += seed[i] * part;
        }
        sensitivity[j] = sum;
    }
    return fmi3OK;
}

/* Co-simulation -------------------------------------------------------------------------------------------------- */

FMI3_EXPORT fmi3Status fmi3EnterStepMode(fmi3Instance c) {
    return (fmi3Status)dp_unsupported((dp_component *)c, "EnterStepMode"); /* co-simulation without event mode */
}

FMI3_EXPORT fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference vr[], size_t n,
                                                const fmi3Int32 order[], fmi3Float64 value[], size_t values) {
    dp_component *c = (dp_component *)instance;
    if (dp_uneven(c, n, values, "GetOutputDerivatives")) return fmi3Error;
    return (fmi3Status)dp_output_rates(c, vr, n, order, value, "GetOutputDerivatives");
}

FMI3_EXPORT fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 t, fmi3Float64 dt, fmi3Boolean no_set_before,
                                  fmi3Boolean *event, fmi3Boolean *end, fmi3Boolean *early, fmi3Float64 *last) {
    dp_component *c = (dp_component *)instance;
    int status;
    (void)no_set_before;
    status = dp_do_step(c, t, dt, "DoStep");
    if (event) *event = false;
    if (end) *end = false; /* the model never asks for the end */
    if (early) *early = false;
    if (last && c) *last = c->state.model.engine.t;
    return (fmi3Status)status;
}

/* Model exchange ------------------------------------------------------------------------------------------------- */

FMI3_EXPORT fmi3Status fmi3EnterEventMode(fmi3Instance c) {
    return (fmi3Status)dp_enter((dp_component *)c, DP_CONTINUOUS | DP_EVENT, DP_EVENT, "EnterEventMode");
}

FMI3_EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c) {
    if (dp_refused((dp_component *)c, DP_INITIALISING | DP_EVENT, "EvaluateDiscreteStates")) return fmi3Error;
    return fmi3OK; /* nothing depends on their new values before they are taken */
}

FMI3_EXPORT fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *again, fmi3Boolean *end,
                                                fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
                                                fmi3Boolean *next_defined, fmi3Float64 *next) {
    dp_component *c = (dp_component *)instance;
    int changed = 0, status;
    if (c && !(again && end && nominals_changed && values_changed && next_defined && next))
        return (fmi3Status)dp_null(c, "UpdateDiscreteStates");
    status = dp_update(c, &changed, "UpdateDiscreteStates");
    if (status != DP_FINE) return (fmi3Status)status;
    *again = *end = *nominals_changed = *next_defined = false;
    *values_changed = changed != 0;
    *next = 0.0;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c) {
    return (fmi3Status)dp_enter((dp_component *)c, DP_EVENT, DP_CONTINUOUS, "EnterContinuousTimeMode");
}

FMI3_EXPORT fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean no_set_before,
                                                   fmi3Boolean *event, fmi3Boolean *end) {
    dp_component *c = (dp_component *)instance;
    (void)no_set_before;
    if (dp_refused(c, DP_CONTINUOUS, "CompletedIntegratorStep")) return fmi3Error;
    if (!event || !end) return (fmi3Status)dp_null(c, "CompletedIntegratorStep");
    *event = *end = false; /* all events have indicators */
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 t) {
    return (fmi3Status)dp_set_time((dp_component *)c, t, "SetTime");
}

FMI3_EXPORT fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 x[], size_t n) {
    return (fmi3Status)dp_set_states((dp_component *)c, x, n, "SetContinuousStates");
}

FMI3_EXPORT fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 value[], size_t n) {
    return (fmi3Status)dp_get_states((dp_component *)c, value, n, "GetContinuousStates");
}

FMI3_EXPORT fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 value[], size_t n) {
    return (fmi3Status)dp_get_rates((dp_component *)c, value, n, "GetContinuousStateDerivatives");
}

FMI3_EXPORT fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 value[], size_t n) {
    return (fmi3Status)dp_get_indicators((dp_component *)c, value, n, "GetEventIndicators");
}

FMI3_EXPORT fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance c, fmi3Float64 value[], size_t n) {
    return (fmi3Status)dp_get_nominals((dp_component *)c, value, n, "GetNominalsOfContinuousStates");
}

static fmi3Status dp_count(const dp_component *c, size_t count, size_t *n, const char *function) {
    if (!c) return fmi3Error;
    if (!n) return (fmi3Status)dp_null(c, function);
    *n = count;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance c, size_t *n) {
    return dp_count((dp_component *)c, DP_OWN, n, "GetNumberOfContinuousStates");
}

FMI3_EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance c, size_t *n) {
    return dp_count((dp_component *)c, DP_NS, n, "GetNumberOfEventIndicators");
}

/* Stored states -------------------------------------------------------------------------------------------------- */

FMI3_EXPORT fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *state) {
    return (fmi3Status)dp_get_state((dp_component *)c, state, "GetFMUState");
}

FMI3_EXPORT fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
    return (fmi3Status)dp_set_state((dp_component *)c, state, "SetFMUState");
}

FMI3_EXPORT fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) {
    return (fmi3Status)dp_free_state((dp_component *)c, state);
}

FMI3_EXPORT fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size) {
    return (fmi3Status)dp_state_size((dp_component *)c, state, size, "SerializedFMUStateSize");
}

FMI3_EXPORT fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    return (fmi3Status)dp_serialise((dp_component *)c, state, bytes, size, "SerializeFMUState");
}

FMI3_EXPORT fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size,
                                               fmi3FMUState *state) {
    return (fmi3Status)dp_deserialise((dp_component *)c, bytes, size, state, "DeserializeFMUState");
}
