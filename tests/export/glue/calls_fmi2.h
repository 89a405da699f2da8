/* FMI 2.0 as the fuzzer calls it. Behind the FMU's sources, which declare the functions. */

static void tell(void *environment, const char *name, fmi2Status status, const char *category, const char *text, ...) {
    (void)environment;
    if (!name || !category || status > fmi2Pending) fail("a message without a sender, category or status", "log");
    heard(text);
}

static const fmi2CallbackFunctions loud = {tell, calloc, free, NULL, NULL}, quiet = {NULL, NULL, NULL, NULL, NULL};

static void *create(int exchange, int silent) {
    const fmi2Type type = exchange ? fmi2ModelExchange : fmi2CoSimulation;
    const char *const resources = chance(2) ? NULL : "file:///x";
    return fmi2Instantiate("rig", type, the.token, resources, silent ? &quiet : &loud, 0, chance(2));
}

static void create_badly(void) {
    const char *const name = chance(2) ? NULL : "", *const token = chance(2) ? NULL : "{another}";
    const long before = messages;
    if (fmi2Instantiate(name, fmi2CoSimulation, the.token, NULL, &loud, 0, 0)) fail("without a name", "create");
    if (fmi2Instantiate("rig", fmi2CoSimulation, token, NULL, &loud, 0, 0)) fail("of another", "create");
    if (messages != before + 2) fail("refused without a word", "fmi2Instantiate");
    if (fmi2Instantiate("rig", fmi2CoSimulation, the.token, NULL, NULL, 0, 0)) fail("no callbacks", "create");
}

static void destroy(void *component) { fmi2FreeInstance(component); }

static int value(void *c, uint32_t reference, double *out) { return fmi2GetReal(c, &reference, 1, out); }

static int begin(void *c, double start) {
    const int status = fmi2SetupExperiment(c, 0, 0.0, start, 0, 0.0);
    return status == fmi2OK ? (int)fmi2EnterInitializationMode(c) : status;
}

static int put(void *c, uint32_t reference, double x) { return fmi2SetReal(c, &reference, 1, &x); }

static int step(void *c, double t, double dt) { return fmi2DoStep(c, t, dt, 1); }

static int finish(void *c) { return fmi2Terminate(c); }

/* One function each ----------------------------------------------------------------------------------------------- */

static int setup(instance *i, arguments *a) {
    const double start = chance(3) ? any_value() : 0.0, stop = chance(2) ? any_value() : 1e3;
    const int status = fmi2SetupExperiment(i->component, chance(2), any_value(), start, chance(3), stop);
    (void)a;
    if (status == fmi2OK) i->t = start;
    return status;
}

static int reset(instance *i, arguments *a) {
    (void)a;
    i->t = 0.0;
    return fmi2Reset(i->component);
}

static int do_step(instance *i, arguments *a) {
    const double t = chance(8) ? any_value() : i->t, dt = any_step();
    (void)a;
    return stepped(fmi2DoStep(i->component, t, dt, chance(2)), i, t, dt);
}

static int debug(instance *i, arguments *a) { return fmi2SetDebugLogging(i->component, chance(2), a->n, a->text); }
static int enter(instance *i, arguments *a) { return (void)a, fmi2EnterInitializationMode(i->component); }
static int leave(instance *i, arguments *a) { return (void)a, fmi2ExitInitializationMode(i->component); }
static int terminate(instance *i, arguments *a) { return (void)a, fmi2Terminate(i->component); }

static int get_real(instance *i, arguments *a) {
    return taken(fmi2GetReal(i->component, a->reference, a->n, a->real), a, a->real, 0);
}

static int set_real(instance *i, arguments *a) {
    return taken(fmi2SetReal(i->component, a->reference, a->n, a->real), a, a->real, 1);
}

static int get_int(instance *i, arguments *a) { return fmi2GetInteger(i->component, a->reference, a->n, a->integer); }
static int get_bool(instance *i, arguments *a) { return fmi2GetBoolean(i->component, a->reference, a->n, a->integer); }
static int get_text(instance *i, arguments *a) { return fmi2GetString(i->component, a->reference, a->n, a->text); }
static int set_int(instance *i, arguments *a) { return fmi2SetInteger(i->component, a->reference, a->n, a->integer); }
static int set_bool(instance *i, arguments *a) { return fmi2SetBoolean(i->component, a->reference, a->n, a->integer); }
static int set_text(instance *i, arguments *a) { return fmi2SetString(i->component, a->reference, a->n, a->text); }
static int cancel(instance *i, arguments *a) { return (void)a, fmi2CancelStep(i->component); }

static int incline(instance *i, arguments *a) {
    return taken(fmi2SetRealInputDerivatives(i->component, a->reference, a->n, a->order, a->real), a, a->real, 1);
}

static int out_rates(instance *i, arguments *a) {
    return fmi2GetRealOutputDerivatives(i->component, a->reference, a->n, a->order, a->real);
}

static int derivative(instance *i, arguments *a) {
    return fmi2GetDirectionalDerivative(i->component, a->reference, a->n, a->further, a->m, a->direction, a->real);
}

/* Kinds that do not exist are asked for by a number that C allows for the enumeration. */
static fmi2StatusKind any_kind(void) { return (fmi2StatusKind)pick(4); }

/* Room for one value, or none. */
#define STATUS(name, function, type)                                                                  \
    static int name(instance *i, arguments *a) {                                                      \
        type out;                                                                                     \
        return (void)a, (int)function(i->component, any_kind(), chance(8) ? NULL : &out);             \
    }

STATUS(get_status, fmi2GetStatus, fmi2Status)
STATUS(real_status, fmi2GetRealStatus, fmi2Real)
STATUS(int_status, fmi2GetIntegerStatus, fmi2Integer)
STATUS(bool_status, fmi2GetBooleanStatus, fmi2Boolean)
STATUS(text_status, fmi2GetStringStatus, fmi2String)

#include "calls_states.h"
KEPT(fmi2GetFMUstate, fmi2SetFMUstate, fmi2FreeFMUstate, fmi2SerializedFMUstateSize, fmi2SerializeFMUstate,
     fmi2DeSerializeFMUstate, fmi2Byte)

/* Model exchange -------------------------------------------------------------------------------------------------- */

static int event_mode(instance *i, arguments *a) { return (void)a, fmi2EnterEventMode(i->component); }
static int continuous_mode(instance *i, arguments *a) { return (void)a, fmi2EnterContinuousTimeMode(i->component); }

static int update(instance *i, arguments *a) {
    fmi2EventInfo info;
    (void)a;
    return fmi2NewDiscreteStates(i->component, chance(10) ? NULL : &info);
}

static int completed(instance *i, arguments *a) {
    int event, end;
    (void)a;
    return fmi2CompletedIntegratorStep(i->component, chance(2), chance(10) ? NULL : &event, chance(10) ? NULL : &end);
}

static int set_time(instance *i, arguments *a) {
    (void)a;
    i->t += chance(2) ? 0.0 : uniform(0.0, 1e-3);
    return fmi2SetTime(i->component, chance(6) ? any_value() : i->t);
}

SIZED(set_states, fmi2SetContinuousStates, the.states)
SIZED(get_states, fmi2GetContinuousStates, the.states)
SIZED(get_rates, fmi2GetDerivatives, the.states)
SIZED(get_indicators, fmi2GetEventIndicators, the.indicators)
SIZED(get_nominals, fmi2GetNominalsOfContinuousStates, the.states)

static const function functions[] = {
    {"SetDebugLogging", debug, 1}, {"SetupExperiment", setup, 6}, {"EnterInitializationMode", enter, 6},
    {"ExitInitializationMode", leave, 10}, {"Terminate", terminate, 1}, {"Reset", reset, 3}, {"GetReal", get_real, 10},
    {"SetReal", set_real, 10}, {"GetInteger", get_int, 1}, {"GetBoolean", get_bool, 1}, {"GetString", get_text, 1},
    {"SetInteger", set_int, 1}, {"SetBoolean", set_bool, 1}, {"SetString", set_text, 1},
    {"SetRealInputDerivatives", incline, 8}, {"GetRealOutputDerivatives", out_rates, 1},
    {"GetDirectionalDerivative", derivative, 4}, {"DoStep", do_step, 30}, {"CancelStep", cancel, 1},
    {"GetStatus", get_status, 1}, {"GetRealStatus", real_status, 1}, {"GetIntegerStatus", int_status, 1},
    {"GetBooleanStatus", bool_status, 1}, {"GetStringStatus", text_status, 1}, {"GetFMUstate", keep, 3},
    {"SetFMUstate", restore, 3}, {"FreeFMUstate", forget, 1}, {"SerializedFMUstateSize", length, 1},
    {"SerializeFMUstate", serialise, 2}, {"DeSerializeFMUstate", deserialise, 2}, {"EnterEventMode", event_mode, 2},
    {"EnterContinuousTimeMode", continuous_mode, 4}, {"NewDiscreteStates", update, 4},
    {"CompletedIntegratorStep", completed, 3}, {"SetTime", set_time, 3}, {"SetContinuousStates", set_states, 4},
    {"GetContinuousStates", get_states, 2}, {"GetDerivatives", get_rates, 4}, {"GetEventIndicators", get_indicators, 3},
    {"GetNominalsOfContinuousStates", get_nominals, 1},
};
enum { FUNCTIONS = sizeof functions / sizeof *functions };
