/* Arguments good and bad, from a seed: the same seed, the same calls. Arrays come from the heap with exactly the room
 * that is said, so that the address sanitizer sees every step beyond. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static _Thread_local uint64_t dice_state = 1;

/* xorshift64* (Vigna 2016) */
static uint64_t dice(void) {
    dice_state ^= dice_state >> 12;
    dice_state ^= dice_state << 25;
    dice_state ^= dice_state >> 27;
    return dice_state * UINT64_C(2685821657736338717);
}

static unsigned pick(unsigned n) { return (unsigned)((dice() >> 33) % n); }

static int chance(unsigned one_in) { return pick(one_in) == 0; }

static double uniform(double low, double high) {
    return low + (high - low) * (double)(dice() >> 11) / 9007199254740992.0;
}

/* A value for a variable: mostly sane, else what no variable can take or none should. */
static double any_value(void) {
    static const double odd[] = {NAN, INFINITY, -INFINITY, 0.0, -0.0, 1e-310, 1e300, -1e300, 1e16, -1.0};
    return chance(4) ? odd[pick(sizeof odd / sizeof *odd)] : uniform(-1.0, 1.0) * pow(10.0, uniform(-4.0, 3.0));
}

/* A length of time: mostly what importers ask for. */
static double any_step(void) {
    static const double odd[] = {0.0, -0.0, -1e-3, NAN, INFINITY, -INFINITY, 1e-300, 1e12, 1e300};
    return chance(4) ? odd[pick(sizeof odd / sizeof *odd)] : pow(10.0, uniform(-5.0, -2.0));
}

/* What is given to a call besides its component: room for n values and references, each of them null now and then. */
typedef struct {
    size_t n, m;
    uint32_t *reference, *further;
    double *real, *direction;
    int *order, *integer;
    bool *boolean;
    const char **text;
} arguments;

static void *room(size_t n, size_t size) {
    void *place = chance(12) ? NULL : malloc(n * size + (n == 0));
    if (place) memset(place, 0, n * size);
    return place;
}

static uint32_t any_reference(unsigned variables) {
    static const uint32_t odd[] = {UINT32_MAX, 0x80000000u, 1000, 99};
    if (chance(12)) return chance(3) ? variables : odd[pick(4)];
    return pick(variables);
}

static arguments any_arguments(unsigned variables) {
    arguments a;
    size_t i;
    a.n = chance(10) ? 0 : 1 + pick(4);
    a.m = chance(10) ? 0 : 1 + pick(3);
    a.reference = (uint32_t *)room(a.n, sizeof *a.reference);
    a.further = (uint32_t *)room(a.m, sizeof *a.further);
    a.real = (double *)room(a.n, sizeof *a.real);
    a.direction = (double *)room(a.m, sizeof *a.direction);
    a.order = (int *)room(a.n, sizeof *a.order);
    a.integer = (int *)room(a.n, sizeof *a.integer);
    a.boolean = (bool *)room(a.n, sizeof *a.boolean);
    a.text = (const char **)room(a.n, sizeof *a.text);
    for (i = 0; i < a.n; ++i) {
        if (a.reference) a.reference[i] = chance(3) ? 0 : any_reference(variables); /* the force is worth more */
        if (a.real) a.real[i] = any_value();
        if (a.order) a.order[i] = chance(8) ? (int)pick(9) - 4 : 1 + (int)pick(3);
    }
    for (i = 0; i < a.m; ++i) {
        if (a.further) a.further[i] = any_reference(variables);
        if (a.direction) a.direction[i] = any_value();
    }
    return a;
}

static void drop(arguments *a) {
    free(a->reference), free(a->further), free(a->real), free(a->direction), free(a->order), free(a->integer);
    free(a->boolean), free((void *)a->text);
}
