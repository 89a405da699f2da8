/* An FMU of FMI 2 for co-simulation that does what the environment says: FAULT in the function AT. */

#include "fault.h"

typedef void (*logger_type)(void *, const char *, int, const char *, const char *, ...);
struct callbacks {
    logger_type log;
};
static const struct callbacks *kept;

static void say(const char *text) { kept->log(0, "rig", 1, "log", text); }

EXPORT void *fmi2Instantiate(const char *name, int kind, const char *id, const char *place, const struct callbacks *with,
                             int visible, int logging) {
    static int instance;
    (void)name, (void)kind, (void)id, (void)place, (void)visible, (void)logging;
    kept = with;
    return fault("fmi2Instantiate") ? 0 : &instance;
}
EXPORT int fmi2SetupExperiment(void *c, int b, double t, double start, int d, double stop) {
    (void)c, (void)b, (void)t, (void)d, (void)stop;
    clock_now = start;
    return fault("fmi2SetupExperiment");
}
EXPORT int fmi2EnterInitializationMode(void *c) { return (void)c, fault("fmi2EnterInitializationMode"); }
EXPORT int fmi2ExitInitializationMode(void *c) { return (void)c, fault("fmi2ExitInitializationMode"); }
EXPORT int fmi2Terminate(void *c) { return (void)c, fault("fmi2Terminate"); }
EXPORT int fmi2Reset(void *c) { return (void)c, fault("fmi2Reset"); }
EXPORT void fmi2FreeInstance(void *c) { (void)c, (void)fault("fmi2FreeInstance"); }
EXPORT int fmi2SetReal(void *c, const unsigned *r, size_t n, const double *v) {
    return (void)c, (void)r, (void)n, (void)v, fault("fmi2SetReal");
}
EXPORT int fmi2SetRealInputDerivatives(void *c, const unsigned *r, size_t n, const int *order, const double *v) {
    return (void)c, (void)r, (void)n, (void)order, (void)v, fault("fmi2SetRealInputDerivatives");
}
EXPORT int fmi2GetReal(void *c, const unsigned *r, size_t n, double *v) {
    const char *what = getenv("FAULT");
    size_t i;
    (void)c, (void)r;
    for (i = 0; i < n; ++i) v[i] = what && !strcmp(what, "nan") ? NAN : 1e-3 * sin(80 * clock_now);
    return fault("fmi2GetReal");
}
EXPORT int fmi2DoStep(void *c, double t, double h, int b) {
    (void)c, (void)b;
    clock_now = t + h;
    return fault("fmi2DoStep");
}

/* FMPy asks for all there are. */
#define ABSENT(name) \
    EXPORT int name(void) { return 3; }
ABSENT(fmi2CancelStep)
ABSENT(fmi2CompletedIntegratorStep)
ABSENT(fmi2DeSerializeFMUstate)
ABSENT(fmi2EnterContinuousTimeMode)
ABSENT(fmi2EnterEventMode)
ABSENT(fmi2FreeFMUstate)
ABSENT(fmi2GetBoolean)
ABSENT(fmi2GetBooleanStatus)
ABSENT(fmi2GetContinuousStates)
ABSENT(fmi2GetDerivatives)
ABSENT(fmi2GetDirectionalDerivative)
ABSENT(fmi2GetEventIndicators)
ABSENT(fmi2GetFMUstate)
ABSENT(fmi2GetInteger)
ABSENT(fmi2GetIntegerStatus)
ABSENT(fmi2GetNominalsOfContinuousStates)
ABSENT(fmi2GetRealOutputDerivatives)
ABSENT(fmi2GetRealStatus)
ABSENT(fmi2GetStatus)
ABSENT(fmi2GetString)
ABSENT(fmi2GetStringStatus)
ABSENT(fmi2GetTypesPlatform)
ABSENT(fmi2GetVersion)
ABSENT(fmi2NewDiscreteStates)
ABSENT(fmi2SerializeFMUstate)
ABSENT(fmi2SerializedFMUstateSize)
ABSENT(fmi2SetBoolean)
ABSENT(fmi2SetContinuousStates)
ABSENT(fmi2SetDebugLogging)
ABSENT(fmi2SetFMUstate)
ABSENT(fmi2SetInteger)
ABSENT(fmi2SetString)
ABSENT(fmi2SetTime)
