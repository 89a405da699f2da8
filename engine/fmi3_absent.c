/* FMI 3.0: what the model has not. Importers that look up every symbol find it, and a word in the log. Included behind
 * fmi3.c. */

/* No variable is of another type: asking for none is fine, asking for one is not. */
#define DP_ABSENT(type)                                                                                                \
    FMI3_EXPORT fmi3Status fmi3Get##type(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3##type value[],  \
                                         size_t values) {                                                              \
        (void)vr, (void)value, (void)values;                                                                           \
        return (fmi3Status)dp_no_variables((dp_component *)c, n, "Get" #type);                                         \
    }                                                                                                                  \
    FMI3_EXPORT fmi3Status fmi3Set##type(fmi3Instance c, const fmi3ValueReference vr[], size_t n,                      \
                                         const fmi3##type value[], size_t values) {                                    \
        (void)vr, (void)value, (void)values;                                                                           \
        return (fmi3Status)dp_no_variables((dp_component *)c, n, "Set" #type);                                         \
    }

DP_ABSENT(Float32)
DP_ABSENT(Int8)
DP_ABSENT(UInt8)
DP_ABSENT(Int16)
DP_ABSENT(UInt16)
DP_ABSENT(Int32)
DP_ABSENT(UInt32)
DP_ABSENT(Int64)
DP_ABSENT(UInt64)
DP_ABSENT(Boolean)
DP_ABSENT(String)

FMI3_EXPORT fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, size_t sizes[],
                                     fmi3Binary value[], size_t values) {
    (void)vr, (void)sizes, (void)value, (void)values;
    return (fmi3Status)dp_no_variables((dp_component *)c, n, "GetBinary");
}

FMI3_EXPORT fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const size_t sizes[],
                                     const fmi3Binary value[], size_t values) {
    (void)vr, (void)sizes, (void)value, (void)values;
    return (fmi3Status)dp_no_variables((dp_component *)c, n, "SetBinary");
}

FMI3_EXPORT fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, fmi3Clock value[]) {
    (void)vr, (void)value;
    return (fmi3Status)dp_no_variables((dp_component *)c, n, "GetClock");
}

FMI3_EXPORT fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference vr[], size_t n, const fmi3Clock value[]) {
    (void)vr, (void)value;
    return (fmi3Status)dp_no_variables((dp_component *)c, n, "SetClock");
}

FMI3_EXPORT fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                              fmi3Float64 interval[], fmi3IntervalQualifier qualifier[]) {
    (void)vr, (void)interval, (void)qualifier;
    return (fmi3Status)dp_no_variables((dp_component *)c, n, "GetIntervalDecimal");
}

FMI3_EXPORT fmi3Status fmi3GetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                               fmi3UInt64 counter[], fmi3UInt64 resolution[],
                                               fmi3IntervalQualifier qualifier[]) {
    (void)vr, (void)counter, (void)resolution, (void)qualifier;
    return (fmi3Status)dp_no_variables((dp_component *)c, n, "GetIntervalFraction");
}

FMI3_EXPORT fmi3Status fmi3GetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                           fmi3Float64 shift[]) {
    (void)vr, (void)shift;
    return (fmi3Status)dp_no_variables((dp_component *)c, n, "GetShiftDecimal");
}

FMI3_EXPORT fmi3Status fmi3GetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                            fmi3UInt64 counter[], fmi3UInt64 resolution[]) {
    (void)vr, (void)counter, (void)resolution;
    return (fmi3Status)dp_no_variables((dp_component *)c, n, "GetShiftFraction");
}

FMI3_EXPORT fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                              const fmi3Float64 interval[]) {
    (void)vr, (void)interval;
    return (fmi3Status)dp_no_variables((dp_component *)c, n, "SetIntervalDecimal");
}

FMI3_EXPORT fmi3Status fmi3SetIntervalFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                               const fmi3UInt64 counter[], const fmi3UInt64 resolution[]) {
    (void)vr, (void)counter, (void)resolution;
    return (fmi3Status)dp_no_variables((dp_component *)c, n, "SetIntervalFraction");
}

FMI3_EXPORT fmi3Status fmi3SetShiftDecimal(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                           const fmi3Float64 shift[]) {
    (void)vr, (void)shift;
    return (fmi3Status)dp_no_variables((dp_component *)c, n, "SetShiftDecimal");
}

FMI3_EXPORT fmi3Status fmi3SetShiftFraction(fmi3Instance c, const fmi3ValueReference vr[], size_t n,
                                            const fmi3UInt64 counter[], const fmi3UInt64 resolution[]) {
    (void)vr, (void)counter, (void)resolution;
    return (fmi3Status)dp_no_variables((dp_component *)c, n, "SetShiftFraction");
}

FMI3_EXPORT fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance c, fmi3ValueReference vr, size_t *count) {
    (void)vr, (void)count;
    return (fmi3Status)dp_unsupported((dp_component *)c, "GetNumberOfVariableDependencies");
}

FMI3_EXPORT fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference dependent, size_t elements[],
                                                   fmi3ValueReference independents[], size_t independent_elements[],
                                                   fmi3DependencyKind kinds[], size_t count) {
    (void)dependent, (void)elements, (void)independents, (void)independent_elements, (void)kinds, (void)count;
    return (fmi3Status)dp_unsupported((dp_component *)c, "GetVariableDependencies");
}

FMI3_EXPORT fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time) {
    (void)clock, (void)time;
    return (fmi3Status)dp_unsupported((dp_component *)c, "ActivateModelPartition");
}

FMI3_EXPORT fmi3Status fmi3EnterConfigurationMode(fmi3Instance c) {
    return (fmi3Status)dp_unsupported((dp_component *)c, "EnterConfigurationMode");
}

FMI3_EXPORT fmi3Status fmi3ExitConfigurationMode(fmi3Instance c) {
    return (fmi3Status)dp_unsupported((dp_component *)c, "ExitConfigurationMode");
}

FMI3_EXPORT fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources,
                                                           fmi3Boolean visible, fmi3Boolean logging,
                                                           fmi3InstanceEnvironment environment,
                                                           fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
                                                           fmi3LockPreemptionCallback lock,
                                                           fmi3UnlockPreemptionCallback unlock) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)update, (void)lock, (void)unlock;
    if (log)
        log(environment, fmi3Error, "logStatusError",
            "fmi3InstantiateScheduledExecution: this model is for co-simulation and model exchange");
    return NULL;
}
