/* FMI 2.0 over one instance of the model (instance.c): logging, instances, modes, values. Steps are in
 * fmi2_cosimulation.c, stored states in fmi2_state.c.
 *
 * Every call is checked against the state machine of FMI 2.0.5, section 4.2.4, and every argument before it is used. A
 * call that is refused returns fmi2Error, says why through the logger, and changes nothing. A step that cannot be done
 * returns fmi2Discard with the model where it stood. There is no global variable that changes: instances are
 * independent and may run in different threads. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi2_types.h"

enum { DP_NEW = 1, DP_INITIALISING = 2, DP_STEPPING = 4, DP_FAILED = 8, DP_ENDED = 16, DP_ANY = 31 };

/* What fmi2GetFMUstate keeps. */
typedef struct {
    dp_instance model;
    double stop_time; /* infinite where none was given */
    int mode;
} dp_state;

typedef struct {
    dp_state state;
    fmi2CallbackFunctions call;
    char *name;
} dp_component;

static void dp_log(const fmi2CallbackFunctions *call, const char *name, fmi2Status status, const char *text) {
    static const char *const category[] = {"logStatusOK",    "logStatusWarning", "logStatusDiscard",
                                           "logStatusError", "logStatusFatal",   "logStatusPending"};
    if (call->logger) call->logger(call->componentEnvironment, name, status, category[status], text);
}

/* Tells the importer why, and hands the status on. The text never holds a per cent sign: importers format it again. */
static fmi2Status dp_report(const dp_component *c, fmi2Status status, const char *format, ...) {
    char text[300];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    dp_log(&c->call, c->name, status, text);
    return status;
}

/* Whether the call may come now. */
static int dp_refused(const dp_component *c, int modes, const char *function) {
    const char *now;
    if (!c) return 1;
    if (c->state.mode & modes) return 0;
    now = c->state.mode == DP_NEW ? "before initialisation"
          : c->state.mode == DP_INITIALISING ? "in initialization mode"
          : c->state.mode == DP_STEPPING ? "between steps"
          : c->state.mode == DP_FAILED ? "after a step that failed" : "after fmi2Terminate";
    dp_report(c, fmi2Error, "%s is not allowed %s", function, now);
    return 1;
}

static int dp_bad_references(const dp_component *c, const fmi2ValueReference vr[], size_t n, const void *value,
                             const char *function) {
    size_t i;
    if (n == 0) return 0;
    if (!vr || !value) return dp_report(c, fmi2Error, "%s: null pointer", function) != fmi2OK;
    for (i = 0; i < n; ++i)
        if (vr[i] >= DP_NV)
            return dp_report(c, fmi2Error, "%s: no variable has the value reference %u", function, vr[i]) != fmi2OK;
    return 0;
}

/* All variables are real: asking for none of another type is fine, asking for one is not. */
static fmi2Status dp_no_variables(const dp_component *c, size_t n, const char *function) {
    if (!c) return fmi2Error;
    return n == 0 ? fmi2OK : dp_report(c, fmi2Error, "%s: all variables of this model are real", function);
}

static fmi2Status dp_unsupported(const dp_component *c, const char *function) {
    return c ? dp_report(c, fmi2Error, "%s: not among the capabilities of this model", function) : fmi2Error;
}

/* Versions, logging, instances ---------------------------------------------------------------------------------- */

FMI2_EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }

FMI2_EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

FMI2_EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component component, fmi2Boolean on, size_t n,
                                           const fmi2String categories[]) {
    dp_component *c = (dp_component *)component;
    (void)on;
    if (!c) return fmi2Error;
    if (n > 0 && !categories) return dp_report(c, fmi2Error, "fmi2SetDebugLogging: null pointer");
    return fmi2OK; /* there is nothing but refusals and failures to log, and those are never kept quiet */
}

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions *call, fmi2Boolean visible, fmi2Boolean logging) {
    dp_component *c;
    const char *problem = NULL;
    (void)resources, (void)visible, (void)logging;
    if (!call) return NULL;
    if (!name || !*name)
        problem = "fmi2Instantiate: the instance needs a name";
    else if (type != fmi2CoSimulation)
        problem = "fmi2Instantiate: this model is for co-simulation";
    else if (!guid || strcmp(guid, DP_GUID) != 0)
        problem = "fmi2Instantiate: the GUID is not that of this binary; modelDescription.xml belongs to another FMU";
    if (problem) {
        dp_log(call, name ? name : "", fmi2Error, problem);
        return NULL;
    }
    c = (dp_component *)calloc(1, sizeof *c);
    if (c) c->name = (char *)malloc(strlen(name) + 1);
    if (!c || !c->name) {
        dp_log(call, name, fmi2Error, "fmi2Instantiate: out of memory");
        free(c);
        return NULL;
    }
    strcpy(c->name, name);
    c->call = *call;
    c->state.mode = DP_NEW;
    c->state.stop_time = HUGE_VAL;
    dp_instance_reset(&c->state.model);
    return c;
}

FMI2_EXPORT void fmi2FreeInstance(fmi2Component component) {
    dp_component *c = (dp_component *)component;
    if (!c) return;
    free(c->name);
    free(c);
}

/* Modes --------------------------------------------------------------------------------------------------------- */

FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component component, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
    dp_component *c = (dp_component *)component;
    (void)has_tolerance, (void)tolerance; /* the internal step is fixed, far below any sensible tolerance */
    if (dp_refused(c, DP_NEW, "fmi2SetupExperiment")) return fmi2Error;
    if (!isfinite(start) || (has_stop && !(stop > start)))
        return dp_report(c, fmi2Error, "fmi2SetupExperiment: start %g and stop %g are no interval", start, stop);
    c->state.model.start_time = start;
    c->state.model.engine_ready = 0;
    c->state.stop_time = has_stop ? stop : HUGE_VAL;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component component) {
    dp_component *c = (dp_component *)component;
    if (dp_refused(c, DP_NEW, "fmi2EnterInitializationMode")) return fmi2Error;
    c->state.mode = DP_INITIALISING;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component component) {
    dp_component *c = (dp_component *)component;
    if (dp_refused(c, DP_INITIALISING, "fmi2ExitInitializationMode")) return fmi2Error;
    dp_instance_prepare(&c->state.model);
    c->state.model.running = 1;
    c->state.mode = DP_STEPPING;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2Terminate(fmi2Component component) {
    dp_component *c = (dp_component *)component;
    if (dp_refused(c, DP_STEPPING | DP_FAILED, "fmi2Terminate")) return fmi2Error;
    c->state.mode = DP_ENDED;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2Reset(fmi2Component component) {
    dp_component *c = (dp_component *)component;
    if (!c) return fmi2Error;
    dp_instance_reset(&c->state.model);
    c->state.mode = DP_NEW;
    c->state.stop_time = HUGE_VAL;
    return fmi2OK;
}

/* Values -------------------------------------------------------------------------------------------------------- */

FMI2_EXPORT fmi2Status fmi2GetReal(fmi2Component component, const fmi2ValueReference vr[], size_t n, fmi2Real value[]) {
    dp_component *c = (dp_component *)component;
    size_t i;
    if (dp_refused(c, DP_ANY & ~DP_NEW, "fmi2GetReal")) return fmi2Error;
    if (dp_bad_references(c, vr, n, value, "fmi2GetReal")) return fmi2Error;
    for (i = 0; i < n; ++i) {
        value[i] = dp_instance_get(&c->state.model, vr[i]);
        if (!isfinite(value[i]))
            return dp_report(c, fmi2Discard, "fmi2GetReal: variable %u is not finite with these parameters", vr[i]);
    }
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetReal(fmi2Component component, const fmi2ValueReference vr[], size_t n,
                                   const fmi2Real value[]) {
    dp_component *c = (dp_component *)component;
    size_t i;
    if (dp_refused(c, DP_NEW | DP_INITIALISING | DP_STEPPING, "fmi2SetReal")) return fmi2Error;
    if (dp_bad_references(c, vr, n, value, "fmi2SetReal")) return fmi2Error;
    for (i = 0; i < n; ++i) { /* all or nothing */
        const int kind = dp_variables[vr[i]].kind;
        if (!isfinite(value[i])) return dp_report(c, fmi2Error, "fmi2SetReal: variable %u: not a finite number", vr[i]);
        if (kind == DP_OUTPUT) return dp_report(c, fmi2Error, "fmi2SetReal: variable %u is an output", vr[i]);
        if ((kind == DP_INITIAL || kind == DP_LONGEST_STEP) && c->state.model.running)
            return dp_report(c, fmi2Error, "fmi2SetReal: variable %u is fixed after initialization", vr[i]);
        if (kind == DP_LONGEST_STEP && !(value[i] > 0.0))
            return dp_report(c, fmi2Error, "fmi2SetReal: the longest internal step must be positive, not %g", value[i]);
    }
    for (i = 0; i < n; ++i) dp_instance_set(&c->state.model, vr[i], value[i]);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Integer value[]) {
    (void)vr, (void)value;
    return dp_no_variables((dp_component *)c, n, "fmi2GetInteger");
}

FMI2_EXPORT fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2Boolean value[]) {
    (void)vr, (void)value;
    return dp_no_variables((dp_component *)c, n, "fmi2GetBoolean");
}

FMI2_EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t n, fmi2String value[]) {
    (void)vr, (void)value;
    return dp_no_variables((dp_component *)c, n, "fmi2GetString");
}

FMI2_EXPORT fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                      const fmi2Integer value[]) {
    (void)vr, (void)value;
    return dp_no_variables((dp_component *)c, n, "fmi2SetInteger");
}

FMI2_EXPORT fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                      const fmi2Boolean value[]) {
    (void)vr, (void)value;
    return dp_no_variables((dp_component *)c, n, "fmi2SetBoolean");
}

FMI2_EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                     const fmi2String value[]) {
    (void)vr, (void)value;
    return dp_no_variables((dp_component *)c, n, "fmi2SetString");
}

FMI2_EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[], size_t n,
                                                    const fmi2ValueReference known[], size_t m, const fmi2Real in[],
                                                    fmi2Real out[]) {
    (void)unknown, (void)n, (void)known, (void)m, (void)in, (void)out;
    return dp_unsupported((dp_component *)c, "fmi2GetDirectionalDerivative");
}
