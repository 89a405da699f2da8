/* Event-exact integration of one oscillator; see engine.h. Included behind the generated law. */
#include <math.h>
#include <string.h>

#include "engine.h"

#define DP_EVENT_BUDGET 400  /* events in one internal step; beyond it the motion is no longer physical */
#define DP_REST 0.01         /* a flight shorter than this part of an internal step ends at rest on its surface */

typedef struct {
    double c[4]; /* force within the step: c0 + c1 tau + c2 tau^2 + c3 tau^3 */
    double t0;   /* time at tau = 0 */
} dp_line;

static double dp_force(const dp_line *l, double tau) {
    return l->c[0] + tau * (l->c[1] + tau * (l->c[2] + tau * l->c[3]));
}

static double dp_force_rate(const dp_line *l, double tau) {
    return l->c[1] + tau * (2.0 * l->c[2] + tau * 3.0 * l->c[3]);
}

static double dp_capacity(const dp_engine *e, const dp_line *l, double tau, const double *z, int i, double *rest);

/* The signs while the motion is held: each surface carries its share of what balances the other forces. */
static void dp_shares(const dp_engine *e, const dp_line *l, double tau, const double *z, double *s) {
    double f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1], rest, share;
    const double capacity = dp_capacity(e, l, tau, z, e->hold, &rest);
    int j;
    share = capacity > 0.0 ? fmax(-1.0, fmin(1.0, rest / capacity)) : 0.0;
    memcpy(s, e->s, sizeof e->s);
    dp_surface(z, l->t0 + tau, dp_force(l, tau), dp_force_rate(l, tau), e->p, e->s, f, g, gd);
    for (j = 0; j < DP_NS; ++j)
        if (j == e->hold || (dp_kind[j] == DP_POSITION && g[j] == 0.0)) s[j] = share;
}

/* Displacement and velocity stand still while the motion is held; where the inner states feel the acceleration (a
 * sensor that follows it) they go on with that of a mass at rest. */
static void dp_hold_rates(const dp_engine *e, const dp_line *l, double tau, const double *z, double *f) {
    if (DP_RATES_FEEL_REST) {
        double s[DP_NS + 1];
        dp_shares(e, l, tau, z, s);
        dp_field(z, l->t0 + tau, dp_force(l, tau), e->p, s, f);
    }
    f[0] = f[1] = 0.0;
}

static void dp_field_at(const dp_engine *e, const dp_line *l, double tau, const double *z, double *f) {
    dp_field(z, l->t0 + tau, dp_force(l, tau), e->p, e->s, f);
    if (e->hold >= 0) dp_hold_rates(e, l, tau, z, f);
}

static void dp_surfaces_at(const dp_engine *e, const dp_line *l, double tau, const double *z, double *f, double *g,
                           double *gd) {
    dp_surface(z, l->t0 + tau, dp_force(l, tau), dp_force_rate(l, tau), e->p, e->s, f, g, gd);
    if (e->hold >= 0) dp_hold_rates(e, l, tau, z, f);
}

/* One Dormand-Prince step of length h from z (right-hand side k1) to out. */
static void dp_step(const dp_engine *e, const dp_line *l, double tau, double h, const double *z, const double *k1,
                    double *out) {
    static const double c[5] = {1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0};
    static const double a[6][6] = {
        {1.0 / 5},
        {3.0 / 40, 9.0 / 40},
        {44.0 / 45, -56.0 / 15, 32.0 / 9},
        {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
        {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
        {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
    };
    double k[6][DP_NZ], y[DP_NZ];
    int i, j, n;
    memcpy(k[0], k1, sizeof k[0]);
    for (i = 0; i < 6; ++i) {
        for (n = 0; n < DP_NZ; ++n) {
            double sum = 0.0;
            for (j = 0; j <= i; ++j) sum += a[i][j] * k[j][n];
            y[n] = z[n] + h * sum;
        }
        if (i < 5) dp_field_at(e, l, tau + c[i] * h, y, k[i + 1]);
    }
    memcpy(out, y, sizeof y);
}

/* The acceleration without what can hold the motion (*rest), and how much that is: friction on the velocity surface i
 * and the steps of the position surfaces that the motion rests on. Negative capacity: nothing can hold. */
static double dp_capacity(const dp_engine *e, const dp_line *l, double tau, const double *z, int i, double *rest) {
    double s[DP_NS + 1], f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1], base, capacity = 0.0;
    int j, joined[DP_NS + 1];
    const double t = l->t0 + tau, u = dp_force(l, tau);
    memcpy(s, e->s, sizeof s);
    dp_surface(z, t, u, dp_force_rate(l, tau), e->p, s, f, g, gd);
    for (j = 0; j < DP_NS; ++j) {
        joined[j] = j == i || (dp_kind[j] == DP_POSITION && g[j] == 0.0);
        if (joined[j]) s[j] = 0.0;
    }
    dp_field(z, t, u, e->p, s, f);
    *rest = base = f[1];
    for (j = 0; j < DP_NS; ++j) {
        double part;
        if (!joined[j]) continue;
        s[j] = 1.0;
        dp_field(z, t, u, e->p, s, f);
        s[j] = 0.0;
        part = base - f[1];
        if (j == i || part > 0.0) capacity += part; /* a negative friction (a fit may try one) takes from what holds */
    }
    return capacity;
}

/* The motion has v = 0 on the velocity surface i: it sticks, or it goes where the forces push it. */
static void dp_stick_or_go(dp_engine *e, const dp_line *l, double tau, int i, double came_from) {
    double f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1], rest, capacity;
    int j;
    e->z[1] = 0.0;
    capacity = dp_capacity(e, l, tau, e->z, i, &rest);
    dp_surface(e->z, l->t0 + tau, dp_force(l, tau), dp_force_rate(l, tau), e->p, e->s, f, g, gd);
    e->hold = fabs(rest) <= capacity ? i : -1;
    for (j = 0; j < DP_NS; ++j) {
        if (j != i && !(dp_kind[j] == DP_POSITION && g[j] == 0.0)) continue;
        if (e->hold >= 0)
            e->s[j] = 0.0;
        else if (capacity < 0.0 && came_from != 0.0 && j == i)
            e->s[j] = -came_from;
        else
            e->s[j] = rest >= 0.0 ? 1.0 : -1.0;
    }
}

/* Signs from the state alone, after somebody set it. */
static void dp_find_modes(dp_engine *e, const dp_line *l) {
    double f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1];
    int i, stopped = -1;
    e->hold = -1;
    for (i = 0; i < DP_NS; ++i) e->s[i] = 0.0;
    dp_surface(e->z, l->t0, l->c[0], l->c[1], e->p, e->s, f, g, gd);
    for (i = 0; i < DP_NS; ++i) {
        if (g[i] != 0.0)
            e->s[i] = g[i] > 0.0 ? 1.0 : -1.0;
        else if (dp_kind[i] == DP_VELOCITY)
            stopped = i;
        else
            e->s[i] = gd[i] < 0.0 ? -1.0 : 1.0;
    }
    if (stopped >= 0) dp_stick_or_go(e, l, 0.0, stopped, 0.0);
    e->modes_ready = 1;
    e->node_ready = 0;
}

/* Signs s put right after a jump of the force. */
static void dp_after_jump(const dp_engine *e, const dp_line *l, double *s) {
    double f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1];
    int i;
    dp_surface(e->z, l->t0, l->c[0], l->c[1], e->p, s, f, g, gd);
    for (i = 0; i < DP_NS; ++i)
        if (dp_kind[i] == DP_OTHER && g[i] * s[i] < 0.0) s[i] = -s[i];
}

/* Value of the cubic through (0, g0, d0) and (1, g1, d1), rates times the step. */
static double dp_hermite(double g0, double d0, double g1, double d1, double x) {
    const double y = 1.0 - x;
    return g0 * (1.0 + 2.0 * x) * y * y + d0 * x * y * y + g1 * x * x * (3.0 - 2.0 * x) - d1 * x * x * y;
}

/* Where in (0, 1] surface values that start on the side m first reach the other side: sets *hi beyond the crossing
 * and returns an estimate of it, or returns a value above 1 where nothing is crossed. */
static double dp_first_crossing(double m, double g0, double d0, double g1, double d1, double *hi) {
    double lo = 0.0, top = 1.0, x;
    int n;
    g0 *= m, d0 *= m, g1 *= m, d1 *= m;
    if (g0 < 0.0 && g1 < 0.0 && d0 <= 0.0) {
        *hi = 0.0;
        return 0.0;  /* already on the other side */
    }
    /* A minimum inside may dip below zero (the slope of the cubic is a parabola). Not where the motion has just left
     * the surface: there a negative slope is rounding. */
    if (g0 != 0.0 && d0 < 0.0 && (d1 > 0.0 || g1 < 0.0)) {
        const double a = 6.0 * (g0 - g1) + 3.0 * (d0 + d1), b = -6.0 * (g0 - g1) - 4.0 * d0 - 2.0 * d1;
        const double disc = b * b - 4.0 * a * d0;
        if (disc > 0.0) {
            const double q = -0.5 * (b + copysign(sqrt(disc), b));
            const double r1 = a != 0.0 ? q / a : 2.0, r2 = q != 0.0 ? d0 / q : 2.0;
            x = 2.0;
            if (r1 > 0.0 && r1 < 1.0) x = r1;
            if (r2 > 0.0 && r2 < x) x = r2;
            if (x < 1.0 && dp_hermite(g0, d0, g1, d1, x) < 0.0) top = x;
        }
    }
    if (top == 1.0 && g1 >= 0.0) return 2.0;
    *hi = top;
    for (n = 0; n < 60 && top - lo > 1e-9; ++n) {
        x = 0.5 * (lo + top);
        if (dp_hermite(g0, d0, g1, d1, x) < 0.0)
            top = x;
        else
            lo = x;
    }
    return 0.5 * (lo + top);
}

/* Locates the first event within the step of length h from the node; g1, gd1: surfaces at its end. Returns the surface,
 * its place (part of h) in *where and the state there in z; or -1, with z as it was. */
static int dp_locate(const dp_engine *e, const dp_line *l, double tau, double h, const double *g1, const double *gd1,
                     double *where, double *z) {
    double f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1], trial[DP_NZ], best = 1.5, top = 1.0, lo, hi, x, next;
    int i, j, n, again, event = -1;
    for (i = 0; i < DP_NS; ++i) {
        double beyond = 1.0;
        if (e->s[i] == 0.0) continue;
        x = dp_first_crossing(e->s[i], e->g[i], e->gd[i] * h, g1[i], gd1[i] * h, &beyond);
        if (x < best) best = x, top = beyond, event = i;
    }
    for (again = 0; event >= 0 && again <= DP_NS; ++again) {
        int reached = 0;
        for (lo = 0.0, hi = top, x = best, n = 0; n < 80; ++n) { /* Newton on the flow, inside a bracket that moves */
            dp_step(e, l, tau, x * h, e->z, e->f, trial);
            dp_surfaces_at(e, l, tau + x * h, trial, f, g, gd);
            reached |= g[event] * e->s[event] <= 0.0;
            if (g[event] * e->s[event] < 0.0)
                hi = x;
            else
                lo = x;
            next = gd[event] != 0.0 ? x - g[event] / (gd[event] * h) : 2.0;
            if (g[event] == 0.0 || fabs(next - x) < 1e-13) {
                reached = 1;
                break;
            }
            if (hi - lo < 1e-13) break;
            x = next > lo && next < hi ? next : 0.5 * (lo + hi);
        }
        if (!reached && g1[event] * e->s[event] >= 0.0) return -1; /* a dip of the interpolant that the flow has not */
        *where = x;
        for (j = 0; j < DP_NS; ++j) /* did another surface come first? */
            if (j != event && e->s[j] * g[j] < 0.0 && e->s[j] * e->g[j] > 0.0) break;
        if (j == DP_NS) break;
        event = j, top = x, best = x * e->g[j] / (e->g[j] - g[j]);
    }
    if (event >= 0) memcpy(z, trial, sizeof trial);
    return event;
}

/* Puts the state on surface i and lets it cross, stick, or come to rest. */
static void dp_cross(dp_engine *e, const dp_line *l, double tau, int i, double h) {
    double f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1], rest, capacity;
    const double m = e->s[i];
    int j;
    ++e->events;
    if (dp_kind[i] == DP_VELOCITY) {
        dp_stick_or_go(e, l, tau, i, m);
        return;
    }
    e->s[i] = -m;
    if (dp_kind[i] != DP_POSITION) return;
    dp_surfaces_at(e, l, tau, e->z, f, g, gd);
    if (gd[i] != 0.0) e->z[0] -= g[i] * e->z[1] / gd[i];
    /* A flight that would be over at once: infinitely many would follow in finite time (Zeno). */
    if (f[1] * e->z[1] >= 0.0 || 2.0 * fabs(e->z[1]) > DP_REST * h * fabs(f[1])) return;
    for (j = 0; j < DP_NS; ++j)
        if (dp_kind[j] == DP_VELOCITY) {
            const double v = e->z[1];
            e->z[1] = 0.0;
            capacity = dp_capacity(e, l, tau, e->z, j, &rest);
            if (fabs(rest) <= capacity) {
                dp_stick_or_go(e, l, tau, j, 0.0);
                return;
            }
            e->z[1] = v;
        }
}

/* How far the forces exceed what holds the motion; positive: it breaks away. */
static double dp_excess(const dp_engine *e, const dp_line *l, double tau, const double *z) {
    double rest;
    const double capacity = dp_capacity(e, l, tau, z, e->hold, &rest);
    return fabs(rest) - capacity;
}

/* Lets a held motion go, in the direction of the forces. */
static void dp_release(dp_engine *e, const dp_line *l, double tau) {
    double rest, f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1];
    int j;
    dp_capacity(e, l, tau, e->z, e->hold, &rest);
    dp_surface(e->z, l->t0 + tau, dp_force(l, tau), dp_force_rate(l, tau), e->p, e->s, f, g, gd);
    for (j = 0; j < DP_NS; ++j)
        if (j == e->hold || (dp_kind[j] == DP_POSITION && g[j] == 0.0)) e->s[j] = rest >= 0.0 ? 1.0 : -1.0;
    e->hold = -1;
    ++e->events;
}

/* The held motion breaks away somewhere in the step of length h: where (part of h), and the state there. */
static double dp_break_away(const dp_engine *e, const dp_line *l, double tau, double h, const double *k1, double *z) {
    double lo = 0.0, hi = 1.0, low, high, x = 1.0, excess;
    int n;
    low = dp_excess(e, l, tau, e->z);
    dp_step(e, l, tau, h, e->z, k1, z);
    high = dp_excess(e, l, tau + h, z);
    for (n = 0; n < 100 && hi - lo > 1e-15; ++n) { /* the excess is a straight line but for kinks: secant, else halve */
        x = n % 3 < 2 && high > low ? lo - (hi - lo) * low / (high - low) : 0.5 * (lo + hi);
        if (!(x > lo && x < hi)) x = 0.5 * (lo + hi);
        dp_step(e, l, tau, x * h, e->z, k1, z);
        excess = dp_excess(e, l, tau + x * h, z);
        if (excess >= 0.0)
            hi = x, high = excess;
        else
            lo = x, low = excess;
        if (excess == 0.0) break;
    }
    dp_step(e, l, tau, hi * h, e->z, k1, z); /* the free side: from the other one it would stick again at once */
    return hi;
}

/* One internal step of length h from tau. */
static int dp_substep(dp_engine *e, const dp_line *l, double tau, double h) {
    double z1[DP_NZ], z2[DP_NZ], f1[DP_NZ], g1[DP_NS + 1], gd1[DP_NS + 1], left = h, where = 2.0, gone;
    int n, event, breaks;
    for (n = 0; left > 0.0; ++n) {
        const double at = tau + (h - left);
        if (n > DP_EVENT_BUDGET) return DP_TOO_MANY_EVENTS;
        if (e->hold >= 0 && dp_excess(e, l, at, e->z) > 0.0) {
            dp_release(e, l, at);
            e->node_ready = 0;
        }
        if (!e->node_ready) dp_surfaces_at(e, l, at, e->z, e->f, e->g, e->gd);
        e->node_ready = 0;
        dp_step(e, l, at, left, e->z, e->f, z1);
        dp_surfaces_at(e, l, at + left, z1, f1, g1, gd1);
        breaks = e->hold >= 0 && dp_excess(e, l, at + left, z1) > 0.0;
        event = dp_locate(e, l, at, left, g1, gd1, &where, z1);
        gone = breaks ? dp_break_away(e, l, at, left, e->f, z2) : 2.0;
        if (breaks && (event < 0 || gone <= where)) {
            memcpy(e->z, z2, sizeof z2);
            left = gone < 1.0 ? left * (1.0 - gone) : 0.0;
            dp_release(e, l, tau + (h - left));
            continue;
        }
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
        dp_cross(e, l, tau + (h - left), event, h);
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
}

int dp_advance_along(dp_engine *e, const double *force, double dt) {
    const dp_line line = {{force[0], force[1], force[2], force[3]}, e->t};
    const int steps = (int)ceil(dt / e->max_step - 1e-9);
    const double h = steps > 0 ? dt / steps : 0.0;
    int i, n, status = DP_OK;
    if (!e->modes_ready) dp_find_modes(e, &line);
    if (DP_SURFACES_USE_FORCE && e->node_u != force[0]) dp_after_jump(e, &line, e->s);
    if (e->node_u != force[0] || (DP_SURFACES_USE_FORCE && e->node_rate != force[1])) e->node_ready = 0;
    for (n = 0; n < steps && status == DP_OK; ++n) status = dp_substep(e, &line, n * h, h);
    e->t += dt;
    e->node_u = dp_force(&line, dt);
    e->node_rate = dp_force_rate(&line, dt);
    for (i = 0; i < DP_NZ; ++i)
        if (!isfinite(e->z[i])) status = DP_NOT_FINITE;
    return status;
}

int dp_advance(dp_engine *e, double u0, double u1, double dt) {
    const double line[4] = {u0, dt > 0.0 ? (u1 - u0) / dt : 0.0, 0.0, 0.0};
    const int status = dp_advance_along(e, line, dt);
    e->node_u = u1; /* without the rounding of the slope */
    return status;
}

void dp_outputs(dp_engine *e, double u, double *y) {
    const dp_line line = {{u, 0.0, 0.0, 0.0}, e->t};
    dp_engine now;
    double s[DP_NS + 1];
    if (!e->modes_ready) dp_find_modes(e, &line);
    now = *e;
    if (DP_SURFACES_USE_FORCE) dp_after_jump(&now, &line, now.s);
    memcpy(s, now.s, sizeof s);
    if (now.hold >= 0) dp_shares(&now, &line, 0.0, now.z, s);
    dp_output(now.z, now.t, u, now.p, s, y);
}
