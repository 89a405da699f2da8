/* One oscillator as an importer sees it: numbered real variables over the engine. Knows no FMI version; fmi2.c does.
 * Included behind law.c and engine.c. */

enum { DP_INPUT, DP_OUTPUT, DP_PARAMETER, DP_INITIAL, DP_LONGEST_STEP };

typedef struct {
    int kind;
    int index; /* within the kind: which output, parameter, initial state */
    double start;
} dp_variable;

#include "variables.h" /* generated: DP_NV, DP_FORCE, DP_GUID, dp_variables[] by value reference, dp_follows[] by state */

#define DP_ORDERS 3 /* the engine takes a cubic */

/* Plain data without a pointer: a copy of it is the whole state of the model. */
typedef struct {
    dp_engine engine;
    double value[DP_NV];     /* by value reference; outputs are valid where outputs_ready */
    double slope[DP_ORDERS]; /* derivatives of the force at the start of the next step */
    double start_time;
    int running;             /* initial values are taken: they and the options are fixed from here on */
    int engine_ready;
    int outputs_ready;
} dp_instance;

static void dp_instance_reset(dp_instance *m) {
    int i;
    memset(m, 0, sizeof *m);
    for (i = 0; i < DP_NV; ++i) m->value[i] = dp_variables[i].start;
}

/* Puts the engine at the start with the values set so far; again after each of them while initialising. */
static void dp_instance_prepare(dp_instance *m) {
    double p[DP_NP], z[DP_NZ], step = 0.0;
    int i;
    if (m->engine_ready) return;
    memset(p, 0, sizeof p);
    memset(z, 0, sizeof z);
    for (i = 0; i < DP_NV; ++i) {
        if (dp_variables[i].kind == DP_PARAMETER) p[dp_variables[i].index] = m->value[i];
        if (dp_variables[i].kind == DP_INITIAL) z[dp_variables[i].index] = m->value[i];
        if (dp_variables[i].kind == DP_LONGEST_STEP) step = m->value[i];
    }
    for (i = 0; i < DP_NZ; ++i) /* what rides along starts with what it rides on, from its own offset */
        if (dp_follows[i] >= 0) z[i] += z[dp_follows[i]];
    dp_start(&m->engine, p, z, m->start_time, step);
    m->engine_ready = 1;
    m->outputs_ready = 0;
}

static void dp_instance_set(dp_instance *m, unsigned reference, double value) {
    const dp_variable *v = &dp_variables[reference];
    if (m->value[reference] == value) return; /* setting what is there already changes no bit of the run */
    m->value[reference] = value;
    m->outputs_ready = 0;
    if (!m->running) {
        m->engine_ready = 0;
    } else if (v->kind == DP_PARAMETER) {
        m->engine.p[v->index] = value;
        m->engine.modes_ready = m->engine.node_ready = 0;
    } else if (v->kind == DP_INPUT && m->engine.hold < 0 && m->engine.z[1] == 0.0) {
        m->engine.modes_ready = 0; /* at a turning point a jump of the force may decide that it sticks */
    }
}

static double dp_instance_get(dp_instance *m, unsigned reference) {
    if (dp_variables[reference].kind == DP_OUTPUT && !m->outputs_ready) {
        double y[DP_NY];
        int i;
        dp_instance_prepare(m);
        dp_outputs(&m->engine, m->value[DP_FORCE], y);
        for (i = 0; i < DP_NV; ++i)
            if (dp_variables[i].kind == DP_OUTPUT) m->value[i] = y[dp_variables[i].index];
        m->outputs_ready = 1;
    }
    return m->value[reference];
}

/* Runs from t to t + dt, the force from its value with its derivatives. It then stays where it came to until it is
 * set. On failure the model stands where it stood. */
static int dp_instance_step(dp_instance *m, double t, double dt) {
    const dp_instance before = *m;
    const double force[4] = {m->value[DP_FORCE], m->slope[0], m->slope[1] / 2.0, m->slope[2] / 6.0};
    int status;
    m->engine.t = t; /* the importer's clock: sums of steps would drift */
    status = dp_advance_along(&m->engine, force, dt);
    if (status == DP_OK && !isfinite(m->engine.node_u)) status = DP_NOT_FINITE;
    if (status != DP_OK) {
        *m = before;
        return status;
    }
    m->value[DP_FORCE] = m->engine.node_u;
    memset(m->slope, 0, sizeof m->slope);
    m->outputs_ready = 0;
    return DP_OK;
}
