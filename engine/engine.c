/* Event-exact integration of one oscillator over a communication step; see engine.h. Included behind the generated law. */
#include "flow.c"
#include "events.c"

#define DP_EVENT_BUDGET 400 /* events in one internal step; beyond it the motion is no longer physical */

/* One internal step of length h from tau. */
static int dp_substep(dp_engine *e, const dp_line *l, double tau, double h) {
    double z1[DP_NZ], z2[DP_NZ], f1[DP_NZ], g1[DP_NS + 1], gd1[DP_NS + 1], left = h, where = 2.0, gone;
    int n, event, breaks;
    for (n = 0; left > 0.0; ++n) {
        const double at = tau + (h - left);
        if (n > DP_EVENT_BUDGET) return DP_TOO_MANY_EVENTS;
        if (e->hold >= 0 && dp_excess(e, l, at, e->z) > 0.0) {
            DP_BEFORE(e, l, at);
            dp_release(e, l, at);
            DP_AFTER(e, l, at);
            e->node_ready = 0;
        }
        if (!e->node_ready) dp_surfaces_at(e, l, at, e->z, e->f, e->g, e->gd);
        e->node_ready = 0;
        dp_flow(e, l, at, left, e->z, e->f, z1, f1, g1, gd1);
        breaks = e->hold >= 0 && dp_excess(e, l, at + left, z1) > 0.0;
        event = dp_locate(e, l, at, left, g1, gd1, &where, z1);
        gone = breaks ? dp_break_away(e, l, at, left, e->f, z2) : 2.0;
        if (breaks && (event < 0 || gone <= where)) {
            DP_FLOWN(e, l, at, gone * left, e->f);
            memcpy(e->z, z2, sizeof z2);
            left = gone < 1.0 ? left * (1.0 - gone) : 0.0;
            DP_BREAKING(e, l, tau + (h - left));
            dp_release(e, l, tau + (h - left));
            DP_AFTER(e, l, tau + (h - left));
            continue;
        }
        DP_FLOWN(e, l, at, event < 0 ? left : where * left, e->f);
        memcpy(e->z, z1, sizeof z1);
        if (event < 0) {
            memcpy(e->f, f1, sizeof f1);
            memcpy(e->g, g1, sizeof g1);
            memcpy(e->gd, gd1, sizeof gd1);
            e->node_ready = 1;
            break;
        }
        left *= 1.0 - where;
        if (left < 1e-14 * h) left = 0.0;
        DP_CROSSING(e, l, tau + (h - left), event);
        dp_cross(e, l, tau + (h - left), event, h);
        DP_AFTER(e, l, tau + (h - left));
    }
    return DP_OK;
}

void dp_start(dp_engine *e, const double *p, const double *z, double t, double max_step) {
    memset(e, 0, sizeof *e);
    memcpy(e->p, p, sizeof e->p);
    memcpy(e->z, z, sizeof e->z);
    e->t = t;
    e->max_step = max_step;
    e->hold = -1;
    e->turn = z[1] == 0.0 ? z[0] : HUGE_VAL; /* a motion under way has not turned yet */
}

/* A single internal step in which nothing happens, as in nearly all: to the last bit what dp_run would do, in a third
 * of the time. Returns 0, with nothing changed, where something may happen. */
static int dp_glide(dp_engine *e, const dp_line *l, double dt) {
    double z1[DP_NZ], f1[DP_NZ], g1[DP_NS + 1], gd1[DP_NS + 1], f0[DP_NZ], g0[DP_NS + 1], gd0[DP_NS + 1];
    const double *f = e->f, *gd = e->gd, u = dp_force(l, dt);
    double finite = u - u;
    int i;
    if (DP_SURFACES_USE_FORCE || !e->modes_ready || e->hold >= 0 || !(dt <= e->max_step)) return 0;
    if (!e->node_ready || e->node_u != l->c[0]) {
        dp_surface(e->z, l->t0, l->c[0], l->c[1], e->p, e->s, f0, g0, gd0);
        f = f0, gd = gd0;
    }
    dp_flow_free(e, l, 0.0, dt, e->z, f, z1, f1, g1, gd1);
    if (dp_may_cross(e, gd, g1, gd1)) return 0;
    for (i = 0; i < DP_NZ; ++i) finite += z1[i] - z1[i];
    if (finite != 0.0) return 0;
    DP_FLOWN(e, l, 0.0, dt, f);
    memcpy(e->z, z1, sizeof z1);
    memcpy(e->f, f1, sizeof f1);
    memcpy(e->g, g1, sizeof g1);
    memcpy(e->gd, gd1, sizeof gd1);
    e->node_ready = 1;
    e->t += dt;
    e->node_u = u;
    e->node_rate = dp_force_rate(l, dt);
    return 1;
}

/* Integrates over dt along a force that begins now. */
static int dp_run(dp_engine *e, const dp_line *l, double dt) {
    const int steps = dt <= e->max_step ? 1 : (int)ceil(dt / e->max_step - 1e-9);
    const double h = dt / steps;
    int i, n, status = DP_OK;
    if (!e->modes_ready) dp_find_modes(e, l);
    if (DP_SURFACES_USE_FORCE && e->node_u != l->c[0]) dp_after_jump(e, l, e->s);
    if (e->node_u != l->c[0] || (DP_SURFACES_USE_FORCE && e->node_rate != l->c[1])) e->node_ready = 0;
    for (n = 0; n < steps && status == DP_OK; ++n) status = dp_substep(e, l, n * h, h);
    e->t += dt;
    e->node_u = dp_force(l, dt);
    e->node_rate = dp_force_rate(l, dt);
    for (i = 0; i < DP_NZ; ++i)
        if (!isfinite(e->z[i])) status = DP_NOT_FINITE;
    return status;
}

int dp_advance_along(dp_engine *e, const double *force, double dt) {
    const dp_line line = {{force[0], force[1], force[2], force[3]}, e->t};
    return dp_glide(e, &line, dt) ? DP_OK : dp_run(e, &line, dt);
}

int dp_advance(dp_engine *e, double u0, double u1, double dt) {
    const dp_line line = {{u0, dt > 0.0 ? (u1 - u0) / dt : 0.0, 0.0, 0.0}, e->t};
    const int status = dp_glide(e, &line, dt) ? DP_OK : dp_run(e, &line, dt);
    e->node_u = u1; /* without the rounding of the slope */
    return status;
}

void dp_outputs(dp_engine *e, double u, double *y) {
    const dp_line line = {{u, 0.0, 0.0, 0.0}, e->t};
    double s[DP_NS + 1];
    if (!e->modes_ready) dp_find_modes(e, &line);
    dp_signs(e, &line, s);
    if (DP_SURFACES_USE_FORCE) dp_after_jump(e, &line, s);
    dp_output(e->z, e->t, u, e->p, s, y);
}
