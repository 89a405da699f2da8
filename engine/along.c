/* One law along a prescribed motion: its inner states integrated by Heun's method at the given points. Included behind
 * the generated functions dp_rates and dp_value, with the sizes DP_INNER and DP_VALUES. */
#include <string.h>

#ifdef _WIN32
#define DP_EXPORT __declspec(dllexport)
#else
#define DP_EXPORT __attribute__((visibility("default")))
#endif

static void dp_call(int (*function)(const double **, double **, int *, double *, int), const double *z,
                    const double *motion, const double *p, double *out) {
    const double *arg[3];
    double *res[1];
    arg[0] = z, arg[1] = motion, arg[2] = p;
    res[0] = out;
    function(arg, res, 0, 0, 0);
}

/* n points dt apart; motion: displacement, velocity, time and force at each (n * 4), straight lines between them; z0:
 * inner states at the first one; parts: steps from point to point; out: the law's values at each (n * DP_VALUES). */
DP_EXPORT void dp_along(const double *p, const double *z0, long n, double dt, int parts, const double *motion,
                        double *out) {
    double z[DP_INNER + 1], first[DP_INNER + 1], second[DP_INNER + 1], trial[DP_INNER + 1], here[4], there[4];
    const double h = dt / parts;
    long i;
    int k, part;
    memcpy(z, z0, DP_INNER * sizeof *z);
    for (i = 0; i < n; ++i, motion += 4, out += DP_VALUES) {
        dp_call(dp_value, z, motion, p, out);
        if (DP_INNER == 0 || i + 1 == n) continue;
        for (part = 0; part < parts; ++part) {
            for (k = 0; k < 4; ++k) {
                const double slope = (motion[4 + k] - motion[k]) / parts;
                here[k] = motion[k] + part * slope;
                there[k] = here[k] + slope;
            }
            dp_call(dp_rates, z, here, p, first);
            for (k = 0; k < DP_INNER; ++k) trial[k] = z[k] + h * first[k];
            dp_call(dp_rates, trial, there, p, second);
            for (k = 0; k < DP_INNER; ++k) z[k] += 0.5 * h * (first[k] + second[k]);
        }
    }
}
