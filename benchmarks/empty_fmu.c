/* An FMU that does nothing, FMI 2.0 and 3.0 co-simulation: what is left of the time is the importer's own. */
#include <stdbool.h>
#include <stddef.h>

#ifdef _WIN32
#define CALL __declspec(dllexport)
#else
#define CALL __attribute__((visibility("default")))
#endif

typedef void *instance;
static int nothing;

CALL const char *fmi2GetTypesPlatform(void) { return "default"; }
CALL const char *fmi2GetVersion(void) { return "2.0"; }
CALL instance fmi2Instantiate(const char *name, int type, const char *guid, const char *resources, const void *call,
                              int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)call, (void)visible, (void)logging;
    return &nothing;
}
CALL int fmi2SetDebugLogging(instance c, int on, size_t n, const char *const *names) {
    return (void)c, (void)on, (void)n, (void)names, 0;
}
CALL int fmi2SetupExperiment(instance c, int has_tolerance, double tolerance, double start, int has_stop, double stop) {
    return (void)c, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop, 0;
}
CALL int fmi2EnterInitializationMode(instance c) { return (void)c, 0; }
CALL int fmi2ExitInitializationMode(instance c) { return (void)c, 0; }
CALL int fmi2Terminate(instance c) { return (void)c, 0; }
CALL void fmi2FreeInstance(instance c) { (void)c; }
CALL int fmi2SetReal(instance c, const unsigned *vr, size_t n, const double *value) {
    return (void)c, (void)vr, (void)n, (void)value, 0;
}
CALL int fmi2SetRealInputDerivatives(instance c, const unsigned *vr, size_t n, const int *order, const double *value) {
    return (void)c, (void)vr, (void)n, (void)order, (void)value, 0;
}
CALL int fmi2GetReal(instance c, const unsigned *vr, size_t n, double *value) {
    size_t i;
    for (i = 0; i < n; ++i) value[i] = 0.0;
    return (void)c, (void)vr, 0;
}
CALL int fmi2DoStep(instance c, double t, double dt, int no_set_before) {
    return (void)c, (void)t, (void)dt, (void)no_set_before, 0;
}

CALL const char *fmi3GetVersion(void) { return "3.0"; }
CALL instance fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                                          bool logging, bool event_mode, bool early_return, const unsigned *required,
                                          size_t n, void *environment, void *log, void *update) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)event_mode, (void)early_return;
    (void)required, (void)n, (void)environment, (void)log, (void)update;
    return &nothing;
}
CALL int fmi3EnterInitializationMode(instance c, bool has_tolerance, double tolerance, double start, bool has_stop,
                                     double stop) {
    return (void)c, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop, 0;
}
CALL int fmi3ExitInitializationMode(instance c) { return (void)c, 0; }
CALL int fmi3Terminate(instance c) { return (void)c, 0; }
CALL void fmi3FreeInstance(instance c) { (void)c; }
CALL int fmi3SetFloat64(instance c, const unsigned *vr, size_t n, const double *value, size_t values) {
    return (void)c, (void)vr, (void)n, (void)value, (void)values, 0;
}
CALL int fmi3GetFloat64(instance c, const unsigned *vr, size_t n, double *value, size_t values) {
    size_t i;
    for (i = 0; i < values; ++i) value[i] = 0.0;
    return (void)c, (void)vr, (void)n, 0;
}
CALL int fmi3DoStep(instance c, double t, double dt, bool no_set_before, bool *event, bool *end, bool *early,
                    double *reached) {
    *event = *end = *early = false;
    *reached = t + dt;
    return (void)c, (void)no_set_before, 0;
}
