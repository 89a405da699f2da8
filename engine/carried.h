/* Derivatives of the motion by several unknowns that go along with it: what they need to know of it. See carried.c.
 * Included behind a generated law that has slopes (DP_CARRIES), before engine.c; carried.c comes behind that. */
#ifndef DASHPOT_CARRIED_H
#define DASHPOT_CARRIED_H

#include "engine.h"

typedef struct {
    dp_engine engine;             /* first, so that its address is that of the whole */
    int blocks;                   /* unknowns go side by side, DP_LANES of them in a block */
    double (*dz)[DP_NZ][DP_LANES]; /* derivatives of the state */
    double (*shift)[DP_LANES];    /* how much later the event of this instant comes; 0 once the motion has flown on */
    const int (*which)[DP_LANES]; /* place of each unknown among what pushes: parameters, nothing, force */
    double stage[6][DP_NZ];       /* the stages of the latest step that was tried, where it began and how long it was */
    double stage_tau, stage_h;
    double before[DP_NZ];         /* right-hand side before the event */
    int held;                     /* whether the motion was held before it */
    int stops;                    /* whether it has v = 0 there */
    double (*shown)[DP_LANES];    /* derivatives of the latest output */
    const double (*sensed)[DP_LANES]; /* how much of an unknown is in what was measured, in each block at the start ... */
    double dt;                    /* ... and in the block behind it by how much that grows in a second */
    double (*last)[DP_NZ][DP_LANES]; /* dz at the sample before, where sides are asked for; else null */
    void *y;                      /* (rows, n) derivatives of the response, each unknown's in its row */
    const int *row;
    int single;                   /* whether y and along are in single precision */
    void *along;                /* (n, DP_NZ, count) those of the state at each sample, which then begin anew ... */
    const double (*anew)[DP_NZ][DP_LANES]; /* ... as these; or null */
    long count, n;
} dp_carried;

#define DP_CARRIED(e) ((dp_carried *)(e))

/* Compiled for wide registers too, where the loader can choose: the same bits, for no product is fused with a sum. */
#if defined(__GNUC__) && !defined(__clang__) && defined(__x86_64__) && defined(__GLIBC__)
#define DP_WIDE __attribute__((target_clones("avx2", "default")))
#else
#define DP_WIDE
#endif

struct dp_line;
DP_WIDE DP_APART void dp_carry_flow(const dp_engine *e, const struct dp_line *l, double tau, double h,
                                    const double *k1);
static void dp_carry_before(const dp_engine *e, const struct dp_line *l, double tau, int stops);
static void dp_carry_crossing(const dp_engine *e, const struct dp_line *l, double tau, int surface);
static void dp_carry_breaking(const dp_engine *e, const struct dp_line *l, double tau);
static void dp_carry_after(const dp_engine *e, const struct dp_line *l, double tau);

/* A run without derivatives has no block of unknowns, and is that of an engine without them, to the bit. */
#define DP_WITH(e, done) (DP_CARRIED(e)->blocks ? (void)(done) : (void)0)
#define DP_STAGE(e, i, z) memcpy(DP_CARRIED(e)->stage[i], z, sizeof DP_CARRIED(e)->stage[i])
#define DP_STAGES(e, tau, h) DP_CARRIED(e)->stage_tau = tau, DP_CARRIED(e)->stage_h = h
#define DP_FLOWN(e, l, tau, h, k1) DP_WITH(e, dp_carry_flow(e, l, tau, h, k1))
#define DP_CROSSING(e, l, tau, surface) DP_WITH(e, dp_carry_crossing(e, l, tau, surface))
#define DP_BREAKING(e, l, tau) DP_WITH(e, dp_carry_breaking(e, l, tau))
#define DP_BEFORE(e, l, tau) DP_WITH(e, dp_carry_before(e, l, tau, 0))
#define DP_AFTER(e, l, tau) DP_WITH(e, dp_carry_after(e, l, tau))
#define DP_SHOWN(e, given, u, shown, i) DP_WITH(e, dp_carry_shown(e, given, u, shown, i))
#define DP_CORRECTING(e, gain, u, i) DP_WITH(e, dp_carry_correction(e, gain, u, i))
#define DP_BESIDE(e, last, given, u, shown, out) DP_WITH(e, dp_carry_beside(e, last, given, u, shown, out))
#define DP_ON(e) DP_WITH(e, dp_carry_on(e))

#endif
