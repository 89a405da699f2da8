/* FMI 2.0 (2.0.5), co-simulation and model exchange: each function of the standard hands over to component.c. */

FMI2_EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }

FMI2_EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

FMI2_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t n,
                                           const fmi2String categories[]) {
    dp_component *c = (dp_component *)component;
    if (!c) return fmi2Error;
    if (n > 0 && !categories) return (fmi2Status)dp_null(c, "SetDebugLogging");
    c->host.talkative = on != fmi2False; /* refusals and failures are never kept quiet */
    return fmi2OK;
}

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions *call, fmi2Boolean visible, fmi2Boolean logging) {
    dp_host host;
    (void)resources, (void)visible;
    if (!call) return NULL;
    host.call = *call;
    host.talkative = logging != fmi2False;
    return dp_instantiate(&host, name, guid, type == fmi2ModelExchange ? 1 : type == fmi2CoSimulation ? 0 : -1,
                          "Instantiate");
}

FMI2_EXPORT void fmi2FreeInstance(fmi2Component component) { dp_free((dp_component *)component); }

/* Modes ---------------------------------------------------------------------------------------------------------- */

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
    dp_component *c = (dp_component *)component;
    (void)has_tolerance, (void)tolerance; /* the internal step is fixed, far below any sensible tolerance */
    if (dp_refused(c, DP_NEW, "SetupExperiment")) return fmi2Error;
    return (fmi2Status)dp_begin(c, start, has_stop, stop, "SetupExperiment");
}

FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
    dp_component *c = (dp_component *)component;
    if (dp_refused(c, DP_NEW, "EnterInitializationMode")) return fmi2Error;
    c->state.mode = DP_INITIALISING;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    return (fmi2Status)dp_initialised((dp_component *)c, "ExitInitializationMode");
}

FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component c) {
    return (fmi2Status)dp_terminate((dp_component *)c, "Terminate");
}

FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component c) { return (fmi2Status)dp_reset((dp_component *)c); }

/* Values --------------------------------------------------------------------------------------------------------- */

FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    return (fmi2Status)dp_get_reals((dp_component *)c, vr, n, value, "GetReal");
}

FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t n, const fmi2Real value[]) {
    return (fmi2Status)dp_set_reals((dp_component *)c, vr, n, value, "SetReal");
}

FMI2_EXPORT fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer value[]) {
    (void)vr, (void)value;
    return (fmi2Status)dp_no_variables((dp_component *)c, n, "GetInteger");
}

FMI2_EXPORT fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Boolean value[]) {
    (void)vr, (void)value;
    return (fmi2Status)dp_no_variables((dp_component *)c, n, "GetBoolean");
}

FMI2_EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[]) {
    (void)vr, (void)value;
    return (fmi2Status)dp_no_variables((dp_component *)c, n, "GetString");
}

FMI2_EXPORT fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                      const fmi2Integer value[]) {
    (void)vr, (void)value;
    return (fmi2Status)dp_no_variables((dp_component *)c, n, "SetInteger");
}

FMI2_EXPORT fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                      const fmi2Boolean value[]) {
    (void)vr, (void)value;
    return (fmi2Status)dp_no_variables((dp_component *)c, n, "SetBoolean");
}

FMI2_EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                     const fmi2String value[]) {
    (void)vr, (void)value;
    return (fmi2Status)dp_no_variables((dp_component *)c, n, "SetString");
}

FMI2_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n,
                                                    const fmi2ValueReference known[], size_t m, const fmi2Real seed[],
                                                    fmi2Real sensitivity[]) {
    return (fmi2Status)dp_derivative((dp_component *)c, unknown, n, known, m, seed, sensitivity,
                                     "GetDirectionalDerivative");
}

/* Co-simulation -------------------------------------------------------------------------------------------------- */

/* First to third derivative of the force, which then runs as a cubic. They hold for the next step only: forgotten ones
 * must not drive the model away. */
FMI2_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference vr[], size_t n,
                                                   const fmi2Integer order[], const fmi2Real value[]) {
    dp_component *c = (dp_component *)component;
    const char *const here = "SetRealInputDerivatives";
    size_t i;
    if (dp_refused(c, DP_NEW | DP_INITIALISING | DP_STEPPING, here)) return fmi2Error;
    if (dp_bad_references(c, vr, n, value, here)) return fmi2Error;
    if (n > 0 && !order) return (fmi2Status)dp_null(c, here);
    for (i = 0; i < n; ++i) {
        if (dp_variables[vr[i]].kind == DP_MOTION) continue; /* the next of the inputs says it */
        if (DP_GIVEN && dp_variables[vr[i]].kind == DP_PARAMETER) continue; /* a channel is held over a step */
        if (dp_variables[vr[i]].kind != DP_INPUT)
            return (fmi2Status)dp_report(c, DP_ERROR, "fmi2%s: %s is no input", here,
                                         dp_variables[vr[i]].name);
        if (order[i] < 1 || order[i] > DP_ORDERS || !isfinite(value[i]))
            return (fmi2Status)dp_report(c, DP_ERROR, "fmi2%s: takes finite derivatives of order 1 to %d", here,
                                         DP_ORDERS);
    }
    for (i = 0; i < n; ++i)
        if (dp_variables[vr[i]].kind == DP_INPUT) c->state.model.slope[order[i] - 1] = value[i];
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                                    const fmi2Integer order[], fmi2Real value[]) {
    return (fmi2Status)dp_output_rates((dp_component *)c, vr, n, order, value, "GetRealOutputDerivatives");
}

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real dt, fmi2Boolean no_set_before) {
    (void)no_set_before;
    return (fmi2Status)dp_do_step((dp_component *)c, t, dt, "DoStep");
}

FMI2_EXPORT fmi2Status fmi2CancelStep(fmi2Component component) {
    dp_component *c = (dp_component *)component;
    return c ? (fmi2Status)dp_report(c, DP_ERROR, "fmi2CancelStep: no step is under way") : fmi2Error;
}

/* Whether this status is not the one that can be asked for. */
static int dp_no_status(const dp_component *c, fmi2StatusKind kind, fmi2StatusKind known, const void *value,
                        const char *function, fmi2Status *answer) {
    *answer = fmi2OK;
    if (dp_refused(c, DP_STEPPING | DP_FAILED | DP_ENDED, function))
        *answer = fmi2Error;
    else if (!value)
        *answer = (fmi2Status)dp_null(c, function);
    else if (kind != known)
        *answer = (fmi2Status)dp_report(c, DP_DISCARD, "fmi2%s: no such status", function);
    return *answer != fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Status *value) {
    dp_component *c = (dp_component *)component;
    fmi2Status answer;
    if (dp_no_status(c, kind, fmi2DoStepStatus, value, "GetStatus", &answer)) return answer;
    *value = c->state.mode == DP_FAILED ? fmi2Discard : fmi2OK;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real *value) {
    dp_component *c = (dp_component *)component;
    fmi2Status answer;
    if (dp_no_status(c, kind, fmi2LastSuccessfulTime, value, "GetRealStatus", &answer)) return answer;
    *value = c->state.model.engine.t;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value) {
    fmi2Status answer;
    if (dp_no_status((dp_component *)component, kind, fmi2Terminated, value, "GetBooleanStatus", &answer)) return answer;
    *value = fmi2False; /* the model never asks for the end */
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Integer *value) {
    dp_component *c = (dp_component *)component;
    (void)kind, (void)value;
    return c ? (fmi2Status)dp_report(c, DP_DISCARD, "fmi2GetIntegerStatus: no such status") : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind kind, fmi2String *value) {
    dp_component *c = (dp_component *)component;
    (void)kind, (void)value;
    return c ? (fmi2Status)dp_report(c, DP_DISCARD, "fmi2GetStringStatus: no such status") : fmi2Error;
}

/* Model exchange ------------------------------------------------------------------------------------------------- */

FMI2_EXPORT fmi2Status fmi2EnterEventMode(fmi2Component c) {
    return (fmi2Status)dp_enter((dp_component *)c, DP_CONTINUOUS | DP_EVENT, DP_EVENT, "EnterEventMode");
}

FMI2_EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component component, fmi2EventInfo *info) {
    dp_component *c = (dp_component *)component;
    int changed = 0, status;
    if (c && !info) return (fmi2Status)dp_null(c, "NewDiscreteStates");
    status = dp_update(c, &changed, "NewDiscreteStates");
    if (status != DP_FINE) return (fmi2Status)status;
    memset(info, 0, sizeof *info);
    info->valuesOfContinuousStatesChanged = changed;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) {
    return (fmi2Status)dp_enter((dp_component *)c, DP_EVENT, DP_CONTINUOUS, "EnterContinuousTimeMode");
}

FMI2_EXPORT fmi2Status fmi2CompletedIntegratorStep(fmi2Component component, fmi2Boolean no_set_before,
                                                   fmi2Boolean *event, fmi2Boolean *end) {
    dp_component *c = (dp_component *)component;
    (void)no_set_before;
    if (dp_refused(c, DP_CONTINUOUS, "CompletedIntegratorStep")) return fmi2Error;
    if (!event || !end) return (fmi2Status)dp_null(c, "CompletedIntegratorStep");
    *event = *end = fmi2False; /* all events have indicators */
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetTime(fmi2Component c, fmi2Real t) {
    return (fmi2Status)dp_set_time((dp_component *)c, t, "SetTime");
}

FMI2_EXPORT fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n) {
    return (fmi2Status)dp_set_states((dp_component *)c, x, n, "SetContinuousStates");
}

FMI2_EXPORT fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real value[], size_t n) {
    return (fmi2Status)dp_get_rates((dp_component *)c, value, n, "GetDerivatives");
}

FMI2_EXPORT fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real value[], size_t n) {
    return (fmi2Status)dp_get_indicators((dp_component *)c, value, n, "GetEventIndicators");
}

FMI2_EXPORT fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real value[], size_t n) {
    return (fmi2Status)dp_get_states((dp_component *)c, value, n, "GetContinuousStates");
}

FMI2_EXPORT fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real value[], size_t n) {
    return (fmi2Status)dp_get_nominals((dp_component *)c, value, n, "GetNominalsOfContinuousStates");
}

/* Stored states -------------------------------------------------------------------------------------------------- */

FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    return (fmi2Status)dp_get_state((dp_component *)c, state, "GetFMUstate");
}

FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    return (fmi2Status)dp_set_state((dp_component *)c, state, "SetFMUstate");
}

FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    return (fmi2Status)dp_free_state((dp_component *)c, state);
}

FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    return (fmi2Status)dp_state_size((dp_component *)c, state, size, "SerializedFMUstateSize");
}

FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    return (fmi2Status)dp_serialise((dp_component *)c, state, bytes, size, "SerializeFMUstate");
}

FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                               fmi2FMUstate *state) {
    return (fmi2Status)dp_deserialise((dp_component *)c, bytes, size, state, "DeSerializeFMUstate");
}
