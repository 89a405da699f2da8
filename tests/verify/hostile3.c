/* An FMU of FMI 3 for co-simulation that does what the environment says: FAULT in the function AT. */

#include <stdbool.h>
#include <stdint.h>

#include "fault.h"

typedef void (*logger_type)(void *, int, const char *, const char *);
static logger_type log_message;

static void say(const char *text) { log_message(0, 1, "log", text); }

static int is(const char *what) {
    const char *asked = getenv("FAULT");
    return asked && !strcmp(what, asked);
}

EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *place, bool visible,
                                         bool logging, bool events, bool early, const uint32_t *required, size_t n,
                                         void *environment, logger_type log, void *update) {
    static int instance;
    (void)name, (void)token, (void)place, (void)visible, (void)logging, (void)events, (void)early, (void)required;
    (void)n, (void)environment, (void)update;
    log_message = log;
    return fault("fmi3InstantiateCoSimulation") ? 0 : &instance;
}
EXPORT int fmi3EnterInitializationMode(void *c, bool b, double t, double start, bool d, double stop) {
    (void)c, (void)b, (void)t, (void)d, (void)stop;
    clock_now = start;
    return fault("fmi3EnterInitializationMode");
}
EXPORT int fmi3ExitInitializationMode(void *c) { return (void)c, fault("fmi3ExitInitializationMode"); }
EXPORT int fmi3Terminate(void *c) { return (void)c, fault("fmi3Terminate"); }
EXPORT int fmi3Reset(void *c) { return (void)c, fault("fmi3Reset"); }
EXPORT void fmi3FreeInstance(void *c) { (void)c, (void)fault("fmi3FreeInstance"); }
EXPORT int fmi3SetFloat64(void *c, const uint32_t *r, size_t n, const double *v, size_t m) {
    return (void)c, (void)r, (void)n, (void)v, (void)m, fault("fmi3SetFloat64");
}
EXPORT int fmi3GetFloat64(void *c, const uint32_t *r, size_t n, double *v, size_t m) {
    size_t i;
    (void)c, (void)r, (void)n;
    for (i = 0; i < m; ++i) v[i] = is("nan") ? NAN : 1e-3 * sin(80 * clock_now);
    return fault("fmi3GetFloat64");
}
EXPORT int fmi3DoStep(void *c, double t, double h, bool keep, bool *event, bool *terminate, bool *early, double *last) {
    (void)c, (void)keep;
    clock_now = t + h;
    *event = false, *terminate = is("terminate"), *early = is("early"), *last = is("short") ? t : clock_now;
    return fault("fmi3DoStep");
}

/* FMPy asks for all there are. */
#define ABSENT(name) \
    EXPORT int name(void) { return 3; }
ABSENT(fmi3ActivateModelPartition)
ABSENT(fmi3CompletedIntegratorStep)
ABSENT(fmi3DeserializeFMUState)
ABSENT(fmi3EnterConfigurationMode)
ABSENT(fmi3EnterContinuousTimeMode)
ABSENT(fmi3EnterEventMode)
ABSENT(fmi3EnterStepMode)
ABSENT(fmi3EvaluateDiscreteStates)
ABSENT(fmi3ExitConfigurationMode)
ABSENT(fmi3FreeFMUState)
ABSENT(fmi3GetAdjointDerivative)
ABSENT(fmi3GetBinary)
ABSENT(fmi3GetBoolean)
ABSENT(fmi3GetClock)
ABSENT(fmi3GetContinuousStateDerivatives)
ABSENT(fmi3GetContinuousStates)
ABSENT(fmi3GetDirectionalDerivative)
ABSENT(fmi3GetEventIndicators)
ABSENT(fmi3GetFMUState)
ABSENT(fmi3GetFloat32)
ABSENT(fmi3GetInt16)
ABSENT(fmi3GetInt32)
ABSENT(fmi3GetInt64)
ABSENT(fmi3GetInt8)
ABSENT(fmi3GetIntervalDecimal)
ABSENT(fmi3GetIntervalFraction)
ABSENT(fmi3GetNominalsOfContinuousStates)
ABSENT(fmi3GetNumberOfContinuousStates)
ABSENT(fmi3GetNumberOfEventIndicators)
ABSENT(fmi3GetNumberOfVariableDependencies)
ABSENT(fmi3GetOutputDerivatives)
ABSENT(fmi3GetShiftDecimal)
ABSENT(fmi3GetShiftFraction)
ABSENT(fmi3GetString)
ABSENT(fmi3GetUInt16)
ABSENT(fmi3GetUInt32)
ABSENT(fmi3GetUInt64)
ABSENT(fmi3GetUInt8)
ABSENT(fmi3GetVariableDependencies)
ABSENT(fmi3GetVersion)
ABSENT(fmi3InstantiateModelExchange)
ABSENT(fmi3InstantiateScheduledExecution)
ABSENT(fmi3SerializeFMUState)
ABSENT(fmi3SerializedFMUStateSize)
ABSENT(fmi3SetBinary)
ABSENT(fmi3SetBoolean)
ABSENT(fmi3SetClock)
ABSENT(fmi3SetContinuousStates)
ABSENT(fmi3SetDebugLogging)
ABSENT(fmi3SetFMUState)
ABSENT(fmi3SetFloat32)
ABSENT(fmi3SetInt16)
ABSENT(fmi3SetInt32)
ABSENT(fmi3SetInt64)
ABSENT(fmi3SetInt8)
ABSENT(fmi3SetIntervalDecimal)
ABSENT(fmi3SetIntervalFraction)
ABSENT(fmi3SetShiftDecimal)
ABSENT(fmi3SetShiftFraction)
ABSENT(fmi3SetString)
ABSENT(fmi3SetTime)
ABSENT(fmi3SetUInt16)
ABSENT(fmi3SetUInt32)
ABSENT(fmi3SetUInt64)
ABSENT(fmi3SetUInt8)
ABSENT(fmi3UpdateDiscreteStates)
