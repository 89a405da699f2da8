/* A simulator in one file of plain C: loads the library of a co-simulation FMU (FMI 2.0 or 3.0) and runs it as a plan
 * says. Needs no header of the standard; what it calls is declared here as the standards have it.
 *
 *     host PLAN
 *
 * PLAN holds lines of a word and its value, the force last:
 *     library PATH, resources URI, version 2|3, token TEXT, step S, first 0|1 (hold), source REFERENCE,
 *     slope REFERENCE, output REFERENCE, set REFERENCE VALUE (any number of them), repeat COUNT, force N and N values
 * References that are not given are not used. Without `repeat` it prints the output at every sample, a line each; with
 * it the processor time of a step in nanoseconds (set, step, get), the whole force run that often. */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#ifdef _WIN32
#include <windows.h>
static void *load(const char *path) { return (void *)LoadLibraryA(path); }
static void *find(void *library, const char *name) { return (void *)(uintptr_t)GetProcAddress((HMODULE)library, name); }
#else
#include <dlfcn.h>
static void *load(const char *path) { return dlopen(path, RTLD_NOW | RTLD_LOCAL); }
static void *find(void *library, const char *name) { return dlsym(library, name); }
#endif

enum { MOST_SETS = 64 };

typedef struct {
    char library[1024], resources[1024], token[256];
    int version, first, sets, repeat;
    long source, slope, output, n;
    double step, value[MOST_SETS], *force;
    uint32_t reference[MOST_SETS];
} plan;

static void fail(const char *what, const char *which) {
    fprintf(stderr, "host: %s%s\n", what, which);
    exit(1);
}

static void check(int status, const char *what) {
    if (status > 1) fail(what, " was refused"); /* 0 ok, 1 warning in both versions */
}

/* The calls that matter, of either version ------------------------------------------------------------------------ */

typedef void *component;

typedef struct { /* fmi2CallbackFunctions */
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} callbacks2;

static component (*instantiate2)(const char *, int, const char *, const char *, const callbacks2 *, int, int);
static int (*setup2)(component, int, double, double, int, double);
static int (*enter2)(component);
static int (*set2)(component, const uint32_t *, size_t, const double *);
static int (*get2)(component, const uint32_t *, size_t, double *);
static int (*incline2)(component, const uint32_t *, size_t, const int *, const double *);
static int (*step2)(component, double, double, int);

static component (*instantiate3)(const char *, const char *, const char *, bool, bool, bool, bool, const uint32_t *,
                                 size_t, void *, void (*)(void *, int, const char *, const char *),
                                 void (*)(void *, double, bool, bool, bool, bool, bool *, double *));
static int (*enter3)(component, bool, double, double, bool, double);
static int (*set3)(component, const uint32_t *, size_t, const double *, size_t);
static int (*get3)(component, const uint32_t *, size_t, double *, size_t);
static int (*step3)(component, double, double, bool, bool *, bool *, bool *, double *);

static int (*leave_initialization)(component); /* these three are alike in both versions */
static int (*terminate)(component);
static void (*release)(component);

static void tell2(void *environment, const char *name, int status, const char *category, const char *text, ...) {
    (void)environment;
    fprintf(stderr, "%s: %d %s: %s\n", name, status, category, text);
}

static void tell3(void *environment, int status, const char *category, const char *text) {
    (void)environment;
    fprintf(stderr, "%d %s: %s\n", status, category, text);
}

static const callbacks2 calls2 = {tell2, calloc, free, NULL, NULL};

static void *look_up(void *library, int version, const char *name) {
    char full[80];
    void *found;
    snprintf(full, sizeof full, "fmi%d%s", version, name);
    found = find(library, full);
    if (!found) fail("the library lacks ", full);
    return found;
}

/* ISO C has no cast from an object pointer to a function's; both importers and POSIX rely on the copy. */
#define BIND(function, name) (*(void **)&(function) = look_up(library, p->version, name))

static void open_library(const plan *p) {
    void *library = load(p->library);
    if (!library) fail("cannot load ", p->library);
    BIND(leave_initialization, "ExitInitializationMode");
    BIND(terminate, "Terminate");
    BIND(release, "FreeInstance");
    if (p->version == 2) {
        BIND(instantiate2, "Instantiate");
        BIND(setup2, "SetupExperiment");
        BIND(enter2, "EnterInitializationMode");
        BIND(set2, "SetReal");
        BIND(get2, "GetReal");
        BIND(step2, "DoStep");
        if (p->first && p->slope < 0) BIND(incline2, "SetRealInputDerivatives");
    } else {
        BIND(instantiate3, "InstantiateCoSimulation");
        BIND(enter3, "EnterInitializationMode");
        BIND(set3, "SetFloat64");
        BIND(get3, "GetFloat64");
        BIND(step3, "DoStep");
    }
}

static component instantiate(const plan *p) {
    component c;
    if (p->version == 2)
        c = instantiate2("rig", 1, p->token, p->resources, &calls2, 0, 0);
    else
        c = instantiate3("rig", p->token, NULL, false, false, false, false, NULL, 0, NULL, tell3, NULL);
    if (!c) fail("no instance", "");
    return c;
}

static void set(const plan *p, component c, uint32_t reference, double value) {
    check(p->version == 2 ? set2(c, &reference, 1, &value) : set3(c, &reference, 1, &value, 1), "setting");
}

static double get(const plan *p, component c) {
    const uint32_t reference = (uint32_t)p->output;
    double value = 0.0;
    check(p->version == 2 ? get2(c, &reference, 1, &value) : get3(c, &reference, 1, &value, 1), "getting");
    return value;
}

static void step(const plan *p, component c, double t) {
    bool event, end, early;
    double reached;
    if (p->version == 2) {
        check(step2(c, t, p->step, 1), "the step");
    } else {
        check(step3(c, t, p->step, true, &event, &end, &early, &reached), "the step");
        if (end || early) fail("the step ended early", "");
    }
}

/* The run --------------------------------------------------------------------------------------------------------- */

/* Runs the whole force; writes the outputs where asked. */
static void run(const plan *p, double *x) {
    static const int order = 1;
    component c = instantiate(p);
    double last = 0.0;
    long k;
    int i;
    if (p->version == 2) {
        check(setup2(c, 0, 0.0, 0.0, 0, 0.0), "setting up");
        check(enter2(c), "initialization");
    } else {
        check(enter3(c, false, 0.0, 0.0, false, 0.0), "initialization");
    }
    for (i = 0; i < p->sets; ++i) set(p, c, p->reference[i], p->value[i]);
    if (p->source >= 0) set(p, c, (uint32_t)p->source, p->force[0]);
    check(leave_initialization(c), "the end of initialization");
    if (x) x[0] = get(p, c);
    for (k = 0; k + 1 < p->n; ++k) {
        if (p->source >= 0) set(p, c, (uint32_t)p->source, p->force[k]);
        if (p->first) {
            const double rate = (p->force[k + 1] - p->force[k]) / p->step;
            const uint32_t reference = (uint32_t)p->source;
            if (p->slope >= 0)
                set(p, c, (uint32_t)p->slope, rate);
            else
                check(incline2(c, &reference, 1, &order, &rate), "setting the slope");
        }
        step(p, c, (double)k * p->step);
        last = get(p, c);
        if (x) x[k + 1] = last;
    }
    check(terminate(c), "the end");
    release(c);
}

static void read_plan(const char *path, plan *p) {
    char word[32];
    long i;
    FILE *file = fopen(path, "r");
    if (!file) fail("cannot read ", path);
    memset(p, 0, sizeof *p);
    p->source = p->slope = p->output = -1;
    while (fscanf(file, "%31s", word) == 1) {
        int read = 0;
        if (!strcmp(word, "library")) read = fscanf(file, " %1023[^\n]", p->library);
        else if (!strcmp(word, "resources")) read = fscanf(file, " %1023[^\n]", p->resources);
        else if (!strcmp(word, "token")) read = fscanf(file, " %255[^\n]", p->token);
        else if (!strcmp(word, "version")) read = fscanf(file, "%d", &p->version);
        else if (!strcmp(word, "step")) read = fscanf(file, "%lf", &p->step);
        else if (!strcmp(word, "first")) read = fscanf(file, "%d", &p->first);
        else if (!strcmp(word, "source")) read = fscanf(file, "%ld", &p->source);
        else if (!strcmp(word, "slope")) read = fscanf(file, "%ld", &p->slope);
        else if (!strcmp(word, "output")) read = fscanf(file, "%ld", &p->output);
        else if (!strcmp(word, "repeat")) read = fscanf(file, "%d", &p->repeat);
        else if (!strcmp(word, "set") && p->sets < MOST_SETS)
            read = fscanf(file, "%u %lf", &p->reference[p->sets], &p->value[p->sets]) == 2, ++p->sets;
        else if (!strcmp(word, "force")) {
            read = fscanf(file, "%ld", &p->n);
            p->force = (double *)malloc(sizeof(double) * (size_t)(p->n > 0 ? p->n : 1));
            for (i = 0; read == 1 && p->force && i < p->n; ++i) read = fscanf(file, "%lf", &p->force[i]);
        }
        if (read != 1) fail("cannot understand the plan at ", word);
    }
    fclose(file);
    if (!p->force || p->n < 2 || p->output < 0) fail("the plan lacks a force or an output", "");
}

int main(int count, char **argument) {
    plan p;
    long k;
    if (count != 2) fail("usage: host PLAN", "");
    read_plan(argument[1], &p);
    open_library(&p);
    if (p.repeat > 0) {
        int i;
        clock_t began = clock();
        for (i = 0; i < p.repeat; ++i) run(&p, NULL);
        printf("%.3f\n", (double)(clock() - began) / CLOCKS_PER_SEC * 1e9 / ((double)p.repeat * (double)(p.n - 1)));
    } else {
        double *x = (double *)malloc(sizeof(double) * (size_t)p.n);
        if (!x) fail("out of memory", "");
        run(&p, x);
        for (k = 0; k < p.n; ++k) printf("%.17g\n", x[k]);
        free(x);
    }
    free(p.force);
    fflush(stdout);
    if (p.repeat > 0) _Exit(0); /* what PythonFMU's library leaves behind aborts at an ordinary end */
    return 0;
}
