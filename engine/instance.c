/* One oscillator as an importer sees it: numbered real variables over the engine. Knows no FMI version. Included behind
 * law.c and engine.c. */

enum {
    DP_INPUT,
    DP_SLOPE, /* of the input, over the coming step */
    DP_OUTPUT,
    DP_POWER,      /* energy, dissipated power */
    DP_SWING,      /* the amplitude */
    DP_OUTSIDE,    /* whether the motion is one that the model was identified for */
    DP_STATE,      /* states and what follows from them, for the importer's integrator: continuous.c */
    DP_DERIVATIVE,
    DP_INDICATOR,
    DP_TIME,
    DP_PARAMETER,
    DP_INITIAL,
    DP_LONGEST_STEP,
    DP_SMOOTHING,
    DP_EXTRAPOLATION, /* of a force that is set without a slope */
    DP_PHYSICAL,      /* the machine in its own units: follows from the parameters */
    DP_MOTION         /* an input that is a state: of a motion that is given */
};

typedef struct {
    int kind;
    int index; /* within the kind: which output, parameter, initial state */
    double start;
    double low, high; /* bounds; infinite where there is none */
    const char *name; /* for what is told the importer */
} dp_variable;

/* What the recordings covered of a variable, and from where on a value is clearly outside. */
typedef struct {
    unsigned reference;
    double low, high, least, most;
    const char *unit;
} dp_covered_range;

#include "variables.h" /* generated: the variables by value reference, and the sizes of the motion */

#define DP_OWN (DP_NZ - DP_GIVEN) /* states that follow, behind those of a motion that is given */
#define DP_ORDERS 3 /* the engine takes a cubic */

enum { DP_OUTPUTS_READY = 1, DP_POWER_READY = 2, DP_RATES_READY = 4, DP_INDICATORS_READY = 8 };

/* Plain data without a pointer: a copy of it is the whole state of the model. */
typedef struct {
    dp_engine engine;
    double value[DP_NV];     /* by value reference, of what can be set */
    double slope[DP_ORDERS]; /* derivatives of the force at the start of the next step */
    double rate;             /* slope of the force at the end of the latest step */
    double told, told_at;    /* the force that was last set, and when the step began that it was set for */
    int fed, feeds;          /* whether the force was set since the latest step; steps that told is from, at most one */
    double y[DP_NY];         /* computed at the present state, where ready says so */
    double power[2];
    double f[DP_NZ];
    double indicator[DP_NS + 1];
    double start_time;
    int ready;
    int exchange;     /* the importer integrates (model exchange) */
    int running;      /* initial values are taken: they and the options are fixed from here on */
    int engine_ready;
} dp_instance;

static void dp_instance_reset(dp_instance *m, int exchange) {
    int i;
    memset(m, 0, sizeof *m);
    m->exchange = exchange;
    for (i = 0; i < DP_NV; ++i) m->value[i] = dp_variables[i].start;
}

static void dp_instance_parameters(const dp_instance *m, double *p) {
    int i;
    for (i = 0; i < DP_NV; ++i)
        if (dp_variables[i].kind == DP_PARAMETER) p[dp_variables[i].index] = m->value[i];
}

/* Puts the engine at the start with the values set so far; again after each of them while initialising. */
static void dp_instance_prepare(dp_instance *m) {
    double p[DP_NP], z[DP_NZ], step = 0.0;
    int i;
    if (m->engine_ready) return;
    memset(p, 0, sizeof p);
    memset(z, 0, sizeof z);
    dp_instance_parameters(m, p);
    for (i = 0; i < DP_NV; ++i) {
        if (dp_variables[i].kind == DP_INITIAL || dp_variables[i].kind == DP_MOTION)
            z[dp_variables[i].index] = m->value[i];
        if (dp_variables[i].kind == DP_LONGEST_STEP) step = m->value[i];
    }
    for (i = 0; i < DP_NZ; ++i) /* what rides along starts with what it rides on, from its own offset */
        if (dp_follows[i] >= 0) z[i] += z[dp_follows[i]];
    dp_start(&m->engine, p, z, m->start_time, step);
    m->engine_ready = 1;
    m->ready = 0;
}

/* The force as the right-hand side takes it at the present time, which is known once the engine is at the start. */
static dp_line dp_instance_line(dp_instance *m) {
    dp_line line = {{0.0, 0.0, 0.0, 0.0}, 0.0};
    dp_instance_prepare(m);
    line.c[0] = m->value[DP_FORCE];
    line.c[1] = DP_FORCE_RATE >= 0 ? m->value[DP_FORCE_RATE >= 0 ? DP_FORCE_RATE : 0] : 0.0;
    line.t0 = m->engine.t;
    return line;
}

#include "continuous.c"

/* Which state a variable is, or -1: displacement and velocity are the first two, and outputs as well. */
static int dp_instance_state(const dp_variable *v) {
    if (v->kind == DP_OUTPUT) return v->index == 1 || v->index == 2 ? v->index - 1 : -1;
    return v->kind == DP_STATE ? v->index : -1;
}

/* Puts a motion that is given where the importer has it: which side of a surface that is, is asked anew. */
static void dp_instance_move(dp_instance *m, unsigned reference, double value) {
    double *z = &m->engine.z[dp_variables[reference].index];
    if (!m->running && m->value[reference] != value) m->engine_ready = 0;
    m->value[reference] = value;
    m->ready = 0;
    if (!m->running || *z == value) return;
    *z = value;
    m->engine.node_ready = 0;
    if (!m->exchange) m->engine.modes_ready = 0; /* there an event tells */
}

static void dp_instance_set(dp_instance *m, unsigned reference, double value) {
    const dp_variable *v = &dp_variables[reference];
    const int state = dp_instance_state(v);
    if (v->kind == DP_MOTION) {
        dp_instance_move(m, reference, value);
        return;
    }
    if (state >= 0) {
        m->engine.z[state] = value;
        m->ready = 0;
        return;
    }
    if (v->kind == DP_INPUT) m->fed = 1;
    if (m->value[reference] == value) return; /* setting what is there already changes no bit of the run */
    m->value[reference] = value;
    m->ready = 0;
    if (!m->running) {
        m->engine_ready = 0;
    } else if (v->kind == DP_PARAMETER) {
        m->engine.p[v->index] = value;
        m->engine.node_ready = 0;
        if (!(DP_GIVEN && m->exchange)) m->engine.modes_ready = 0; /* a channel moves all the time: an event tells */
    } else if (v->kind == DP_SMOOTHING && m->exchange) {
        m->engine.modes_ready = 0;
    } else if (v->kind == DP_INPUT && !m->exchange && m->engine.z[1] == 0.0) {
        m->engine.modes_ready = 0; /* a jump of the force may decide whether a motion without velocity sticks */
    }
}

/* 1 where a value is above what the recordings covered of its variable, -1 below it, else 0; an amplitude of zero is
 * one of a motion that has not turned yet. */
static int dp_outside(const dp_covered_range *covered, double value) {
    if (value > covered->most) return 1;
    return value < covered->least && !(dp_variables[covered->reference].kind == DP_SWING && value == 0.0) ? -1 : 0;
}

static double dp_instance_get(dp_instance *m, unsigned reference);

/* The same of all that is covered: the first that is outside. */
static int dp_instance_outside(dp_instance *m) {
    int i, outside = 0;
    for (i = 0; i < DP_NCOVERED && !outside; ++i)
        outside = dp_outside(&dp_covered[i], dp_instance_get(m, dp_covered[i].reference));
    return outside;
}

static double dp_instance_get(dp_instance *m, unsigned reference) {
    const dp_variable *v = &dp_variables[reference];
    if (v->kind >= DP_OUTPUT && v->kind <= DP_TIME) dp_instance_prepare(m);
    switch (v->kind) {
    case DP_OUTPUT: dp_continuous_outputs(m); return m->y[v->index];
    case DP_POWER: dp_continuous_power(m); return m->power[v->index];
    case DP_SWING: return m->engine.swing;
    case DP_OUTSIDE: return dp_instance_outside(m);
    case DP_STATE: return m->engine.z[v->index];
    case DP_DERIVATIVE: dp_continuous_rates(m); return m->f[v->index];
    case DP_INDICATOR: dp_continuous_indicators(m); return m->indicator[v->index];
    case DP_TIME: return m->engine.t;
    case DP_PHYSICAL: {
        double p[DP_NP + 1], machine[DP_NM + 1];
        dp_instance_parameters(m, p);
        dp_physical(p, machine);
        return machine[v->index];
    }
    default: return m->value[reference];
    }
}

/* Makes the line go on as the last two values of the force go that were set, where that is asked for and no slope is
 * given. A force that is not set again stays at the last: it was told, and what came of it is a guess. */
static void dp_instance_extrapolate(dp_instance *m, dp_line *line, double t) {
    const double part = DP_EXTRAPOLATION_AT >= 0 ? m->value[DP_EXTRAPOLATION_AT >= 0 ? DP_EXTRAPOLATION_AT : 0] : 0.0;
    double now = line->c[0];
    if (!(part > 0.0)) return;
    if (m->feeds && !m->fed) line->c[0] = now = m->told;
    if (m->feeds && m->fed && t > m->told_at && line->c[1] == 0.0 && line->c[2] == 0.0 && line->c[3] == 0.0)
        line->c[1] = part * (now - m->told) / (t - m->told_at);
    m->told = now;
    m->told_at = t;
    m->feeds = 1;
}

/* Runs from t to t + dt, the force from its value with its derivatives. It then stays where it came to until it is
 * set. On failure the model stands where it stood. */
static int dp_instance_step(dp_instance *m, double t, double dt) {
    dp_engine *e = &m->engine;
    dp_line line = dp_instance_line(m);
    const double stood = e->t;
    line.c[1] += m->slope[0];
    line.c[2] = m->slope[1] / 2.0;
    line.c[3] = m->slope[2] / 6.0;
    dp_instance_extrapolate(m, &line, t);
    line.t0 = e->t = t; /* the importer's clock: sums of steps would drift */
    if (!dp_glide(e, &line, dt)) {
        const dp_engine before = *e;
        int status = dp_run(e, &line, dt);
        if (status == DP_OK && !isfinite(e->node_u)) status = DP_NOT_FINITE;
        if (status != DP_OK) {
            *e = before;
            e->t = stood;
            return status;
        }
    }
    m->value[DP_FORCE] = e->node_u;
    m->rate = line.c[1] + dt * (2.0 * line.c[2] + dt * 3.0 * line.c[3]);
    m->fed = 0;
    memset(m->slope, 0, sizeof m->slope);
    m->ready = 0;
    return DP_OK;
}
