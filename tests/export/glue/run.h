/* One orderly run of co-simulation, every status checked. Included behind calls.h. */

static void fine(int status, const char *which) {
    if (status != 0) fail("not carried out", which);
}

/* The output after so many steps of 1 ms under a force of this size; creates and frees its instance. */
static double run(int steps, double size) {
    instance i;
    double x = 0.0;
    int k;
    memset(&i, 0, sizeof i);
    i.component = create(0, 0);
    if (!i.component) fail("no instance", "create");
    fine(begin(i.component, 0.0), "initialization");
    fine(leave(&i, NULL), "the end of initialization");
    for (k = 0; k < steps; ++k) {
        fine(put(i.component, the.source, size * sin(0.08 * k)), "set");
        fine(step(i.component, 1e-3 * k, 1e-3), "step");
    }
    fine(value(i.component, the.output, &x), "get");
    fine(keep_state(i.component, &i.kept[0]), "keep"); /* a state is taken and given back in every run */
    release_state(i.component, &i.kept[0]);
    fine(finish(i.component), "terminate");
    destroy(i.component);
    return x;
}
