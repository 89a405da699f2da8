/* Storing, restoring and serialising the state of an instance, for both versions of FMI. Included behind component.c. */

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

static int dp_get_state(dp_component *c, void **state, const char *function) {
    dp_snapshot *kept;
    dp_instance *m;
    if (!c) return DP_ERROR;
    if (!state) return dp_null(c, function);
    kept = (dp_snapshot *)(*state ? *state : calloc(1, sizeof *kept));
    if (!kept) return dp_report(c, DP_ERROR, DP_FMI "%s: out of memory", function);
    memcpy(kept->model, DP_GUID, sizeof kept->model);
    memcpy(&kept->state, &c->state, sizeof kept->state);
    /* what can be computed again is not kept, nor the places that keep arrays from being empty: equal states shall be
     * equal bytes */
    m = &kept->state.model;
    m->ready = 0;
    memset(m->y, 0, sizeof m->y);
    memset(m->power, 0, sizeof m->power);
    memset(m->f, 0, sizeof m->f);
    memset(m->indicator, 0, sizeof m->indicator);
    m->engine.g[DP_NS] = m->engine.gd[DP_NS] = 0.0;
    kept->check = dp_checksum(&kept->state, sizeof kept->state);
    *state = kept;
    return DP_FINE;
}

static int dp_set_state(dp_component *c, const void *state, const char *function) {
    const dp_snapshot *kept = (const dp_snapshot *)state;
    if (!c) return DP_ERROR;
    if (!kept || !dp_sound(kept)) return dp_report(c, DP_ERROR, DP_FMI "%s: not a state of this model", function);
    if (kept->state.model.exchange != c->state.model.exchange)
        return dp_report(c, DP_ERROR, DP_FMI "%s: a state of the other kind of interface", function);
    memcpy(&c->state, &kept->state, sizeof c->state);
    return DP_FINE;
}

static int dp_free_state(dp_component *c, void **state) {
    if (!c) return DP_ERROR;
    if (!state) return DP_FINE;
    free(*state);
    *state = NULL;
    return DP_FINE;
}

static int dp_state_size(dp_component *c, const void *state, size_t *size, const char *function) {
    if (!c) return DP_ERROR;
    if (!state || !size) return dp_null(c, function);
    *size = sizeof(dp_snapshot);
    return DP_FINE;
}

static int dp_serialise(dp_component *c, const void *state, void *bytes, size_t size, const char *function) {
    if (!c) return DP_ERROR;
    if (!state || !bytes) return dp_null(c, function);
    if (size < sizeof(dp_snapshot))
        return dp_report(c, DP_ERROR, DP_FMI "%s: a state has %u bytes", function, (unsigned)sizeof(dp_snapshot));
    memcpy(bytes, state, sizeof(dp_snapshot));
    return DP_FINE;
}

static int dp_deserialise(dp_component *c, const void *bytes, size_t size, void **state, const char *function) {
    dp_snapshot kept;
    if (!c) return DP_ERROR;
    if (!bytes || !state) return dp_null(c, function);
    if (size >= sizeof kept) memcpy(&kept, bytes, sizeof kept);
    if (size < sizeof kept || !dp_sound(&kept))
        return dp_report(c, DP_ERROR, DP_FMI "%s: the bytes are not a state of this model", function);
    if (!*state) *state = calloc(1, sizeof kept);
    if (!*state) return dp_report(c, DP_ERROR, DP_FMI "%s: out of memory", function);
    memcpy(*state, &kept, sizeof kept);
    return DP_FINE;
}
