/* FMI 3.0 as the fuzzer calls it. Behind the FMU's sources, which declare the functions. */

static void tell(void *environment, fmi3Status status, const char *category, const char *text) {
    (void)environment;
    if (!category || status > fmi3Fatal) fail("a message without a category or status", "log");
    heard(text);
}

static void *create(int exchange, int silent) {
    const fmi3LogMessageCallback log = silent ? NULL : tell;
    const char *const resources = chance(2) ? NULL : "x/";
    if (exchange) return fmi3InstantiateModelExchange("rig", the.token, resources, false, chance(2), NULL, log);
    return fmi3InstantiateCoSimulation("rig", the.token, resources, false, chance(2), false, false, NULL, 0, NULL, log,
                                       NULL);
}

static void create_badly(void) {
    const char *const name = chance(2) ? NULL : "", *const token = chance(2) ? NULL : "{another}";
    const long before = messages;
    if (fmi3InstantiateModelExchange(name, the.token, NULL, false, false, NULL, tell)) fail("without a name", "create");
    if (fmi3InstantiateModelExchange("rig", token, NULL, false, false, NULL, tell)) fail("of another", "create");
    if (fmi3InstantiateCoSimulation(name, the.token, NULL, false, false, false, false, NULL, 0, NULL, tell, NULL))
        fail("without a name", "create");
    if (fmi3InstantiateCoSimulation("rig", token, NULL, false, false, false, false, NULL, 0, NULL, tell, NULL))
        fail("of another", "create");
    if (fmi3InstantiateScheduledExecution("rig", the.token, NULL, false, false, NULL, tell, NULL, NULL, NULL))
        fail("for scheduled execution", "create");
    if (messages != before + 5) fail("refused without a word", "create");
}

static void destroy(void *component) { fmi3FreeInstance(component); }

static int value(void *c, uint32_t reference, double *out) { return fmi3GetFloat64(c, &reference, 1, out, 1); }

static int begin(void *c, double start) { return fmi3EnterInitializationMode(c, false, 0.0, start, false, 0.0); }

static int put(void *c, uint32_t reference, double x) { return fmi3SetFloat64(c, &reference, 1, &x, 1); }

static int step(void *c, double t, double dt) {
    bool event, end, early;
    double reached;
    return fmi3DoStep(c, t, dt, true, &event, &end, &early, &reached);
}

static int finish(void *c) { return fmi3Terminate(c); }

/* One function each ----------------------------------------------------------------------------------------------- */

#define MAYBE(place) (chance(10) ? NULL : &(place))

static int enter(instance *i, arguments *a) {
    const double start = chance(3) ? any_value() : 0.0, stop = chance(2) ? any_value() : 1e3;
    const int status = fmi3EnterInitializationMode(i->component, chance(2), any_value(), start, chance(3), stop);
    (void)a;
    if (status == fmi3OK) i->t = start;
    return status;
}

static int reset(instance *i, arguments *a) {
    (void)a;
    i->t = 0.0;
    return fmi3Reset(i->component);
}

static int do_step(instance *i, arguments *a) {
    const double t = chance(8) ? any_value() : i->t, dt = any_step();
    bool event = false, end = false, early = false;
    double reached = 0.0;
    const int status =
        fmi3DoStep(i->component, t, dt, chance(2), MAYBE(event), MAYBE(end), MAYBE(early), MAYBE(reached));
    (void)a;
    return stepped(status, i, t, dt);
}

static int debug(instance *i, arguments *a) { return fmi3SetDebugLogging(i->component, chance(2), a->n, a->text); }

#define PLAIN(name, function) \
    static int name(instance *i, arguments *a) { return (void)a, (int)function(i->component); }

PLAIN(leave, fmi3ExitInitializationMode)
PLAIN(event_mode, fmi3EnterEventMode)
PLAIN(terminate, fmi3Terminate)
PLAIN(configure, fmi3EnterConfigurationMode)
PLAIN(configured, fmi3ExitConfigurationMode)
PLAIN(evaluate, fmi3EvaluateDiscreteStates)
PLAIN(continuous_mode, fmi3EnterContinuousTimeMode)
PLAIN(step_mode, fmi3EnterStepMode)

/* As many values as references, but for a slip now and then; there is room for as many as are said. */
#define TYPED(type)                                                                                  \
    static int get_##type(instance *i, arguments *a) {                                                     \
        const size_t n = chance(12) ? pick(4) : a->n;                                                      \
        fmi3##type *x = (fmi3##type *)room(n, sizeof *x);                                                  \
        const int status = fmi3Get##type(i->component, a->reference, a->n, x, n);                          \
        free(x);                                                                                           \
        return status;                                                                                     \
    }                                                                                                      \
    static int set_##type(instance *i, arguments *a) {                                                     \
        const size_t n = chance(12) ? pick(4) : a->n;                                                      \
        fmi3##type *x = (fmi3##type *)room(n, sizeof *x);                                                  \
        size_t k;                                                                                          \
        int status;                                                                                        \
        for (k = 0; x && k < n; ++k) x[k] = 1;                                                             \
        status = fmi3Set##type(i->component, a->reference, a->n, x, n);                                    \
        free(x);                                                                                           \
        return status;                                                                                     \
    }

static int get_real(instance *i, arguments *a) {
    const size_t n = chance(12) ? pick(4) : a->n;
    double *x = (double *)room(n, sizeof *x);
    const int status = taken(fmi3GetFloat64(i->component, a->reference, a->n, x, n), a, x, 0);
    if (status == fmi3OK && n != a->n) fail("more or fewer values than references were taken", "GetFloat64");
    free(x);
    return status;
}

static int set_real(instance *i, arguments *a) {
    const size_t n = chance(12) ? pick(4) : a->n;
    const int status = taken(fmi3SetFloat64(i->component, a->reference, a->n, a->real, n), a, a->real, 1);
    if (status == fmi3OK && n != a->n) fail("more or fewer values than references were taken", "SetFloat64");
    return status;
}

TYPED(Float32)
TYPED(Int8)
TYPED(UInt8)
TYPED(Int16)
TYPED(UInt16)
TYPED(Int32)
TYPED(UInt32)
TYPED(Int64)
TYPED(UInt64)
TYPED(Boolean)

static int get_text(instance *i, arguments *a) {
    return fmi3GetString(i->component, a->reference, a->n, a->text, a->n);
}
static int set_text(instance *i, arguments *a) {
    return fmi3SetString(i->component, a->reference, a->n, a->text, a->n);
}

static int binary(instance *i, arguments *a) {
    size_t *size = (size_t *)room(a->n, sizeof *size);
    fmi3Binary *x = (fmi3Binary *)room(a->n, sizeof *x);
    const int status = chance(2) ? fmi3GetBinary(i->component, a->reference, a->n, size, x, a->n)
                                 : fmi3SetBinary(i->component, a->reference, a->n, size, x, a->n);
    free(size), free((void *)x);
    return status;
}

/* All that clocks have. */
static int clocks(instance *i, arguments *a) {
    fmi3UInt64 *count = (fmi3UInt64 *)room(a->n, sizeof *count), *unit = (fmi3UInt64 *)room(a->n, sizeof *unit);
    fmi3IntervalQualifier *kind = (fmi3IntervalQualifier *)room(a->n, sizeof *kind);
    fmi3Instance const c = i->component;
    const fmi3ValueReference *const vr = a->reference;
    int status;
    switch (pick(11)) {
    case 0: status = fmi3GetClock(c, vr, a->n, a->boolean); break;
    case 1: status = fmi3SetClock(c, vr, a->n, a->boolean); break;
    case 2: status = fmi3GetIntervalDecimal(c, vr, a->n, a->real, kind); break;
    case 3: status = fmi3GetIntervalFraction(c, vr, a->n, count, unit, kind); break;
    case 4: status = fmi3GetShiftDecimal(c, vr, a->n, a->real); break;
    case 5: status = fmi3GetShiftFraction(c, vr, a->n, count, unit); break;
    case 6: status = fmi3SetIntervalDecimal(c, vr, a->n, a->real); break;
    case 7: status = fmi3SetIntervalFraction(c, vr, a->n, count, unit); break;
    case 8: status = fmi3SetShiftDecimal(c, vr, a->n, a->real); break;
    case 9: status = fmi3SetShiftFraction(c, vr, a->n, count, unit); break;
    default: status = fmi3ActivateModelPartition(c, any_reference(the.variables), any_value()); break;
    }
    free(count), free(unit), free(kind);
    return status;
}

static int dependencies(instance *i, arguments *a) {
    const fmi3ValueReference vr = any_reference(the.variables);
    size_t *which = (size_t *)room(a->n, sizeof *which), *whose = (size_t *)room(a->n, sizeof *whose), n = 0;
    fmi3DependencyKind *kind = (fmi3DependencyKind *)room(a->n, sizeof *kind);
    const int status = chance(2)
                           ? fmi3GetNumberOfVariableDependencies(i->component, vr, MAYBE(n))
                           : fmi3GetVariableDependencies(i->component, vr, which, a->reference, whose, kind, a->n);
    free(which), free(whose), free(kind);
    return status;
}

static int derivative(instance *i, arguments *a) {
    return fmi3GetDirectionalDerivative(i->component, a->reference, a->n, a->further, a->m, a->direction, a->m, a->real,
                                        a->n);
}

static int adjoint(instance *i, arguments *a) {
    return fmi3GetAdjointDerivative(i->component, a->reference, a->n, a->further, a->m, a->real, a->n, a->direction,
                                    a->m);
}

static int out_rates(instance *i, arguments *a) {
    return fmi3GetOutputDerivatives(i->component, a->reference, a->n, a->order, a->real, a->n);
}

static int update(instance *i, arguments *a) {
    bool more, end, nominals, values, timed;
    double next;
    (void)a;
    return fmi3UpdateDiscreteStates(i->component, MAYBE(more), MAYBE(end), MAYBE(nominals), MAYBE(values), MAYBE(timed),
                                    MAYBE(next));
}

static int completed(instance *i, arguments *a) {
    bool event, end;
    return (void)a, (int)fmi3CompletedIntegratorStep(i->component, chance(2), MAYBE(event), MAYBE(end));
}

static int set_time(instance *i, arguments *a) {
    (void)a;
    i->t += chance(2) ? 0.0 : uniform(0.0, 1e-3);
    return fmi3SetTime(i->component, chance(6) ? any_value() : i->t);
}

static int sizes(instance *i, arguments *a) {
    size_t n;
    (void)a;
    return chance(2) ? fmi3GetNumberOfEventIndicators(i->component, MAYBE(n))
                     : fmi3GetNumberOfContinuousStates(i->component, MAYBE(n));
}

#include "calls_states.h"
KEPT(fmi3GetFMUState, fmi3SetFMUState, fmi3FreeFMUState, fmi3SerializedFMUStateSize, fmi3SerializeFMUState,
     fmi3DeserializeFMUState, fmi3Byte)
SIZED(set_states, fmi3SetContinuousStates, the.states)
SIZED(get_states, fmi3GetContinuousStates, the.states)
SIZED(get_rates, fmi3GetContinuousStateDerivatives, the.states)
SIZED(get_indicators, fmi3GetEventIndicators, the.indicators)
SIZED(get_nominals, fmi3GetNominalsOfContinuousStates, the.states)

#define BOTH(type) {"Get" #type, get_##type, 1}, {"Set" #type, set_##type, 1}

static const function functions[] = {
    {"SetDebugLogging", debug, 1}, {"EnterInitializationMode", enter, 10}, {"ExitInitializationMode", leave, 10},
    {"EnterEventMode", event_mode, 2}, {"Terminate", terminate, 1}, {"Reset", reset, 3}, {"GetFloat64", get_real, 12},
    {"SetFloat64", set_real, 12}, BOTH(Float32), BOTH(Int8), BOTH(UInt8), BOTH(Int16), BOTH(UInt16), BOTH(Int32),
    BOTH(UInt32), BOTH(Int64), BOTH(UInt64), BOTH(Boolean), {"GetString", get_text, 1}, {"SetString", set_text, 1},
    {"GetBinary", binary, 1}, {"GetClock", clocks, 3}, {"GetVariableDependencies", dependencies, 1},
    {"GetDirectionalDerivative", derivative, 4}, {"GetAdjointDerivative", adjoint, 1},
    {"GetOutputDerivatives", out_rates, 1}, {"EnterConfigurationMode", configure, 1},
    {"ExitConfigurationMode", configured, 1}, {"EvaluateDiscreteStates", evaluate, 1},
    {"UpdateDiscreteStates", update, 4}, {"EnterContinuousTimeMode", continuous_mode, 4},
    {"EnterStepMode", step_mode, 1}, {"CompletedIntegratorStep", completed, 3}, {"SetTime", set_time, 3},
    {"GetNumberOfContinuousStates", sizes, 1},
    {"SetContinuousStates", set_states, 4}, {"GetContinuousStates", get_states, 2},
    {"GetContinuousStateDerivatives", get_rates, 4}, {"GetEventIndicators", get_indicators, 3},
    {"GetNominalsOfContinuousStates", get_nominals, 1}, {"DoStep", do_step, 30}, {"GetFMUState", keep, 3},
    {"SetFMUState", restore, 3}, {"FreeFMUState", forget, 1}, {"SerializedFMUStateSize", length, 1},
    {"SerializeFMUState", serialise, 2}, {"DeserializeFMUState", deserialise, 2},
};
enum { FUNCTIONS = sizeof functions / sizeof *functions };
