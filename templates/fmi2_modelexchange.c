/* FMI 2.0 model exchange is not offered; importers that look up every symbol find it, and a word in the log. Included
 * behind fmi2.c. */

FMI2_EXPORT fmi2Status fmi2EnterEventMode(fmi2Component c) {
    return dp_unsupported((dp_component *)c, "fmi2EnterEventMode");
}

FMI2_EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info) {
    (void)info;
    return dp_unsupported((dp_component *)c, "fmi2NewDiscreteStates");
}

FMI2_EXPORT fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) {
    return dp_unsupported((dp_component *)c, "fmi2EnterContinuousTimeMode");
}

FMI2_EXPORT fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_set_before, fmi2Boolean *event,
                                                   fmi2Boolean *end) {
    (void)no_set_before, (void)event, (void)end;
    return dp_unsupported((dp_component *)c, "fmi2CompletedIntegratorStep");
}

FMI2_EXPORT fmi2Status fmi2SetTime(fmi2Component c, fmi2Real t) {
    (void)t;
    return dp_unsupported((dp_component *)c, "fmi2SetTime");
}

FMI2_EXPORT fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t n) {
    (void)x, (void)n;
    return dp_unsupported((dp_component *)c, "fmi2SetContinuousStates");
}

FMI2_EXPORT fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real value[], size_t n) {
    (void)value, (void)n;
    return dp_unsupported((dp_component *)c, "fmi2GetDerivatives");
}

FMI2_EXPORT fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real value[], size_t n) {
    (void)value, (void)n;
    return dp_unsupported((dp_component *)c, "fmi2GetEventIndicators");
}

FMI2_EXPORT fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real value[], size_t n) {
    (void)value, (void)n;
    return dp_unsupported((dp_component *)c, "fmi2GetContinuousStates");
}

FMI2_EXPORT fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component c, fmi2Real value[], size_t n) {
    (void)value, (void)n;
    return dp_unsupported((dp_component *)c, "fmi2GetNominalsOfContinuousStates");
}
