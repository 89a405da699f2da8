/* Event-exact integration of one oscillator. No dependency but <math.h>.
 *
 * The model is zdot = f(z, t, u, p, s) with one sign s per switching surface g(z, t, u, p) = 0. Between events the
 * signs are constant and f is smooth: Dormand and Prince's fifth-order pair (1980) integrates. A sign change is located
 * on the flow itself, the state is put on the surface, and integration goes on from there. On the surface v = 0
 * the motion sticks while the other forces stay within the friction (Filippov 1988); it breaks away in closed form.
 * Position surfaces that meet a motion at rest (a preloaded spring at its seat) add their step to what holds it.
 *
 * The law itself (law.c) is generated: DP_NZ states, DP_NP parameters, DP_NS surfaces, DP_NY outputs. */
#ifndef DASHPOT_ENGINE_H
#define DASHPOT_ENGINE_H

enum { DP_OK = 0, DP_TOO_MANY_EVENTS = 1, DP_NOT_FINITE = 2 };
enum { DP_OTHER = 0, DP_POSITION = 1, DP_VELOCITY = 2 };

typedef struct {
    double z[DP_NZ];      /* state: displacement, velocity, inner states */
    double s[DP_NS + 1];  /* sign of each surface: -1 or 1, 0 while the motion rests on it */
    double p[DP_NP];      /* parameters */
    double t;             /* time at which the next step starts */
    double max_step;      /* longest internal step */
    double f[DP_NZ];      /* right-hand side, surfaces and their rates at the present state, where node_ready */
    double g[DP_NS + 1];
    double gd[DP_NS + 1];
    double node_u;        /* the force and its rate they were taken at */
    double node_rate;
    int node_ready;
    int hold;             /* the velocity surface that holds the motion, or -1 */
    double turn;          /* displacement at the latest turning point */
    double swing;         /* half the way between the latest two: the amplitude */
    double widest;        /* largest of them since somebody looked and set it to zero */
    int modes_ready;      /* 0 after a state or parameter was set: signs are found again at the next step */
    long events;          /* events located so far */
} dp_engine;

/* What the engine tells whoever follows the motion (carried.h: derivatives that go along); nothing where nobody does.
 * DP_STAGE: the state at a stage of a step that is tried; DP_STAGES: where that step began, and its length. DP_FLOWN: the
 * motion has flown from e->z, where its right-hand side was k1. DP_CROSSING, DP_BREAKING, DP_BEFORE: it is about to cross
 * a surface, to break away because the forces have grown, or to change at an instant that is given; DP_AFTER: it has.
 * DP_SHOWN: the output at sample i was taken, under the signs given or, where null, its own; DP_CORRECTING: the state is
 * about to be moved by what was measured there. */
#ifndef DP_CARRIES
#define DP_STAGE(e, stage, z)
#define DP_STAGES(e, tau, h)
#define DP_FLOWN(e, l, tau, h, k1)
#define DP_CROSSING(e, l, tau, surface)
#define DP_BREAKING(e, l, tau)
#define DP_BEFORE(e, l, tau)
#define DP_AFTER(e, l, tau)
#define DP_SHOWN(e, given, u, shown, i)
#define DP_CORRECTING(e, gain, u, i)
#endif

/* Puts the engine at time t in state z. */
void dp_start(dp_engine *e, const double *p, const double *z, double t, double max_step);
/* Integrates over dt while the force runs in a straight line from u0 to u1. Returns DP_OK or what went wrong. */
int dp_advance(dp_engine *e, double u0, double u1, double dt);
/* The same with the force as a cubic of the time since the step's start, force[0] + force[1] tau + ... (4 values). */
int dp_advance_along(dp_engine *e, const double *force, double dt);
/* Outputs at the present state under force u: response as recorded, displacement, velocity, acceleration. */
void dp_outputs(dp_engine *e, double u, double *y);

#endif
