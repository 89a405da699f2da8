/* Calls an FMU's functions in any order with any arguments, from a seed.
 *
 *     fuzz TOKEN VARIABLES SOURCE OUTPUT STATES INDICATORS EXCHANGE SEED CALLS
 *
 * Held: every call returns a status that exists; a call that is refused or cannot be done has said why; one that was
 * refused has changed no variable; what is handed out is finite; without an instance the status is an error. The
 * sanitizers hold the rest. Prints for each function how often it was carried out, discarded and refused. */
#include "all.c"

#include "calls.h"

enum { INSTANCES = 3, MOST_VARIABLES = 200 };

static void forget_all(instance *i) {
    int k;
    for (k = 0; k < STATES; ++k) { /* states are freed by the instance that they came from */
        if (i->component && i->kept[k]) release_state(i->component, &i->kept[k]);
        i->kept[k] = NULL;
    }
    free(i->bytes);
    i->bytes = NULL, i->length = 0;
    if (i->component) destroy(i->component);
    i->component = NULL;
}

/* All variables, each by a call of its own; a status for a value that is not given. */
static void observe(const instance *i, double *seen) {
    unsigned k;
    for (k = 0; k < the.variables; ++k) {
        double x = 0.0;
        const int status = value(i->component, k, &x);
        if (status == 0 && !isfinite(x)) fail("handed out what is not finite", "getting");
        seen[k] = status == 0 ? x : -1e30 * status;
    }
}

static int drawn(int total) {
    int left = (int)pick((unsigned)total), k = 0;
    while (left >= functions[k].weight) left -= functions[k++].weight;
    return k;
}

int main(int count, char **argument) {
    instance all[INSTANCES];
    long calls, n, done[FUNCTIONS][3];
    int k, total = 0, exchange;
    if (count != 10) fail("nine arguments", "usage");
    describe(argument);
    exchange = atoi(argument[7]);
    dice_state = UINT64_C(88172645463325252) ^ ((uint64_t)atoi(argument[8]) << 20);
    calls = atol(argument[9]);
    if (the.variables > MOST_VARIABLES) fail("too many variables", "usage");
    memset(all, 0, sizeof all);
    memset(done, 0, sizeof done);
    for (k = 0; k < FUNCTIONS; ++k) total += functions[k].weight;
    for (n = 0; n < calls; ++n) {
        instance *const i = &all[pick(INSTANCES)];
        const function *f = &functions[drawn(total)];
        double before[MOST_VARIABLES], after[MOST_VARIABLES];
        arguments a;
        long said;
        int status, watched;
        if (chance(400)) forget_all(i);
        if (chance(500)) create_badly();
        if (!i->component) {
            i->silent = chance(10), i->exchange = exchange, i->t = 0.0;
            i->component = create(i->exchange, i->silent);
            if (!i->component) fail("no instance", "create");
        }
        a = any_arguments(the.variables);
        if (chance(50)) { /* without an instance */
            instance nobody;
            memset(&nobody, 0, sizeof nobody);
            if (f->call(&nobody, &a) < REFUSED) fail("carried out without an instance", f->name);
            drop(&a);
            free(nobody.bytes);
            continue;
        }
        watched = chance(4);
        if (watched) observe(i, before);
        said = messages;
        status = f->call(i, &a);
        drop(&a);
        if (status < 0 || status > MOST_STATUS) fail("no status", f->name);
        if (status >= REFUSED && messages == said && !i->silent) fail("refused without a word", f->name);
        if (status > REFUSED && watched) {
            observe(i, after);
            if (memcmp(before, after, the.variables * sizeof *before)) fail("refused, yet changed", f->name);
        }
        ++done[f - functions][status < REFUSED ? 0 : status == REFUSED ? 1 : 2];
    }
    for (k = 0; k < INSTANCES; ++k) forget_all(&all[k]);
    for (k = 0; k < FUNCTIONS; ++k)
        printf("%s %ld %ld %ld\n", functions[k].name, done[k][0], done[k][1], done[k][2]);
    return 0;
}
