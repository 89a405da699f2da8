/* Runs the engine over a whole recording: the core that fits and simulates. Included behind engine.c. */

#ifdef _WIN32
#define DP_EXPORT __declspec(dllexport)
#else
#define DP_EXPORT __attribute__((visibility("default")))
#endif

/* More events a sample than this, all through a recording, are chatter and no motion of a machine: a fit that tries such
 * values is told so at once instead of waiting for it. */
#define DP_CHATTER 4

/* n samples dt apart; the force is a cubic in each of `fine` equal parts of a sample interval (force: 4 coefficients a
 * part, (n - 1) * fine parts, or null for a free motion). Writes the response y (n) and, where not null, the states
 * z (n * DP_NZ, sample by sample). Returns the number of samples written; fewer than n: it failed there. */
DP_EXPORT long dp_record(const double *p, const double *z0, double t0, const double *force, long n, int fine, double dt,
                         double max_step, double *y, double *z) {
    static const double none[4] = {0.0, 0.0, 0.0, 0.0};
    dp_engine e;
    double out[DP_NY], u = force ? force[0] : 0.0;
    const double step = dt / fine;
    const double *piece = force ? force : none;
    long i;
    int j;
    dp_start(&e, p, z0, t0, max_step);
    for (i = 0; i < n; ++i) {
        for (j = 0; i > 0 && j < fine; ++j, piece += force ? 4 : 0) {
            if (dp_advance_along(&e, piece, step) != DP_OK || e.events > DP_CHATTER * (i + 500)) return i;
            u = e.node_u;
        }
        dp_outputs(&e, u, out);
        y[i] = out[0];
        if (z) memcpy(z + i * DP_NZ, e.z, sizeof e.z);
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
