/* FMI 2.0 co-simulation: input slopes, steps, status. Included behind fmi2.c. */

#define DP_MOST_STEPS 1e8 /* internal steps in one communication step; more is a slip of units */

/* First to third derivative of the force, which then runs as a cubic. They hold for the next step only: forgotten ones
 * must not drive the model away. */
FMI2_EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component component, const fmi2ValueReference vr[], size_t n,
                                                   const fmi2Integer order[], const fmi2Real value[]) {
    dp_component *c = (dp_component *)component;
    size_t i;
    if (dp_refused(c, DP_NEW | DP_INITIALISING | DP_STEPPING, "fmi2SetRealInputDerivatives")) return fmi2Error;
    if (dp_bad_references(c, vr, n, value, "fmi2SetRealInputDerivatives")) return fmi2Error;
    if (n > 0 && !order) return dp_report(c, fmi2Error, "fmi2SetRealInputDerivatives: null pointer");
    for (i = 0; i < n; ++i) {
        if (dp_variables[vr[i]].kind != DP_INPUT)
            return dp_report(c, fmi2Error, "fmi2SetRealInputDerivatives: variable %u is no input", vr[i]);
        if (order[i] < 1 || order[i] > DP_ORDERS || !isfinite(value[i]))
            return dp_report(c, fmi2Error, "fmi2SetRealInputDerivatives: takes finite derivatives of order 1 to %d",
                             DP_ORDERS);
    }
    for (i = 0; i < n; ++i) c->state.model.slope[order[i] - 1] = value[i];
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t n,
                                                    const fmi2Integer order[], fmi2Real value[]) {
    (void)vr, (void)n, (void)order, (void)value;
    return dp_unsupported((dp_component *)c, "fmi2GetRealOutputDerivatives");
}

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component component, fmi2Real t, fmi2Real dt, fmi2Boolean no_set_before) {
    dp_component *c = (dp_component *)component;
    dp_instance *m;
    double slack;
    int status;
    (void)no_set_before;
    if (dp_refused(c, DP_STEPPING, "fmi2DoStep")) return fmi2Error;
    m = &c->state.model;
    if (!isfinite(t) || !isfinite(dt) || dt <= 0.0)
        return dp_report(c, fmi2Error, "fmi2DoStep: a step of %g s from t = %g s; it must be finite and positive", dt,
                         t);
    slack = 1e-6 * dt + 1e-9 * (1.0 + fabs(t)); /* importers count time in their own way: sums, products, nanoseconds */
    if (fabs(t - m->engine.t) > slack)
        return dp_report(c, fmi2Error, "fmi2DoStep: from t = %.12g s, but the model stands at %.12g s", t, m->engine.t);
    if (t + dt > c->state.stop_time + slack)
        return dp_report(c, fmi2Error, "fmi2DoStep: to t = %.12g s, beyond the stop time of %.12g s", t + dt,
                         c->state.stop_time);
    if (dt / m->engine.max_step > DP_MOST_STEPS) {
        c->state.mode = DP_FAILED;
        return dp_report(c, fmi2Discard, "fmi2DoStep: %g s are too long for internal steps of %g s", dt,
                         m->engine.max_step);
    }
    status = dp_instance_step(m, t, dt);
    if (status == DP_OK) return fmi2OK;
    c->state.mode = DP_FAILED;
    return dp_report(c, fmi2Discard, "fmi2DoStep: from t = %.12g s over %g s: %s", t, dt,
                     status == DP_TOO_MANY_EVENTS ? "the motion switches without end"
                                                  : "the motion grows beyond bounds");
}

FMI2_EXPORT fmi2Status fmi2CancelStep(fmi2Component component) {
    dp_component *c = (dp_component *)component;
    return c ? dp_report(c, fmi2Error, "fmi2CancelStep: no step is under way") : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2GetStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Status *value) {
    dp_component *c = (dp_component *)component;
    if (dp_refused(c, DP_STEPPING | DP_FAILED | DP_ENDED, "fmi2GetStatus")) return fmi2Error;
    if (!value) return dp_report(c, fmi2Error, "fmi2GetStatus: null pointer");
    if (kind != fmi2DoStepStatus) return dp_report(c, fmi2Discard, "fmi2GetStatus: no such status");
    *value = c->state.mode == DP_FAILED ? fmi2Discard : fmi2OK;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetRealStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Real *value) {
    dp_component *c = (dp_component *)component;
    if (dp_refused(c, DP_STEPPING | DP_FAILED | DP_ENDED, "fmi2GetRealStatus")) return fmi2Error;
    if (!value) return dp_report(c, fmi2Error, "fmi2GetRealStatus: null pointer");
    if (kind != fmi2LastSuccessfulTime) return dp_report(c, fmi2Discard, "fmi2GetRealStatus: no such status");
    *value = c->state.model.engine.t;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Integer *value) {
    dp_component *c = (dp_component *)component;
    (void)kind, (void)value;
    return c ? dp_report(c, fmi2Discard, "fmi2GetIntegerStatus: no such status") : fmi2Error;
}

FMI2_EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component component, const fmi2StatusKind kind, fmi2Boolean *value) {
    dp_component *c = (dp_component *)component;
    if (dp_refused(c, DP_STEPPING | DP_FAILED | DP_ENDED, "fmi2GetBooleanStatus")) return fmi2Error;
    if (!value) return dp_report(c, fmi2Error, "fmi2GetBooleanStatus: null pointer");
    if (kind != fmi2Terminated) return dp_report(c, fmi2Discard, "fmi2GetBooleanStatus: no such status");
    *value = fmi2False; /* the model never asks for the end */
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2GetStringStatus(fmi2Component component, const fmi2StatusKind kind, fmi2String *value) {
    dp_component *c = (dp_component *)component;
    (void)kind, (void)value;
    return c ? dp_report(c, fmi2Discard, "fmi2GetStringStatus: no such status") : fmi2Error;
}
