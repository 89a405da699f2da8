/* Runs the engine over a whole recording: the core that fits and simulates. Included behind engine.c. */

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
    int i;
    for (i = 0; i < DP_NS; ++i) now.s[i] = kept[i];
    now.hold = kept[DP_NS];
    now.modes_ready = 1;
    dp_outputs(&now, u, out);
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

/* One cubic in place of `joined` pieces, each `step` long: with the value and the slope that they have at both ends. */
static void dp_joined(const double *piece, int joined, double step, double *one) {
    const double *last = piece + 4 * (joined - 1);
    const double whole = joined * step;
    const double rise = last[0] + step * (last[1] + step * (last[2] + step * last[3])) - piece[0];
    const double slope = last[1] + step * (2.0 * last[2] + 3.0 * step * last[3]);
    one[0] = piece[0];
    one[1] = piece[1];
    one[2] = (3.0 * rise / whole - 2.0 * piece[1] - slope) / whole;
    one[3] = (piece[1] + slope - 2.0 * rise / whole) / (whole * whole);
}

/* n samples dt apart; the force is a cubic in each of `fine` equal parts of a sample interval (force: 4 coefficients a
 * part, `parts` of them, at least (n - 1) * fine, or null for a free motion), `joined` of which are taken as one. A force that jumps at a sample has its new
 * value there. Writes the response y (n) and, where not null, the states z (n * DP_NZ, sample by sample) and the signs at
 * each sample, kept (n * (DP_NS + 1)). With signs given (the same shape) the response is what the states give under
 * these. Of the outputs it is the one at index `shown`. With measured (n) and gain (DP_NZ) the state is corrected after
 * each sample: y is then the prediction from one sample to the next. To the force is added, all along, `load` and, where
 * not null, the samples added (n): held from each to the next, or in straight lines (`lines`, one part an interval).
 * Returns the number of samples written; fewer than n: it failed there. */
DP_EXPORT long dp_record(const double *p, const double *z0, double t0, const double *force, long parts, long n, int fine,
                         double dt, double max_step, double *y, double *z, const double *measured, const double *gain,
                         const signed char *given, signed char *kept, int shown, const double *added, int lines,
                         double load, int joined) {
    static const double none[4] = {0.0, 0.0, 0.0, 0.0};
    dp_engine e;
    double out[DP_NY], now[4], u = 0.0;
    const double piece_step = dt / fine, step = joined * piece_step;
    const double most = DP_MORE + n * fmin(DP_CHATTER, fine / joined * ceil(step / max_step));
    const double *piece = force ? force : none, *end = force ? force + 4 * parts : none;
    long i;
    int j;
    dp_start(&e, p, z0, t0, max_step);
    for (i = 0; i < n; ++i) {
        for (j = 0; i > 0 && j < fine; j += joined, piece += force ? 4 * joined : 0) {
            if (joined > 1)
                dp_joined(piece, joined, piece_step, now);
            else
                memcpy(now, piece, sizeof now);
            if (added) {
                now[0] += added[i - 1];
                if (lines) now[1] += (added[i] - added[i - 1]) / step;
            }
            now[0] += load;
            if (dp_advance_along(&e, now, step) != DP_OK || e.events > most) return i;
            u = e.node_u;
        }
        if (piece < end) u = (added ? *piece + added[i] : *piece) + load;
        if (given)
            dp_outputs_under(&e, given + i * (DP_NS + 1), u, out);
        else
            dp_outputs(&e, u, out);
        y[i] = out[shown];
        if (z) memcpy(z + i * DP_NZ, e.z, sizeof e.z);
        if (kept) dp_keep_signs(&e, kept + i * (DP_NS + 1));
        if (measured) dp_correct(&e, gain, measured[i] - y[i], u);
    }
    return n;
}

/* The right-hand side at the present signs, for tests that hold the renderings against one another. */
DP_EXPORT void dp_rates(const double *p, const double *z, double t, double u, double *f) {
    dp_engine e;
    const dp_line line = {{u, 0.0, 0.0, 0.0}, t};
    dp_start(&e, p, z, t, 1.0);
    dp_find_modes(&e, &line);
    dp_field_at(&e, &line, 0.0, z, f);
}
