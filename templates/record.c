/* Runs the engine over a whole recording: the core that fits and simulates. Included behind engine.c. */

#ifdef _WIN32
#define DP_EXPORT __declspec(dllexport)
#else
#define DP_EXPORT __attribute__((visibility("default")))
#endif

/* n samples dt apart; the force runs in straight lines between `fine` points per sample interval
 * (u: (n - 1) * fine + 1 values, or null for a free motion). Writes the response y (n) and, where not null, the
 * states z (n * DP_NZ, sample by sample). Returns the number of samples written; fewer than n: it failed there. */
DP_EXPORT long dp_record(const double *p, const double *z0, double t0, const double *u, long n, int fine, double dt,
                         double max_step, double *y, double *z) {
    dp_engine e;
    double out[DP_NY];
    const double step = dt / fine;
    long i, k = 0;
    int j;
    dp_start(&e, p, z0, t0, max_step);
    for (i = 0; i < n; ++i) {
        if (i > 0)
            for (j = 0; j < fine; ++j, ++k)
                if (dp_advance(&e, u ? u[k] : 0.0, u ? u[k + 1] : 0.0, step) != DP_OK) return i;
        dp_outputs(&e, u ? u[k] : 0.0, out);
        y[i] = out[0];
        if (z) memcpy(z + i * DP_NZ, e.z, sizeof e.z);
    }
    return n;
}

/* The right-hand side at the present signs, for tests that hold the renderings against one another. */
DP_EXPORT void dp_rates(const double *p, const double *z, double t, double u, double *f) {
    dp_engine e;
    const dp_line line = {u, 0.0, t};
    dp_start(&e, p, z, t, 1.0);
    dp_find_modes(&e, &line);
    dp_field_at(&e, &line, 0.0, z, f);
}
