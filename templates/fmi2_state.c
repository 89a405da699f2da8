/* FMI 2.0: storing, restoring and serialising the state of an instance. Included behind fmi2.c. */
#include <stdint.h>

typedef struct {
    char model[sizeof DP_GUID];
    uint64_t check; /* over the state, so that a damaged one is refused */
    dp_state state;
} dp_snapshot;

/* FNV-1a (Fowler, Noll, Vo) */
static uint64_t dp_checksum(const void *data, size_t size) {
    const unsigned char *byte = (const unsigned char *)data;
    uint64_t sum = UINT64_C(14695981039346656037);
    size_t i;
    for (i = 0; i < size; ++i) sum = (sum ^ byte[i]) * UINT64_C(1099511628211);
    return sum;
}

static int dp_sound(const dp_snapshot *kept) {
    return memcmp(kept->model, DP_GUID, sizeof kept->model) == 0 &&
           kept->check == dp_checksum(&kept->state, sizeof kept->state);
}

FMI2_EXPORT fmi2Status fmi2GetFMUstate(fmi2Component component, fmi2FMUstate *state) {
    dp_component *c = (dp_component *)component;
    dp_snapshot *kept;
    if (!c) return fmi2Error;
    if (!state) return dp_report(c, fmi2Error, "fmi2GetFMUstate: null pointer");
    kept = (dp_snapshot *)(*state ? *state : calloc(1, sizeof *kept));
    if (!kept) return dp_report(c, fmi2Error, "fmi2GetFMUstate: out of memory");
    memcpy(kept->model, DP_GUID, sizeof kept->model);
    memcpy(&kept->state, &c->state, sizeof kept->state);
    /* the places that keep these arrays from being empty are never written: equal states shall be equal bytes */
    kept->state.model.engine.g[DP_NS] = kept->state.model.engine.gd[DP_NS] = 0.0;
    kept->check = dp_checksum(&kept->state, sizeof kept->state);
    *state = kept;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SetFMUstate(fmi2Component component, fmi2FMUstate state) {
    dp_component *c = (dp_component *)component;
    const dp_snapshot *kept = (const dp_snapshot *)state;
    if (!c) return fmi2Error;
    if (!kept || !dp_sound(kept)) return dp_report(c, fmi2Error, "fmi2SetFMUstate: not a state of this model");
    memcpy(&c->state, &kept->state, sizeof c->state);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component component, fmi2FMUstate *state) {
    if (!component) return fmi2Error;
    if (!state) return fmi2OK;
    free(*state);
    *state = NULL;
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component component, fmi2FMUstate state, size_t *size) {
    dp_component *c = (dp_component *)component;
    if (!c) return fmi2Error;
    if (!state || !size) return dp_report(c, fmi2Error, "fmi2SerializedFMUstateSize: null pointer");
    *size = sizeof(dp_snapshot);
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component component, fmi2FMUstate state, fmi2Byte bytes[],
                                             size_t size) {
    dp_component *c = (dp_component *)component;
    if (!c) return fmi2Error;
    if (!state || !bytes) return dp_report(c, fmi2Error, "fmi2SerializeFMUstate: null pointer");
    if (size < sizeof(dp_snapshot))
        return dp_report(c, fmi2Error, "fmi2SerializeFMUstate: a state has %u bytes", (unsigned)sizeof(dp_snapshot));
    memcpy(bytes, state, sizeof(dp_snapshot));
    return fmi2OK;
}

FMI2_EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component component, const fmi2Byte bytes[], size_t size,
                                               fmi2FMUstate *state) {
    dp_component *c = (dp_component *)component;
    dp_snapshot kept;
    if (!c) return fmi2Error;
    if (!bytes || !state) return dp_report(c, fmi2Error, "fmi2DeSerializeFMUstate: null pointer");
    if (size >= sizeof kept) memcpy(&kept, bytes, sizeof kept);
    if (size < sizeof kept || !dp_sound(&kept))
        return dp_report(c, fmi2Error, "fmi2DeSerializeFMUstate: the bytes are not a state of this model");
    if (!*state) *state = calloc(1, sizeof kept);
    if (!*state) return dp_report(c, fmi2Error, "fmi2DeSerializeFMUstate: out of memory");
    memcpy(*state, &kept, sizeof kept);
    return fmi2OK;
}
