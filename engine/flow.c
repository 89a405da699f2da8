/* The flow of one oscillator between events: the force within a step, the right-hand side also while the motion is
 * held, and one step of Dormand and Prince (1980). Included behind the generated law. */
#include <math.h>
#include <string.h>

#include "engine.h"

typedef struct dp_line {
    double c[4]; /* force within the step: c0 + c1 tau + c2 tau^2 + c3 tau^3 */
    double t0;   /* time at tau = 0 */
} dp_line;

static double dp_force(const dp_line *l, double tau) {
    return l->c[0] + tau * (l->c[1] + tau * (l->c[2] + tau * l->c[3]));
}

static double dp_force_rate(const dp_line *l, double tau) {
    return l->c[1] + tau * (2.0 * l->c[2] + tau * 3.0 * l->c[3]);
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

/* The coefficients of Dormand and Prince (1980), order five: row i makes stage i + 1 of the rates before it, the last row
 * the state at the end; dp_node says where in the step a stage lies. */
static const double dp_node[6] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0};
static const double dp_weight[6][6] = {
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
};

/* One Dormand-Prince step of length h from z (right-hand side k1) to out. Nearly all time goes here, so that the law is
 * put in place where nothing can hold the motion. */
DP_INLINE void dp_pair(const dp_engine *e, const dp_line *l, double tau, double h, const double *z, const double *k1,
                       double *out, int held) {
    double k[6][DP_NZ], y[DP_NZ];
    int i, j, n;
    memcpy(k[0], k1, sizeof k[0]);
    DP_UNROLL
    for (i = 0; i < 6; ++i) {
        DP_UNROLL
        for (n = 0; n < DP_NZ; ++n) {
            double sum = 0.0;
            DP_UNROLL
            for (j = 0; j < i; ++j) sum += dp_weight[i][j] * k[j][n];
            y[n] = z[n] + h * sum + h * dp_weight[i][i] * k[i][n]; /* the latest rate last: all else is ready before it */
        }
        if (i == 5) break;
        DP_STAGE(e, i + 1, y);
        if (held)
            dp_field_at(e, l, tau + dp_node[i + 1] * h, y, k[i + 1]);
        else
            dp_field_here(y, l->t0 + (tau + dp_node[i + 1] * h), dp_force(l, tau + dp_node[i + 1] * h), e->p, e->s,
                          k[i + 1]);
    }
    DP_STAGES(e, tau, h);
    memcpy(out, y, sizeof y);
}

/* The same while nothing holds the motion, then right-hand side, surfaces and their rates there. */
DP_APART void dp_flow_free(const dp_engine *e, const dp_line *l, double tau, double h, const double *z,
                           const double *k1, double *out, double *f, double *g, double *gd) {
    dp_pair(e, l, tau, h, z, k1, out, 0);
    tau += h;
    dp_surface_here(out, l->t0 + tau, dp_force(l, tau), dp_force_rate(l, tau), e->p, e->s, f, g, gd);
}

static void dp_step(const dp_engine *e, const dp_line *l, double tau, double h, const double *z, const double *k1,
                    double *out) {
    dp_pair(e, l, tau, h, z, k1, out, 1);
}

static void dp_flow(const dp_engine *e, const dp_line *l, double tau, double h, const double *z, const double *k1,
                    double *out, double *f, double *g, double *gd) {
    if (e->hold < 0) {
        dp_flow_free(e, l, tau, h, z, k1, out, f, g, gd);
    } else {
        dp_step(e, l, tau, h, z, k1, out);
        dp_surfaces_at(e, l, tau + h, out, f, g, gd);
    }
}
