/* Instances made, run and freed, many times; prints by how many kilobytes the process grew from the first tenth on.
 *
 *     rounds TOKEN VARIABLES SOURCE OUTPUT STATES INDICATORS ROUNDS */
#include "all.c"

#include "calls.h"
#include "run.h"

#include <unistd.h>

/* Resident memory, kB (Linux). */
static long resident(void) {
    long whole = 0, pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file || fscanf(file, "%ld %ld", &whole, &pages) != 2) fail("cannot be read", "/proc/self/statm");
    fclose(file);
    return pages * (sysconf(_SC_PAGESIZE) / 1024);
}

int main(int count, char **argument) {
    long rounds, n, before = 0;
    double first = 0.0;
    if (count != 8) fail("seven arguments", "usage");
    describe(argument);
    rounds = atol(argument[7]);
    resident(); /* what reading takes itself is there from here on */
    for (n = 0; n < rounds; ++n) {
        const double x = run(5, 1.0);
        if (n == rounds / 10) before = resident();
        if (n == 0) first = x;
        if (x != first) fail("another answer", "run");
    }
    printf("%ld\n", resident() - before);
    return 0;
}
