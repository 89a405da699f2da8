/* Runs the engine over a whole recording: the core that fits and simulates. Included behind engine.c. */

#include <stdlib.h>

#ifdef _WIN32
#define DP_EXPORT __declspec(dllexport)
#else
#define DP_EXPORT __attribute__((visibility("default")))
#endif

/* More events than internal steps, of which a period of the fastest motion takes twenty or more, or than four a sample,
 * all through a recording are chatter and no motion of a machine: a fit that tries such values waits for no more of them.
 * A part of it may chatter: a mass that waits for its blow between the seats of a preloaded spring, the noise of the
 * load cell on it. A short recording may have so many more. */
#define DP_CHATTER 4
#define DP_MORE 2000

/* What one surface carries at a sample, as it is kept: its sign, or 0 while the motion rests on it; last what holds it. */
static void dp_keep_signs(const dp_engine *e, signed char *kept) {
    int i;
    for (i = 0; i < DP_NS; ++i) kept[i] = (signed char)e->s[i];
    kept[DP_NS] = (signed char)e->hold;
}

/* Outputs at the present state under signs that were kept: what a neighbouring motion gives as if its events came at the
 * same samples, so that a difference of the two is a derivative also where the acceleration jumps. */
static void dp_outputs_under(const dp_engine *e, const signed char *kept, double u, double *out) {
    dp_engine now = *e;
    dp_take_signs(&now, kept);
    dp_outputs(&now, u, out);
}

#ifndef DP_CARRIES /* else: derivatives of the motion `last` under signs given; the motion goes on to the next sample */
#define DP_BESIDE(e, last, given, u, shown, out)
#define DP_ON(e)
typedef dp_engine dp_whole;
#else
typedef dp_carried dp_whole; /* an engine stands first in it */
#endif

/* What samples beside a jump are on its other side, one after another: which sample, its output there, and behind that
 * the derivatives of it, `width` numbers in all. `room` of them fit; -1 where there was no memory for more. */
typedef struct {
    long count, room, width;
    long *at;
    double *shown;
} dp_sides_shown;

/* The motion as it was at a sample, and the signs at it and at the one before. */
typedef struct {
    dp_engine engine;
    double u;
    signed char before[DP_NS + 1], here[DP_NS + 1];
} dp_last;

static void dp_side(const dp_engine *e, dp_sides_shown *sides, const dp_last *last, const signed char *given, long i,
                    int shown) {
    double out[DP_NY], *to;
    if (sides->room < 0) return;
    if (sides->count == sides->room) {
        const long room = 2 * sides->room + 64;
        long *at = realloc(sides->at, room * sizeof *at);
        double *grown = at ? realloc(sides->shown, room * sides->width * sizeof *grown) : 0;
        if (at) sides->at = at;
        if (grown) sides->shown = grown;
        sides->room = grown ? room : -1;
        if (!grown) return;
    }
    to = sides->shown + sides->width * sides->count;
    dp_outputs_under(&last->engine, given, last->u, out);
    sides->at[sides->count++] = i;
    *to = out[shown];
    DP_BESIDE(e, &last->engine, given, last->u, shown, to + 1);
    (void)e;
}

/* What the sample i before the present one, after which the signs are `next` (null: the record ends), is on the other
 * side of the jumps beside it: of all that jump there, or of one of them. */
static void dp_beside(const dp_engine *e, dp_sides_shown *sides, const dp_last *last, const signed char *next, long i,
                      int shown) {
    const signed char *way[2];
    signed char given[DP_NS + 1];
    int w, j;
    way[0] = i > 0 ? last->before : last->here, way[1] = next ? next : last->here;
    for (w = 0; w < 2; ++w) {
        if (!memcmp(way[w], last->here, sizeof given)) continue;
        dp_side(e, sides, last, way[w], i, shown);
        for (j = 0; j <= DP_NS; ++j) {
            memcpy(given, last->here, sizeof given);
            given[j] = way[w][j];
            if (memcmp(given, way[w], sizeof given) && memcmp(given, last->here, sizeof given))
                dp_side(e, sides, last, given, i, shown);
        }
    }
}

/* The same of the first sample, before which nothing was recorded: the surfaces that the motion has crossed, as it moves,
 * within an interval before it. */
static void dp_beside_first(const dp_engine *e, dp_sides_shown *sides, const dp_last *last, double dt, int shown) {
    const dp_line line = {{last->u, 0.0, 0.0, 0.0}, e->t};
    double f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1];
    signed char given[DP_NS + 1];
    int j;
    if (e->hold >= 0) return;
    dp_surfaces_at(e, &line, 0.0, e->z, f, g, gd);
    for (j = 0; j < DP_NS; ++j) {
        if (last->here[j] * gd[j] <= 0.0 || fabs(g[j]) > fabs(gd[j]) * dt) continue;
        memcpy(given, last->here, sizeof given);
        given[j] = -given[j];
        dp_side(e, sides, last, given, 0, shown);
    }
}

/* Moves the state by the gain times what was measured beyond what the model predicted; a motion that is held moves as a
 * whole, its velocity stays zero. */
static void dp_correct(dp_engine *e, const double *gain, double innovation, double u) {
    const dp_line line = {{u, 0.0, 0.0, 0.0}, e->t};
    int i, same = e->hold < 0 && e->modes_ready && !DP_SURFACES_USE_FORCE;
    if (innovation == 0.0) return;
    if (e->hold >= 0) {
        e->z[0] += gain[0] * innovation;
    } else {
        for (i = 0; i < DP_NZ; ++i) e->z[i] += gain[i] * innovation;
    }
    e->node_ready = 0;
    if (same) {
        dp_surfaces_at(e, &line, 0.0, e->z, e->f, e->g, e->gd);
        for (i = 0; i < DP_NS; ++i) same &= e->g[i] * e->s[i] > 0.0;
        e->node_ready = same;
        e->node_u = u;
    }
    e->modes_ready = same;
}

/* One cubic in place of `joined` pieces, each `step` long, the first and the last of which are given: with the value and
 * the slope that they have at both ends; in the place of the first. */
static void dp_joined(double *one, const double *last, int joined, double step) {
    const double whole = joined * step;
    const double rise = last[0] + step * (last[1] + step * (last[2] + step * last[3])) - one[0];
    const double slope = last[1] + step * (2.0 * last[2] + 3.0 * step * last[3]);
    one[2] = (3.0 * rise / whole - 2.0 * one[1] - slope) / whole;
    one[3] = (one[1] + slope - 2.0 * rise / whole) / (whole * whole);
}

/* A recording to be made: n samples dt apart, the first at t0, from z0 with the parameters p. The force is a cubic in each
 * of `fine` equal parts of a sample interval (force: 4 coefficients a part, `parts` of them, at least (n - 1) * fine, or
 * null for a free motion; `single`: in single precision), `joined` of which are taken as one. A force that jumps at a sample has its new value there. To
 * it is added, all along, `load` and, where not null, the samples added (n): held from each to the next, or in straight
 * lines (`lines`, one part an interval). With measured (n) and gain (DP_NZ) the state is corrected after each sample: the
 * response is then the prediction from one sample to the next. */
typedef struct {
    const double *p, *z0;
    const void *force;
    const double *added, *measured, *gain;
    const signed char *given; /* signs (n * (DP_NS + 1)) under which the states give the response; null: their own */
    double *y;                /* the response (n): of the outputs the one at index `shown` */
    double *z;                /* the states (n * DP_NZ), sample by sample, or null */
    signed char *kept;        /* the signs at each sample, as `given`, or null */
    dp_sides_shown *sides;    /* filled with what samples beside a jump are on its other side, or null */
    long parts, n;
    double t0, dt, max_step, load;
    int fine, joined, lines, shown, single;
} dp_recording;

/* The coefficients of the force's part k; none of a free motion. */
static void dp_piece(const dp_recording *r, long k, double *piece) {
    int j;
    for (j = 0; j < 4; ++j)
        piece[j] = !r->force     ? 0.0
                   : r->single ? ((const float *)r->force)[4 * k + j]
                               : ((const double *)r->force)[4 * k + j];
}

/* Returns the number of samples written; fewer than n: it failed there. */
static long dp_record_by(dp_engine *e, const dp_recording *r) {
    double out[DP_NY], now[4], ending[4], u = r->force ? 0.0 : r->load;
    const double piece_step = r->dt / r->fine, step = r->joined * piece_step;
    const double most = DP_MORE + r->n * fmin(DP_CHATTER, r->fine / r->joined * ceil(step / r->max_step));
    dp_last last;
    long i, part = 0;
    int j;
    for (i = 0; i < r->n; ++i) {
        const signed char *given = r->given ? r->given + i * (DP_NS + 1) : 0;
        for (j = 0; i > 0 && j < r->fine; j += r->joined, part += r->joined) {
            dp_piece(r, part, now);
            if (r->joined > 1) {
                dp_piece(r, part + r->joined - 1, ending);
                dp_joined(now, ending, r->joined, piece_step);
            }
            if (r->added) {
                now[0] += r->added[i - 1];
                if (r->lines) now[1] += (r->added[i] - r->added[i - 1]) / step;
            }
            now[0] += r->load;
            if (dp_advance_along(e, now, step) != DP_OK || e->events > most) return i;
            u = e->node_u;
        }
        if (r->force && part < r->parts) {
            dp_piece(r, part, ending);
            u = (r->added ? ending[0] + r->added[i] : ending[0]) + r->load;
        }
        if (given)
            dp_outputs_under(e, given, u, out);
        else
            dp_outputs(e, u, out);
        r->y[i] = out[r->shown];
        DP_SHOWN(e, given, u, r->shown, i);
        if (r->z) memcpy(r->z + i * DP_NZ, e->z, sizeof e->z);
        if (r->kept) dp_keep_signs(e, r->kept + i * (DP_NS + 1));
        if (r->sides) {
            signed char now[DP_NS + 1];
            dp_keep_signs(e, now);
            if (i > 0) {
                dp_beside(e, r->sides, &last, now, i - 1, r->shown);
                memcpy(last.before, last.here, sizeof now);
            }
            memcpy(last.here, now, sizeof now);
            last.engine = *e, last.u = u;
            DP_ON(e);
            if (i == 0) dp_beside_first(e, r->sides, &last, r->dt, r->shown);
            if (i + 1 == r->n) dp_beside(e, r->sides, &last, 0, i, r->shown);
        }
        if (!r->measured) continue;
        DP_CORRECTING(e, r->gain, u, i);
        dp_correct(e, r->gain, r->measured[i] - r->y[i], u);
    }
    return r->n;
}

#ifdef DP_CARRIES
/* The same with `count` derivatives of the response, each in its `row` (n) of `derivatives`: of the state at the start in
 * `dz`, with as much room behind it, in blocks of DP_LANES by `which`, places among the parameters, nothing, and the force.
 * What was measured moves with an unknown by `sensed`, in each block at the start, then a second. `room`: twice DP_LANES for
 * each block. */
DP_EXPORT long dp_record_carried(const dp_recording *r, int blocks, long count, double *dz, const int *which,
                                 const double *sensed, double *room, void *derivatives, const int *row, int single,
                                 const double *anew, void *along) {
    dp_carried c;
    memset(&c, 0, sizeof c);
    c.blocks = blocks, c.count = count, c.n = r->n, c.y = derivatives, c.row = row, c.single = single, c.dt = r->dt;
    c.dz = (double(*)[DP_NZ][DP_LANES])dz;
    c.last = c.dz + blocks;
    c.which = (const int(*)[DP_LANES])which;
    c.sensed = (const double(*)[DP_LANES])sensed;
    c.shift = (double(*)[DP_LANES])room;
    c.shown = c.shift + blocks;
    c.anew = (const double(*)[DP_NZ][DP_LANES])anew;
    c.along = along;
    dp_start(&c.engine, r->p, r->z0, r->t0, r->max_step);
    return dp_record_by(&c.engine, r);
}
#endif

DP_EXPORT long dp_record(const dp_recording *r) {
    dp_whole whole;
    dp_engine *e = (dp_engine *)&whole;
    memset(&whole, 0, sizeof whole);
    dp_start(e, r->p, r->z0, r->t0, r->max_step);
    return dp_record_by(e, r);
}

DP_EXPORT void dp_sides_done(dp_sides_shown *sides) {
    free(sides->at);
    free(sides->shown);
}

/* The right-hand side at the present signs, for tests that hold the renderings against one another. */
DP_EXPORT void dp_rates(const double *p, const double *z, double t, double u, double *f) {
    dp_whole whole;
    dp_engine *e = (dp_engine *)&whole;
    const dp_line line = {{u, 0.0, 0.0, 0.0}, t};
    memset(&whole, 0, sizeof whole);
    dp_start(e, p, z, t, 1.0);
    dp_find_modes(e, &line);
    dp_field_at(e, &line, 0.0, z, f);
}
