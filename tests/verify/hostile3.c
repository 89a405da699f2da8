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
