/* What a hostile FMU does: FAULT in the function AT, as the environment says. The including file defines say(). */

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))

static void say(const char *text);
static double clock_now;

static int fault(const char *here) {
    const char *at = getenv("AT"), *what = getenv("FAULT");
    if (what && !strcmp(what, "detach-farewell") && strstr(here, "FreeInstance")) pause();
    if (!at || !what || strcmp(at, here)) return 0;
    if (!strcmp(what, "exit")) exit(0);
    if (!strcmp(what, "exit7")) _exit(7);
    if (!strcmp(what, "crash")) *(volatile int *)8 = 1;
    if (!strcmp(what, "abort")) abort();
    if (!strcmp(what, "stop")) raise(SIGSTOP);
    if (!strcmp(what, "loop"))
        for (;;) clock_now += 1e-9;
    if (!strcmp(what, "error")) return 3;
    if (!strcmp(what, "fatal")) return 4;
    if (!strcmp(what, "discard")) return 2;
    if (!strcmp(what, "nonsense")) return 77;
    if (!strcmp(what, "chdir") && chdir("/")) return 3;
    if (!strcmp(what, "litter")) {
        FILE *file = fopen("litter.txt", "w");
        if (file) fclose(file);
    }
    if (!strcmp(what, "flood")) {
        int i;
        for (i = 0; i < 20000; ++i) {
            printf("a line that nobody asked for, and another, and one more, and so on without an end\n");
            fprintf(stderr, "the same on the other output, and another, and one more, and so on without an end\n");
        }
        fflush(stdout);
    }
    if (!strcmp(what, "talk")) {
        int i;
        for (i = 0; i < 20000; ++i) say("a message that nobody asked for");
    }
    if (!strcmp(what, "child") && fork() == 0) {
        for (;;) sleep(60);
    }
    if (!strncmp(what, "detach", 6)) { /* a process in a session of its own that holds all that is open */
        static int done;
        if (!done++ && fork() == 0) {
            setsid();
            if (fork() != 0) _exit(0);
            FILE *file = fopen(getenv("DETACHED"), "w");
            fprintf(file, "%d", (int)getpid());
            fclose(file);
            sleep(60);
            remove(getenv("DETACHED")); /* which says that it was waited for */
            _exit(0);
        }
        while (access(getenv("DETACHED"), R_OK) != 0) usleep(1000);
        if (!strcmp(what, "detach-crash")) *(volatile int *)8 = 1;
        if (!strcmp(what, "detach-stop")) raise(SIGSTOP);
    }
    if (!strcmp(what, "close")) {
        int i;
        for (i = 0; i < 64; ++i) close(i);
    }
    if (!strcmp(what, "write")) {
        int i;
        for (i = 3; i < 64; ++i)
            if (write(i, "nothing that anybody would understand, at all, ever", 51) < 0) continue;
    }
    return 0;
}

