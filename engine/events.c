/* Where the motion meets the switching surfaces, and what it does there: crossing, sticking, breaking away (Filippov
 * 1988). Included behind flow.c. */

#define DP_REST 0.01 /* a flight shorter than this part of an internal step ends at rest on its surface */

/* The motion has come to a turning point, or to rest. */
static void dp_turn(dp_engine *e) {
    if (e->z[0] == e->turn) return;
    if (isfinite(e->turn)) e->swing = 0.5 * fabs(e->z[0] - e->turn);
    e->widest = fmax(e->widest, e->swing);
    e->turn = e->z[0];
}

/* The motion has v = 0 on the velocity surface i: it sticks, or it goes where the forces push it. */
static void dp_stick_or_go(dp_engine *e, const dp_line *l, double tau, int i, double came_from) {
    double f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1], rest, capacity;
    int j;
    e->z[1] = 0.0;
    dp_turn(e);
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

/* The signs as they stand, those on which the motion rests with what they carry. */
static void dp_signs(const dp_engine *e, const dp_line *l, double *s) {
    if (e->hold >= 0)
        dp_shares(e, l, 0.0, e->z, s);
    else
        memcpy(s, e->s, sizeof e->s);
}

/* Takes signs that were kept. */
static void dp_take_signs(dp_engine *e, const signed char *kept) {
    int i;
    for (i = 0; i < DP_NS; ++i) e->s[i] = kept[i];
    e->hold = kept[DP_NS];
    e->modes_ready = 1;
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

/* Its slope. */
static double dp_hermite_slope(double g0, double d0, double g1, double d1, double x) {
    const double y = 1.0 - x;
    return 6.0 * (g1 - g0) * x * y + d0 * y * (1.0 - 3.0 * x) + d1 * x * (3.0 * x - 2.0);
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
    x = 0.5 * top;
    for (n = 0; n < 60 && top - lo > 1e-9; ++n) { /* Newton, inside a bracket that moves */
        const double value = dp_hermite(g0, d0, g1, d1, x), slope = dp_hermite_slope(g0, d0, g1, d1, x), last = x;
        if (value < 0.0)
            top = x;
        else
            lo = x;
        x = slope != 0.0 ? x - value / slope : 2.0;
        if (!(x > lo && x < top)) x = 0.5 * (lo + top);
        if (fabs(x - last) < 1e-9) break;
    }
    return x;
}

/* Whether any surface may be crossed within a step, by values and rates at its two ends: where not, the cubic through
 * them crosses none. */
DP_INLINE int dp_may_cross(const dp_engine *e, const double *gd, const double *g1, const double *gd1) {
    int i;
    for (i = 0; i < DP_NS; ++i) {
        const double m = e->s[i];
        if (m * g1[i] < 0.0 || (m * gd[i] < 0.0 && m * gd1[i] > 0.0)) return 1;
    }
    return 0;
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
            dp_flow(e, l, tau, x * h, e->z, e->f, trial, f, g, gd);
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

/* Whether the motion, just across a position surface under the right-hand side f, would be back at once: infinitely many
 * such flights would follow in finite time (Zeno). h: an internal step. */
static int dp_short_flight(const dp_engine *e, const double *f, double h) {
    return f[1] * e->z[1] < 0.0 && 2.0 * fabs(e->z[1]) <= DP_REST * h * fabs(f[1]);
}

/* Puts the state on a position surface of value g and rate gd. */
static void dp_project(dp_engine *e, double g, double gd) {
    if (gd != 0.0) e->z[0] -= g * e->z[1] / gd;
}

/* Brings a motion on a position surface to rest where the forces let it stay there. */
static void dp_rest(dp_engine *e, const dp_line *l, double tau) {
    const double v = e->z[1];
    double rest;
    int j;
    for (j = 0; j < DP_NS; ++j) {
        if (dp_kind[j] != DP_VELOCITY) continue;
        e->z[1] = 0.0;
        if (dp_capacity(e, l, tau, e->z, j, &rest) >= fabs(rest)) {
            dp_stick_or_go(e, l, tau, j, 0.0);
            return;
        }
        e->z[1] = v;
    }
}

/* Puts the state on surface i and lets it cross, stick, or come to rest. */
static void dp_cross(dp_engine *e, const dp_line *l, double tau, int i, double h) {
    double f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1];
    const double m = e->s[i];
    ++e->events;
    if (dp_kind[i] == DP_VELOCITY) {
        dp_stick_or_go(e, l, tau, i, m);
        return;
    }
    e->s[i] = -m;
    if (dp_kind[i] != DP_POSITION) return;
    dp_surfaces_at(e, l, tau, e->z, f, g, gd);
    dp_project(e, g[i], gd[i]);
    if (dp_short_flight(e, f, h)) dp_rest(e, l, tau);
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
