/* What both versions of FMI ask of an instance: the state machine (FMI 2.0.5, sections 3.2.3 and 4.2.4; FMI 3.0.2,
 * section 2.3), checked arguments, values, steps, stored states. Included behind instance.c and the version's types,
 * which define dp_host (the importer's callbacks), dp_tell (one message to it) and DP_FMI (the prefix of names).
 *
 * A call that is refused returns an error, says why through the logger, and changes nothing. A step that cannot be done
 * returns discard with the model where it stood. There is no global variable that changes: instances are independent
 * and may run in different threads. */
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* the same numbers in both versions */
enum { DP_FINE = 0, DP_WARNING = 1, DP_DISCARD = 2, DP_ERROR = 3 };

enum {
    DP_NEW = 1,
    DP_INITIALISING = 2,
    DP_STEPPING = 4,
    DP_EVENT = 8,
    DP_CONTINUOUS = 16,
    DP_FAILED = 32,
    DP_ENDED = 64,
    DP_RUNNING = DP_STEPPING | DP_EVENT | DP_CONTINUOUS,
    DP_ANY = 127
};

/* What a stored state keeps. */
typedef struct {
    dp_instance model;
    double stop_time; /* infinite where none was given */
    int mode;
    int told; /* which warnings this run has given */
} dp_state;

typedef struct {
    dp_state state;
    dp_host host;
    char *name;
} dp_component;

static void dp_log(const dp_component *c, int status, const char *text) {
    static const char *const category[] = {"logStatusOK", "logStatusWarning", "logStatusDiscard", "logStatusError"};
    dp_tell(&c->host, c->name, status, category[status], text);
}

/* Tells the importer why, and hands the status on. The text never holds a per cent sign: importers format it again. */
static int dp_report(const dp_component *c, int status, const char *format, ...) {
    char text[300];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    dp_log(c, status, text);
    return status;
}

/* Whether the call may not come now. */
static int dp_refused(const dp_component *c, int modes, const char *function) {
    const char *now;
    if (!c) return 1;
    if (c->state.mode & modes) return 0;
    now = c->state.mode == DP_NEW            ? "before initialisation"
          : c->state.mode == DP_INITIALISING ? "in initialization mode"
          : c->state.mode == DP_STEPPING     ? "between steps"
          : c->state.mode == DP_EVENT        ? "in event mode"
          : c->state.mode == DP_CONTINUOUS   ? "in continuous-time mode"
          : c->state.mode == DP_FAILED       ? "after a step that failed"
                                             : "after the end";
    dp_report(c, DP_ERROR, DP_FMI "%s is not allowed %s", function, now);
    return 1;
}

static int dp_null(const dp_component *c, const char *function) {
    return dp_report(c, DP_ERROR, DP_FMI "%s: null pointer", function);
}

static int dp_bad_references(const dp_component *c, const unsigned *vr, size_t n, const void *value,
                             const char *function) {
    size_t i;
    if (n == 0) return 0;
    if (!vr || !value) return dp_null(c, function);
    for (i = 0; i < n; ++i)
        if (vr[i] >= DP_NV)
            return dp_report(c, DP_ERROR, DP_FMI "%s: no variable has the value reference %u", function, vr[i]);
    return 0;
}

/* All variables are real: asking for none of another type is fine, asking for one is not. */
static int dp_no_variables(const dp_component *c, size_t n, const char *function) {
    if (!c) return DP_ERROR;
    return n == 0 ? DP_FINE : dp_report(c, DP_ERROR, DP_FMI "%s: all variables of this model are real", function);
}

static int dp_unsupported(const dp_component *c, const char *function) {
    return c ? dp_report(c, DP_ERROR, DP_FMI "%s: not among the capabilities of this model", function) : DP_ERROR;
}

/* Instances and modes -------------------------------------------------------------------------------------------- */

static dp_component *dp_instantiate(const dp_host *host, const char *name, const char *guid, int exchange,
                                    const char *function) {
    dp_component probe, *c;
    memset(&probe, 0, sizeof probe);
    probe.host = *host;
    probe.name = (char *)(name ? name : "");
    if (!name || !*name) {
        dp_report(&probe, DP_ERROR, DP_FMI "%s: the instance needs a name", function);
        return NULL;
    }
    if (!guid || strcmp(guid, DP_GUID) != 0) {
        dp_report(&probe, DP_ERROR,
                  DP_FMI "%s: the GUID is not that of this binary; modelDescription.xml belongs to another FMU",
                  function);
        return NULL;
    }
    if (exchange < 0) {
        dp_report(&probe, DP_ERROR, DP_FMI "%s: this kind of FMU is neither co-simulation nor model exchange", function);
        return NULL;
    }
    c = (dp_component *)calloc(1, sizeof *c);
    if (c) c->name = (char *)malloc(strlen(name) + 1);
    if (!c || !c->name) {
        dp_report(&probe, DP_ERROR, DP_FMI "%s: out of memory", function);
        free(c);
        return NULL;
    }
    strcpy(c->name, name);
    c->host = *host;
    c->state.mode = DP_NEW;
    c->state.stop_time = HUGE_VAL;
    dp_instance_reset(&c->state.model, exchange);
    if (c->host.talkative && sizeof DP_STATE_OF_FIT > 1) dp_log(c, DP_WARNING, DP_STATE_OF_FIT);
    return c;
}

static void dp_free(dp_component *c) {
    if (!c) return;
    free(c->name);
    free(c);
}

static int dp_begin(dp_component *c, double start, int has_stop, double stop, const char *function) {
    if (!isfinite(start) || (has_stop && !(stop > start)))
        return dp_report(c, DP_ERROR, DP_FMI "%s: start %g and stop %g are no interval", function, start, stop);
    c->state.model.start_time = start;
    c->state.model.engine_ready = 0;
    c->state.stop_time = has_stop ? stop : HUGE_VAL;
    return DP_FINE;
}

static int dp_initialised(dp_component *c, const char *function) {
    dp_instance *m;
    if (dp_refused(c, DP_INITIALISING, function)) return DP_ERROR;
    m = &c->state.model;
    dp_instance_prepare(m);
    m->running = 1;
    if (m->exchange) {
        const dp_line line = dp_instance_line(m);
        dp_continuous_modes(m, &line);
    }
    c->state.mode = m->exchange ? DP_EVENT : DP_STEPPING;
    return DP_FINE;
}

static int dp_terminate(dp_component *c, const char *function) {
    if (dp_refused(c, DP_RUNNING | DP_FAILED, function)) return DP_ERROR;
    c->state.mode = DP_ENDED;
    return DP_FINE;
}

static int dp_reset(dp_component *c) {
    if (!c) return DP_ERROR;
    dp_instance_reset(&c->state.model, c->state.model.exchange);
    c->state.mode = DP_NEW;
    c->state.stop_time = HUGE_VAL;
    c->state.told = 0;
    return DP_FINE;
}

/* Values --------------------------------------------------------------------------------------------------------- */

static int dp_get_reals(dp_component *c, const unsigned *vr, size_t n, double *value, const char *function) {
    size_t i;
    if (dp_refused(c, DP_ANY & ~DP_NEW, function)) return DP_ERROR;
    if (dp_bad_references(c, vr, n, value, function)) return DP_ERROR;
    for (i = 0; i < n; ++i) {
        value[i] = dp_instance_get(&c->state.model, vr[i]);
        if (!isfinite(value[i]))
            return dp_report(c, DP_DISCARD, DP_FMI "%s: %s is not finite with these parameters", function,
                             dp_variables[vr[i]].name);
    }
    return DP_FINE;
}

/* Whether these values would leave nothing that moves. */
static int dp_weightless(const dp_instance *m, const unsigned *vr, size_t n, const double *value) {
    double p[DP_NP + 1], machine[DP_NM + 1];
    size_t i, found = 0;
    if (DP_NM == 0) return 0;
    for (i = 0; i < n; ++i) found += dp_variables[vr[i]].kind == DP_PARAMETER;
    if (found == 0) return 0;
    dp_instance_parameters(m, p);
    for (i = 0; i < n; ++i)
        if (dp_variables[vr[i]].kind == DP_PARAMETER) p[dp_variables[vr[i]].index] = value[i];
    dp_physical(p, machine);
    return !(machine[0] > 0.0);
}

static int dp_set_reals(dp_component *c, const unsigned *vr, size_t n, const double *value, const char *function) {
    size_t i;
    if (dp_refused(c, DP_NEW | DP_INITIALISING | DP_RUNNING, function)) return DP_ERROR;
    if (dp_bad_references(c, vr, n, value, function)) return DP_ERROR;
    for (i = 0; i < n; ++i) { /* all or nothing */
        const int kind = dp_variables[vr[i]].kind;
        const char *const name = dp_variables[vr[i]].name;
        if (!isfinite(value[i]))
            return dp_report(c, DP_ERROR, DP_FMI "%s: %s: not a finite number", function, name);
        /* an importer that integrates may set states one by one, as CasADi does */
        if (((kind >= DP_OUTPUT && kind <= DP_TIME) || kind == DP_PHYSICAL) &&
            !(c->state.mode == DP_CONTINUOUS && dp_instance_state(&dp_variables[vr[i]]) >= 0))
            return dp_report(c, DP_ERROR, DP_FMI "%s: %s is computed, not set", function, name);
        if ((kind == DP_INITIAL || kind == DP_LONGEST_STEP || kind == DP_EXTRAPOLATION) && c->state.model.running)
            return dp_report(c, DP_ERROR, DP_FMI "%s: %s is fixed after initialization", function, name);
        if (kind == DP_LONGEST_STEP && !(value[i] > 0.0))
            return dp_report(c, DP_ERROR, DP_FMI "%s: %s, the longest internal step, must be positive, not %g", function,
                             name, value[i]);
        if (kind == DP_SMOOTHING && !(value[i] >= 0.0))
            return dp_report(c, DP_ERROR, DP_FMI "%s: %s must be zero or positive, not %g", function, name, value[i]);
        if (value[i] < dp_variables[vr[i]].low || value[i] > dp_variables[vr[i]].high)
            return dp_report(c, DP_ERROR, DP_FMI "%s: %s: %g is outside its bounds, %g to %g", function, name,
                             value[i], dp_variables[vr[i]].low, dp_variables[vr[i]].high);
    }
    if (dp_weightless(&c->state.model, vr, n, value))
        return dp_report(c, DP_ERROR, DP_FMI "%s: mass and payload must come to more than zero", function);
    for (i = 0; i < n; ++i) dp_instance_set(&c->state.model, vr[i], value[i]);
    return DP_FINE;
}

/* Adds what moving a known variable at this rate does. */
static int dp_move(const dp_component *c, unsigned known, double rate, dp_direction *d) {
    const dp_variable *v = &dp_variables[known];
    int i;
    switch (v->kind) {
    case DP_INPUT: d->force += rate; return 1;
    case DP_MOTION: d->z[v->index] += rate; return 1;
    case DP_SLOPE:
    case DP_EXTRAPOLATION:
    case DP_LONGEST_STEP: return 1;
    case DP_TIME: d->time += rate; return 1;
    case DP_PARAMETER: d->p[v->index] += rate; return 1;
    case DP_SMOOTHING: d->smoothing += rate; return 1;
    case DP_OUTPUT:
    case DP_STATE:
        if (dp_instance_state(v) < 0) return 0;
        d->z[dp_instance_state(v)] += rate;
        return 1;
    case DP_INITIAL:
        if (c->state.model.running) return 0;
        d->z[v->index] += rate;
        for (i = 0; i < DP_NZ; ++i)
            if (dp_follows[i] == v->index) d->z[i] += rate;
        return 1;
    default: return 0;
    }
}

static int dp_derivative(dp_component *c, const unsigned *unknown, size_t n, const unsigned *known, size_t count,
                         const double *seed, double *sensitivity, const char *function) {
    dp_direction direction;
    dp_change change;
    size_t i;
    if (dp_refused(c, DP_INITIALISING | DP_RUNNING | DP_ENDED, function)) return DP_ERROR;
    if (dp_bad_references(c, unknown, n, sensitivity, function)) return DP_ERROR;
    if (dp_bad_references(c, known, count, seed, function)) return DP_ERROR;
    memset(&direction, 0, sizeof direction);
    for (i = 0; i < count; ++i) {
        if (!isfinite(seed[i]))
            return dp_report(c, DP_ERROR, DP_FMI "%s: the seed of %s is not a finite number", function,
                             dp_variables[known[i]].name);
        if (!dp_move(c, known[i], seed[i], &direction))
            return dp_report(c, DP_ERROR, DP_FMI "%s: %s is not known now", function, dp_variables[known[i]].name);
    }
    dp_continuous_tangent(&c->state.model, &direction, &change);
    for (i = 0; i < n; ++i) {
        const dp_variable *v = &dp_variables[unknown[i]];
        switch (v->kind) {
        case DP_OUTPUT: sensitivity[i] = change.y[v->index]; break;
        case DP_POWER: sensitivity[i] = change.power[v->index]; break;
        case DP_DERIVATIVE: sensitivity[i] = change.f[v->index]; break;
        case DP_INDICATOR: sensitivity[i] = change.g[v->index]; break;
        case DP_PHYSICAL: sensitivity[i] = change.machine[v->index]; break;
        case DP_STATE: sensitivity[i] = direction.z[v->index]; break;
        case DP_SWING:
        case DP_OUTSIDE: sensitivity[i] = 0.0; break;
        default: return dp_report(c, DP_ERROR, DP_FMI "%s: %s is not unknown", function, v->name);
        }
        if (!isfinite(sensitivity[i]))
            return dp_report(c, DP_DISCARD, DP_FMI "%s: %s has no finite derivative here", function, v->name);
    }
    return DP_FINE;
}
