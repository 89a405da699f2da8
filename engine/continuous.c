/* The oscillator for an importer's integrator (model exchange): rates, outputs, event indicators and what happens at an
 * event, by the same rules by which the engine steps; and directional derivatives. Included by instance.c.
 *
 * Between events every indicator is positive; one that falls to zero or below asks for the event. It exceeds the
 * surface's own value by a hair, so that a state which stands on the surface has not crossed it.
 *
 * With smoothing the signs are tanh of the surfaces over that part of their ranges and nothing sticks: for importers
 * that locate no events. The turning points are then still told, for the amplitude. */

#define DP_HAIR 1e-12 /* of a surface's range */

static double dp_smoothing(const dp_instance *m) {
    return m->exchange && DP_SMOOTHING_AT >= 0 ? m->value[DP_SMOOTHING_AT >= 0 ? DP_SMOOTHING_AT : 0] : 0.0;
}

static void dp_continuous_modes(dp_instance *m, const dp_line *line) {
    dp_engine *e = &m->engine;
    int j;
    if (e->modes_ready) return;
    dp_find_modes(e, line);
    if (e->hold < 0 || !(dp_smoothing(m) > 0.0)) return;
    e->hold = -1;
    for (j = 0; j < DP_NS; ++j)
        if (e->s[j] == 0.0) e->s[j] = 1.0;
}

static void dp_surface_values(const dp_instance *m, const dp_line *line, double *g) {
    double f[DP_NZ], gd[DP_NS + 1];
    dp_surface(m->engine.z, line->t0, line->c[0], line->c[1], m->engine.p, m->engine.s, f, g, gd);
}

/* The signs at the present state. */
static void dp_continuous_signs(const dp_instance *m, const dp_line *line, double *s) {
    const double smoothing = dp_smoothing(m);
    const dp_engine *e = &m->engine;
    int j;
    if (smoothing > 0.0) {
        double g[DP_NS + 1];
        dp_surface_values(m, line, g);
        for (j = 0; j < DP_NS; ++j) s[j] = tanh(g[j] / (smoothing * dp_range[j]));
    } else {
        dp_signs(e, line, s);
        if (!m->exchange && DP_SURFACES_USE_FORCE) dp_after_jump(e, line, s); /* there no event has told of it */
    }
}

static void dp_continuous_outputs(dp_instance *m) {
    const dp_line line = dp_instance_line(m);
    double s[DP_NS + 1];
    if (m->ready & DP_OUTPUTS_READY) return;
    dp_continuous_modes(m, &line);
    dp_continuous_signs(m, &line, s);
    dp_output(m->engine.z, line.t0, line.c[0], m->engine.p, s, m->y);
    m->ready |= DP_OUTPUTS_READY;
}

static void dp_continuous_power(dp_instance *m) {
    const dp_line line = dp_instance_line(m);
    double s[DP_NS + 1];
    if (m->ready & DP_POWER_READY) return;
    dp_continuous_modes(m, &line);
    dp_continuous_signs(m, &line, s);
    dp_power(m->engine.z, line.t0, line.c[0], m->engine.p, s, m->power);
    m->ready |= DP_POWER_READY;
}

static void dp_continuous_rates(dp_instance *m) {
    const dp_line line = dp_instance_line(m);
    double s[DP_NS + 1];
    if (m->ready & DP_RATES_READY) return;
    dp_continuous_modes(m, &line);
    dp_continuous_signs(m, &line, s);
    dp_field(m->engine.z, line.t0, line.c[0], m->engine.p, s, m->f);
    if (m->engine.hold >= 0 && !(dp_smoothing(m) > 0.0)) m->f[0] = m->f[1] = 0.0;
    m->ready |= DP_RATES_READY;
}

static void dp_continuous_indicators(dp_instance *m) {
    const dp_line line = dp_instance_line(m);
    const dp_engine *e = &m->engine;
    const int smooth = dp_smoothing(m) > 0.0;
    double g[DP_NS + 1];
    int j;
    if (m->ready & DP_INDICATORS_READY) return;
    dp_continuous_modes(m, &line);
    dp_surface_values(m, &line, g);
    for (j = 0; j < DP_NS; ++j) {
        const double s = e->s[j];
        if (s == 0.0 && j == e->hold && !smooth) {
            m->indicator[j] = DP_HAIR * dp_nominal[1] * dp_nominal[1] / dp_nominal[0] - dp_excess(e, &line, 0.0, e->z);
            if (DP_GIVEN > 0) m->indicator[j] = fmin(m->indicator[j], DP_HAIR * dp_range[j] - fabs(e->z[1]));
        } else if (s == 0.0 || (smooth && dp_kind[j] != DP_VELOCITY)) {
            m->indicator[j] = dp_range[j];
        } else {
            m->indicator[j] = s * g[j] + DP_HAIR * dp_range[j];
        }
    }
    m->ready |= DP_INDICATORS_READY;
}

/* The motion has crossed surface i. It stays where the importer located it but where it comes to rest. */
static void dp_continuous_cross(dp_engine *e, const dp_line *line, int i, int smooth) {
    double f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1];
    const double side = e->s[i], v = e->z[1];
    ++e->events;
    if (smooth || DP_GIVEN > 0) { /* a motion that is given goes on as it is given */
        dp_turn(e);
        e->s[i] = -side;
    } else if (dp_kind[i] == DP_VELOCITY) {
        dp_stick_or_go(e, line, 0.0, i, side);
        if (e->hold < 0 && e->s[i] != side) e->z[1] = v;
    } else {
        e->s[i] = -side;
        if (dp_kind[i] != DP_POSITION) return;
        dp_surfaces_at(e, line, 0.0, e->z, f, g, gd);
        if (!dp_short_flight(e, f, e->max_step)) return;
        dp_project(e, g[i], gd[i]);
        dp_rest(e, line, 0.0);
    }
}

/* What an event changes. Returns whether the states have changed with it. */
static int dp_continuous_event(dp_instance *m) {
    const dp_line line = dp_instance_line(m);
    dp_engine *e = &m->engine;
    const int smooth = dp_smoothing(m) > 0.0;
    double before[DP_NZ];
    int i, n, found = 1;
    memcpy(before, e->z, sizeof before);
    dp_continuous_modes(m, &line);
    for (n = 0; found && n <= 2 * DP_NS; ++n) { /* one event may bring the next at the same instant */
        m->ready = 0;
        dp_continuous_indicators(m);
        for (found = i = 0; i < DP_NS && !found; ++i) {
            if (m->indicator[i] > 0.0) continue;
            found = 1;
            if (i == e->hold && DP_GIVEN > 0 && e->z[1] != 0.0) /* it was moved away at a constant speed */
                dp_find_modes(e, &line);
            else if (i == e->hold)
                dp_release(e, &line, 0.0);
            else
                dp_continuous_cross(e, &line, i, smooth);
        }
    }
    m->ready = 0;
    return memcmp(before, e->z, sizeof before) != 0;
}

/* A direction in which what is known moves, and how what is computed changes with it. */
typedef struct {
    double z[DP_NZ], p[DP_NP + 1], time, force, smoothing;
} dp_direction;

typedef struct {
    double f[DP_NZ], y[DP_NY], power[2], g[DP_NS + 1], machine[DP_NM + 1];
} dp_change;

static void dp_change_along(const dp_engine *e, const dp_line *line, const double *s, const dp_direction *d,
                            const double *ds, dp_change *out) {
    dp_tangent(e->z, line->t0, line->c[0], e->p, s, d->z, d->time, d->force, d->p, ds, out->f, out->y, out->power,
               out->g, out->machine);
}

/* For a held motion, that change together with what the surfaces it rests on carry: so much that the acceleration stays
 * zero. Returns how what is left of the friction changes (see dp_capacity). */
static double dp_change_held(const dp_engine *e, const dp_line *line, const double *s, const dp_direction *d,
                             dp_change *out) {
    static const dp_direction still = {{0.0}, {0.0}, 0.0, 0.0, 0.0};
    double loose[DP_NS + 1], unit[DP_NS + 1], ds[DP_NS + 1], f[DP_NZ], g[DP_NS + 1], gd[DP_NS + 1];
    double rest, pull, spare, grip;
    int j;
    memset(unit, 0, sizeof unit);
    memset(ds, 0, sizeof ds);
    memcpy(loose, e->s, sizeof loose);
    dp_surface(e->z, line->t0, line->c[0], line->c[1], e->p, e->s, f, g, gd);
    for (j = 0; j < DP_NS; ++j)
        if (j == e->hold || (dp_kind[j] == DP_POSITION && g[j] == 0.0)) unit[j] = 1.0, loose[j] = 0.0;
    dp_capacity(e, line, 0.0, e->z, e->hold, &rest);
    dp_change_along(e, line, loose, d, ds, out);
    pull = out->f[1];
    spare = rest >= 0.0 ? -pull : pull;
    for (j = 0; j < DP_NS; ++j) {
        if (unit[j] == 0.0) continue;
        loose[j] = 1.0;
        dp_change_along(e, line, loose, d, ds, out);
        loose[j] = 0.0;
        spare += pull - out->f[1];
    }
    dp_change_along(e, line, s, &still, unit, out);
    grip = out->f[1];
    dp_change_along(e, line, s, d, ds, out);
    for (j = 0; j < DP_NS && grip != 0.0; ++j) ds[j] = -out->f[1] / grip * unit[j];
    dp_change_along(e, line, s, d, ds, out);
    out->f[0] = out->f[1] = out->y[3] = 0.0;
    return spare;
}

/* How rates, outputs, energy and dissipated power, and indicators change in a direction, the modes being what they
 * are. */
static void dp_continuous_tangent(dp_instance *m, const dp_direction *d, dp_change *out) {
    const dp_line line = dp_instance_line(m);
    const dp_engine *e = &m->engine;
    const double smoothing = dp_smoothing(m);
    double s[DP_NS + 1], ds[DP_NS + 1], spare = 0.0;
    int j;
    dp_continuous_modes(m, &line);
    dp_continuous_signs(m, &line, s);
    memset(ds, 0, sizeof ds);
    dp_change_along(e, &line, s, d, ds, out);
    if (smoothing > 0.0) {
        double g[DP_NS + 1];
        dp_surface_values(m, &line, g);
        for (j = 0; j < DP_NS; ++j)
            ds[j] = (1.0 - s[j] * s[j]) * (out->g[j] - g[j] * d->smoothing / smoothing) / (smoothing * dp_range[j]);
        dp_change_along(e, &line, s, d, ds, out);
    } else if (e->hold >= 0) {
        spare = dp_change_held(e, &line, s, d, out);
    }
    for (j = 0; j < DP_NS; ++j)
        out->g[j] = smoothing > 0.0 && dp_kind[j] != DP_VELOCITY ? 0.0 : j == e->hold ? spare : e->s[j] * out->g[j];
}

/* How outputs, energy and dissipated power change with the time, as the motion goes and the force went last. */
static void dp_continuous_course(dp_instance *m, dp_change *out) {
    dp_direction d;
    memset(&d, 0, sizeof d);
    dp_continuous_rates(m);
    memcpy(d.z, m->f, sizeof m->f);
    d.time = 1.0;
    d.force = m->rate;
    dp_continuous_tangent(m, &d, out);
}
