/* What both versions call alike but for the name: kept states, and arrays of a size that the model has. */

#define KEPT(get_state, set_state, free_state, state_size, serialise_state, deserialise_state, byte)        \
    static int keep(instance *i, arguments *a) {                                                            \
        const unsigned k = pick(STATES);                                                                    \
        const int status = get_state(i->component, chance(10) ? NULL : &i->kept[k]);                        \
        (void)a;                                                                                            \
        if (status == 0) i->kept_at[k] = i->t;                                                              \
        return status;                                                                                      \
    }                                                                                                       \
    static int restore(instance *i, arguments *a) {                                                         \
        const unsigned k = pick(STATES);                                                                    \
        const int status = set_state(i->component, i->kept[k]);                                             \
        (void)a;                                                                                            \
        if (status == 0) i->t = i->kept_at[k];                                                              \
        return status;                                                                                      \
    }                                                                                                       \
    static int keep_state(void *c, void **state) { return (int)get_state(c, state); }                       \
    static void release_state(void *c, void **state) { free_state(c, state); }                              \
    static int forget(instance *i, arguments *a) {                                                          \
        return (void)a, (int)free_state(i->component, chance(10) ? NULL : &i->kept[pick(STATES)]);          \
    }                                                                                                       \
    static int length(instance *i, arguments *a) {                                                          \
        size_t out;                                                                                         \
        return (void)a, (int)state_size(i->component, i->kept[pick(STATES)], chance(10) ? NULL : &out);     \
    }                                                                                                       \
    static int serialise(instance *i, arguments *a) {                                                       \
        void *const state = i->kept[pick(STATES)];                                                          \
        size_t size = 0;                                                                                    \
        int status;                                                                                         \
        byte *bytes;                                                                                        \
        (void)a;                                                                                            \
        if (state_size(i->component, state, &size) != 0) size = pick(64);                                   \
        if (chance(6)) size = pick((unsigned)size + 1); /* too little room */                               \
        bytes = (byte *)malloc(size + (size == 0));                                                         \
        status = serialise_state(i->component, state, chance(10) ? NULL : bytes, size);                     \
        if (status == 0) {                                                                                  \
            free(i->bytes);                                                                                 \
            i->bytes = bytes, i->length = size;                                                             \
        } else {                                                                                            \
            free(bytes);                                                                                    \
        }                                                                                                   \
        return status;                                                                                      \
    }                                                                                                       \
    static int deserialise(instance *i, arguments *a) {                                                     \
        const unsigned k = pick(STATES);                                                                    \
        const size_t size = chance(6) ? pick((unsigned)i->length + 1) : i->length;                          \
        byte *bytes = i->bytes ? (byte *)malloc(size + (size == 0)) : NULL;                                 \
        int status;                                                                                         \
        (void)a;                                                                                            \
        if (bytes) memcpy(bytes, i->bytes, size);                                                           \
        if (bytes && size && chance(3)) bytes[pick((unsigned)size)] ^= (byte)(1 << pick(8)); /* damaged */  \
        status = deserialise_state(i->component, bytes, size, chance(10) ? NULL : &i->kept[k]);             \
        if (status == 0) i->kept_at[k] = i->t;                                                              \
        free(bytes);                                                                                        \
        return status;                                                                                      \
    }

/* Room for as many values as the call says, which is mostly what the model has. */
#define SIZED(name, function, size)                                                                         \
    static int name(instance *i, arguments *a) {                                                            \
        const size_t n = chance(5) ? pick(5) : (size);                                                      \
        double *x = (double *)room(n, sizeof *x);                                                           \
        size_t k;                                                                                           \
        int status;                                                                                         \
        (void)a;                                                                                            \
        for (k = 0; x && k < n; ++k) x[k] = chance(8) ? any_value() : uniform(-0.01, 0.01);                 \
        status = function(i->component, x, n);                                                              \
        free(x);                                                                                            \
        return status;                                                                                      \
    }
