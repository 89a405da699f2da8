/* Derivatives of the motion by several unknowns that go along with it: what they need to know of it. See carried.c.
 * Included by engine.h where the generated law has slopes (DP_CARRIES). */
#ifndef DASHPOT_CARRIED_H
#define DASHPOT_CARRIED_H

typedef struct dp_carried {
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
    const double (*sensed)[DP_LANES]; /* whether an unknown is in what was measured */
    const double *profile;        /* (n) ... and how much of it at each sample; null: all */
    double *y;                    /* (count, n) derivatives of the response */
    long count, n;
} dp_carried;

#define DP_STAGE(e, i, z) memcpy((e)->carried->stage[i], z, sizeof (e)->carried->stage[i])
#define DP_STAGES(e, tau, h) (e)->carried->stage_tau = tau, (e)->carried->stage_h = h
#define DP_FLOWN(e, l, tau, h, k1) dp_carry_flow(e, l, tau, h, k1)
#define DP_CROSSING(e, l, tau, surface) dp_carry_crossing(e, l, tau, surface)
#define DP_BREAKING(e, l, tau) dp_carry_breaking(e, l, tau)
#define DP_BEFORE(e, l, tau) dp_carry_before(e, l, tau, 0)
#define DP_AFTER(e, l, tau) dp_carry_after(e, l, tau)
#define DP_SHOWN(e, given, u, shown, i) dp_carry_shown(e, given, u, shown, i)
#define DP_CORRECTING(e, gain, u, i) dp_carry_correction(e, gain, u, i)

#endif
