/* An FMU of FMI 2 for co-simulation that does what the environment says: FAULT in the function AT. */

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

typedef void (*logger_type)(void *, const char *, int, const char *, const char *, ...);
struct callbacks {
    logger_type log;
};
static const struct callbacks *kept;
static double clock_now;

static int fault(const char *here) {
    const char *at = getenv("AT"), *what = getenv("FAULT");
    if (!at || !what || strcmp(at, here)) return 0;
    if (!strcmp(what, "exit")) exit(0);
    if (!strcmp(what, "exit7")) _exit(7);
    if (!strcmp(what, "crash")) *(volatile int *)8 = 1;
    if (!strcmp(what, "abort")) abort();
    if (!strcmp(what, "stop")) raise(SIGSTOP);
    if (!strcmp(what, "loop"))
        for (;;) clock_now += 1e-9;
    if (!strcmp(what, "error")) return 3;
    if (!strcmp(what, "fatal")) return 4;
    if (!strcmp(what, "discard")) return 2;
    if (!strcmp(what, "nonsense")) return 77;
    if (!strcmp(what, "chdir") && chdir("/")) return 3;
    if (!strcmp(what, "litter")) {
        FILE *file = fopen("litter.txt", "w");
        if (file) fclose(file);
    }
    if (!strcmp(what, "flood")) {
        int i;
        for (i = 0; i < 20000; ++i) {
            printf("a line that nobody asked for, and another, and one more, and so on without an end\n");
            fprintf(stderr, "the same on the other output, and another, and one more, and so on without an end\n");
        }
        fflush(stdout);
    }
    if (!strcmp(what, "talk")) {
        int i;
        for (i = 0; i < 20000; ++i) kept->log(0, "rig", 1, "log", "a message that nobody asked for");
    }
    if (!strcmp(what, "child") && fork() == 0) {
        for (;;) sleep(60);
    }
    if (!strcmp(what, "close")) {
        int i;
        for (i = 0; i < 64; ++i) close(i);
    }
    if (!strcmp(what, "write")) {
        int i;
        for (i = 3; i < 64; ++i)
            if (write(i, "nothing that anybody would understand, at all, ever", 51) < 0) continue;
    }
    return 0;
}

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
