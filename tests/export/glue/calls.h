/* What the fuzzer, the rounds and the threads need of a version of FMI (FMI_VERSION); calls_fmi2.h and calls_fmi3.h say
 * it. Included behind the FMU's sources. */
#include "arguments.h"

enum { STATES = 3, MOST_STATUS = 5, REFUSED = 2 };

/* What the model is: read in its description, given on the command line. */
typedef struct {
    const char *token;
    unsigned variables, source, output, states, indicators;
} model;

static model the;

/* An instance, and what a careful importer would remember of it. */
typedef struct {
    void *component;
    int silent;   /* it was given no logger */
    int exchange; /* for model exchange */
    double t;
    void *kept[STATES];
    double kept_at[STATES];
    void *bytes;  /* a state, serialised */
    size_t length;
} instance;

typedef struct {
    const char *name;
    int (*call)(instance *, arguments *); /* the status */
    int weight;
} function;

static long messages; /* from all instances */

static void fail(const char *what, const char *which) {
    fprintf(stderr, "%s: %s\n", which, what);
    exit(1);
}

/* Every text must be one that an importer may print: it formats it again. */
static void heard(const char *text) {
    ++messages;
    if (!text || !*text) fail("a message without a text", "log");
    if (strchr(text, '%')) fail("a message with a per cent sign", text);
}

/* TOKEN VARIABLES SOURCE OUTPUT STATES INDICATORS, as every program here has them first. */
static void describe(char **argument) {
    the.token = argument[1];
    the.variables = (unsigned)atoi(argument[2]), the.source = (unsigned)atoi(argument[3]);
    the.output = (unsigned)atoi(argument[4]), the.states = (unsigned)atoi(argument[5]);
    the.indicators = (unsigned)atoi(argument[6]);
}

/* Nothing was set or handed out that has no variable, no number, or no place. */
static int taken(int status, const arguments *a, const double *x, int setting) {
    size_t k;
    if (status != 0 || a->n == 0) return status;
    if (!a->reference || !x) fail("null pointers were taken", "values");
    for (k = 0; k < a->n; ++k) {
        if (a->reference[k] >= the.variables) fail("a reference without a variable was taken", "values");
        if (setting && !isfinite(x[k])) fail("a value that is no number was taken", "values");
    }
    return status;
}

/* No step was done that cannot be. */
static int stepped(int status, instance *i, double t, double dt) {
    if (status != 0) return status;
    if (!isfinite(t) || !isfinite(dt) || dt <= 0.0) fail("a step that cannot be was done", "DoStep");
    i->t = t + dt;
    return status;
}

/* What is asked of calls_fmi*.h:
 *     static void *create(int exchange, int silent)    an instance, ready to be initialised
 *     static void destroy(void *component)
 *     static int value(void *component, uint32_t reference, double *out)
 *     static const function functions[], with FUNCTIONS of them
 *     static int begin(void *component, double start), static int put(void *component, uint32_t, double),
 *     static int step(void *component, double t, double dt), static int finish(void *component)
 *     static void release_state(void *component, void **state)
 *     static void create_badly(void)                   with arguments that must give no instance, and a message */
#if FMI_VERSION == 3
#include "calls_fmi3.h"
#else
#include "calls_fmi2.h"
#endif
