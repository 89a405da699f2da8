/* Steps of co-simulation, modes and values of model exchange, for both versions of FMI. Included behind component.c. */

#define DP_MOST_COVERED 15 /* ranges whose warnings are counted one by one */
#define DP_MOST_STEPS 1e8 /* internal steps in one communication step; more is a slip of units */

/* Co-simulation -------------------------------------------------------------------------------------------------- */

/* Says once a run that a variable has left what the model was identified for, to each side. A long step may have left
 * an amplitude and come back. One below is that of any decay. */
static void dp_mind_range(dp_component *c) {
    dp_engine *e = &c->state.model.engine;
    int i;
    for (i = 0; i < DP_NCOVERED; ++i) {
        const dp_covered_range *covered = &dp_covered[i];
        const dp_variable *v = &dp_variables[covered->reference];
        const int swing = v->kind == DP_SWING;
        const double value = swing ? fmax(e->swing, e->widest) : dp_instance_get(&c->state.model, covered->reference);
        const int outside = dp_outside(covered, value), bit = (outside > 0 ? 1 : 2) << 2 * (i % DP_MOST_COVERED);
        if (outside == 0 || (c->state.told & bit)) continue;
        c->state.told |= bit;
        if (outside > 0 || !swing || c->host.talkative)
            dp_report(c, DP_WARNING, "by t = %.6g s the %s has been %.4g %s, %s the range %.4g to %.4g %s that the "
                      "model was identified in", e->t, v->name, value, covered->unit, outside > 0 ? "above" : "below",
                      covered->low, covered->high, covered->unit);
    }
    e->widest = 0.0;
}

static int dp_do_step(dp_component *c, double t, double dt, const char *function) {
    dp_instance *m;
    double slack;
    int status;
    if (dp_refused(c, DP_STEPPING, function)) return DP_ERROR;
    m = &c->state.model;
    if (!isfinite(t) || !isfinite(dt) || dt <= 0.0)
        return dp_report(c, DP_ERROR, DP_FMI "%s: a step of %g s from t = %g s; it must be finite and positive",
                         function, dt, t);
    slack = 1e-6 * dt + 1e-9 * (1.0 + fabs(t)); /* importers count time in their own way: sums, products, nanoseconds */
    if (fabs(t - m->engine.t) > slack)
        return dp_report(c, DP_ERROR, DP_FMI "%s: from t = %.12g s, but the model stands at %.12g s", function, t,
                         m->engine.t);
    if (t + dt > c->state.stop_time + slack)
        return dp_report(c, DP_ERROR, DP_FMI "%s: to t = %.12g s, beyond the stop time of %.12g s", function, t + dt,
                         c->state.stop_time);
    if (dt > DP_MOST_STEPS * m->engine.max_step) {
        c->state.mode = DP_FAILED;
        return dp_report(c, DP_DISCARD, DP_FMI "%s: %g s are too long for internal steps of %g s", function, dt,
                         m->engine.max_step);
    }
    status = dp_instance_step(m, t, dt);
    if (status == DP_OK) {
        dp_mind_range(c);
        return DP_FINE;
    }
    c->state.mode = DP_FAILED;
    return dp_report(c, DP_DISCARD, DP_FMI "%s: from t = %.12g s over %g s: %s", function, t, dt,
                     status == DP_TOO_MANY_EVENTS ? "the motion switches without end"
                                                  : "the motion grows beyond bounds");
}

/* First derivatives of outputs by time, as the motion goes and as the force went at the end of the latest step. */
static int dp_output_rates(dp_component *c, const unsigned *vr, size_t n, const int *order, double *value,
                           const char *function) {
    dp_change change;
    size_t i;
    if (dp_refused(c, DP_STEPPING | DP_FAILED | DP_ENDED, function)) return DP_ERROR;
    if (c->state.model.exchange) return dp_unsupported(c, function);
    if (dp_bad_references(c, vr, n, value, function)) return DP_ERROR;
    if (n > 0 && !order) return dp_null(c, function);
    for (i = 0; i < n; ++i) {
        const int kind = dp_variables[vr[i]].kind;
        if (kind < DP_OUTPUT || kind > DP_OUTSIDE)
            return dp_report(c, DP_ERROR, DP_FMI "%s: %s is no output", function, dp_variables[vr[i]].name);
        if (order[i] != 1) return dp_report(c, DP_ERROR, DP_FMI "%s: gives derivatives of order 1", function);
    }
    if (n > 0) dp_continuous_course(&c->state.model, &change);
    for (i = 0; i < n; ++i) {
        const dp_variable *v = &dp_variables[vr[i]];
        value[i] = v->kind == DP_OUTPUT ? change.y[v->index] : v->kind == DP_POWER ? change.power[v->index] : 0.0;
        if (!isfinite(value[i]))
            return dp_report(c, DP_DISCARD, DP_FMI "%s: %s has no finite derivative here", function, v->name);
    }
    return DP_FINE;
}

/* Model exchange ------------------------------------------------------------------------------------------------- */

/* What an importer must be told after an event. */
static int dp_update(dp_component *c, int *states_changed, const char *function) {
    if (dp_refused(c, DP_EVENT, function)) return DP_ERROR;
    *states_changed = dp_continuous_event(&c->state.model);
    dp_mind_range(c);
    return DP_FINE;
}

static int dp_enter(dp_component *c, int from, int to, const char *function) {
    if (dp_refused(c, from, function)) return DP_ERROR;
    if (!c->state.model.exchange) return dp_unsupported(c, function);
    c->state.mode = to;
    return DP_FINE;
}

static int dp_set_time(dp_component *c, double t, const char *function) {
    if (dp_refused(c, DP_EVENT | DP_CONTINUOUS, function)) return DP_ERROR;
    if (!isfinite(t)) return dp_report(c, DP_ERROR, DP_FMI "%s: not a finite number", function);
    c->state.model.engine.t = t;
    c->state.model.ready = 0;
    return DP_FINE;
}

/* Whether n is the size that the model has, and there is a place for so many values. */
static int dp_wrong_size(const dp_component *c, size_t n, size_t size, const void *value, const char *function) {
    if (n != size)
        return dp_report(c, DP_ERROR, DP_FMI "%s: %u values where the model has %u", function, (unsigned)n,
                         (unsigned)size);
    return n > 0 && !value ? dp_null(c, function) : 0;
}

/* Name of the variable that the state of that number is. */
static const char *dp_state_name(size_t state) {
    unsigned i = 0;
    while (i + 1 < DP_NV && dp_instance_state(&dp_variables[i]) != (int)state) ++i;
    return dp_variables[i].name;
}

static int dp_set_states(dp_component *c, const double *z, size_t n, const char *function) {
    size_t i;
    if (dp_refused(c, DP_CONTINUOUS, function) || dp_wrong_size(c, n, DP_OWN, z, function)) return DP_ERROR;
    for (i = 0; i < n; ++i)
        if (!isfinite(z[i]))
            return dp_report(c, DP_ERROR, DP_FMI "%s: %s is not finite", function, dp_state_name(i + DP_GIVEN));
    if (n > 0) memcpy(c->state.model.engine.z + DP_GIVEN, z, n * sizeof *z);
    c->state.model.ready = 0;
    return DP_FINE;
}

static int dp_get_states(dp_component *c, double *z, size_t n, const char *function) {
    if (dp_refused(c, DP_INITIALISING | DP_EVENT | DP_CONTINUOUS | DP_ENDED, function)) return DP_ERROR;
    if (dp_wrong_size(c, n, DP_OWN, z, function)) return DP_ERROR;
    dp_instance_prepare(&c->state.model);
    if (n > 0) memcpy(z, c->state.model.engine.z + DP_GIVEN, n * sizeof *z);
    return DP_FINE;
}

static int dp_get_rates(dp_component *c, double *f, size_t n, const char *function) {
    size_t i;
    if (dp_refused(c, DP_INITIALISING | DP_EVENT | DP_CONTINUOUS | DP_ENDED, function)) return DP_ERROR;
    if (dp_wrong_size(c, n, DP_OWN, f, function)) return DP_ERROR;
    dp_continuous_rates(&c->state.model);
    if (n > 0) memcpy(f, c->state.model.f + DP_GIVEN, n * sizeof *f);
    for (i = 0; i < n; ++i)
        if (!isfinite(f[i]))
            return dp_report(c, DP_DISCARD, DP_FMI "%s: der(%s) is not finite here", function,
                             dp_state_name(i + DP_GIVEN));
    return DP_FINE;
}

static int dp_get_indicators(dp_component *c, double *g, size_t n, const char *function) {
    if (dp_refused(c, DP_INITIALISING | DP_EVENT | DP_CONTINUOUS | DP_ENDED, function)) return DP_ERROR;
    if (dp_wrong_size(c, n, DP_NS, g, function)) return DP_ERROR;
    dp_continuous_indicators(&c->state.model);
    memcpy(g, c->state.model.indicator, n * sizeof *g);
    return DP_FINE;
}

static int dp_get_nominals(dp_component *c, double *z, size_t n, const char *function) {
    if (dp_refused(c, DP_ANY & ~DP_NEW, function)) return DP_ERROR;
    if (dp_wrong_size(c, n, DP_OWN, z, function)) return DP_ERROR;
    if (n > 0) memcpy(z, dp_nominal + DP_GIVEN, n * sizeof *z);
    return DP_FINE;
}
