/* Instances in threads of their own, all at once: each must give what it gives alone, to the last bit.
 *
 *     threads TOKEN VARIABLES SOURCE OUTPUT STATES INDICATORS STEPS */
#include "all.c"

#include "calls.h"
#include "run.h"

#include <pthread.h>

enum { THREADS = 8 };

typedef struct {
    int steps;
    double size, x;
} job;

static void *work(void *argument) {
    job *const j = (job *)argument;
    j->x = run(j->steps, j->size);
    return NULL;
}

int main(int count, char **argument) {
    pthread_t thread[THREADS];
    job jobs[THREADS];
    int k;
    if (count != 8) fail("seven arguments", "usage");
    describe(argument);
    for (k = 0; k < THREADS; ++k) {
        jobs[k].steps = atoi(argument[7]), jobs[k].size = 0.5 + k, jobs[k].x = 0.0;
        if (pthread_create(&thread[k], NULL, work, &jobs[k])) fail("no thread", "pthread_create");
    }
    for (k = 0; k < THREADS; ++k) pthread_join(thread[k], NULL);
    for (k = 0; k < THREADS; ++k) {
        if (run(jobs[k].steps, jobs[k].size) != jobs[k].x) fail("another answer than alone", "thread");
        if (k && jobs[k].x == jobs[0].x) fail("two forces, one answer", "thread"); /* then nothing was compared */
    }
    return 0;
}
