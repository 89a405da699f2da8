/* Integration of the virtual rig: Dormand and Prince's pair of orders 5 and 4 (1980), with every event located.

   Within a step the modes are frozen, so that the equations are smooth; a step over which a surface changes its side
   is cut at the earliest such crossing, where the mode changes. A step also ends on every sample, so nothing is
   interpolated. */
#include "rig.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FINE, DIVERGED, TOO_MANY_STEPS, NO_MEMORY };

static const double ORIGIN_SIZE = 3e-8; /* bouncing about x = 0 below this part of the amplitude counts as rest */

typedef struct {
    Rig *rig;
    double t, h, longest, tolerance;
    double y[MOST_STATES], dy[MOST_STATES];
    long steps, events;
} Walk;

/* One step of length h from the walk's state: state and derivative at its end; returns the error over its tolerance. */
static double advance(const Walk *walk, double h, double *end, double *slope)
{
    static const double nodes[6] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0};
    static const double a[6][5] = {
        {0.0},
        {1.0 / 5},
        {3.0 / 40, 9.0 / 40},
        {44.0 / 45, -56.0 / 15, 32.0 / 9},
        {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
        {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    };
    static const double b[6] = {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84};
    static const double e[7] = {71.0 / 57600,      0.0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525,
                                -1.0 / 40};
    const Rig *rig = walk->rig;
    const int n = rig->states;
    double k[7][MOST_STATES], worst = 0.0;
    memcpy(k[0], walk->dy, sizeof k[0]);
    for (int stage = 1; stage < 6; stage++) {
        for (int i = 0; i < n; i++) {
            double sum = 0.0;
            for (int j = 0; j < stage; j++) {
                sum += a[stage][j] * k[j][i];
            }
            end[i] = walk->y[i] + h * sum;
        }
        rig_derivative(rig, walk->t + nodes[stage] * h, end, k[stage]);
    }
    for (int i = 0; i < n; i++) {
        double sum = 0.0;
        for (int j = 0; j < 6; j++) {
            sum += b[j] * k[j][i];
        }
        end[i] = walk->y[i] + h * sum;
    }
    rig_derivative(rig, walk->t + h, end, k[6]);
    for (int i = 0; i < n; i++) {
        double sum = 0.0;
        for (int j = 0; j < 7; j++) {
            sum += e[j] * k[j][i];
        }
        worst = fmax(worst, fabs(h * sum) / rig->scale[i]);
        slope[i] = k[6][i];
    }
    return worst / walk->tolerance;
}

static double side(const Rig *rig, int surface, double t, const double *y)
{
    return rig->sign[surface] * rig_surface(rig, surface, t, y);
}

/* Length of the step that ends where a surface changes its side, within (0, h]: regula falsi in Illinois form. */
static double locate(const Walk *walk, int surface, double h)
{
    double y[MOST_STATES], dy[MOST_STATES];
    double low = 0.0, high = h, above = side(walk->rig, surface, walk->t, walk->y), below;
    int last = 0;
    advance(walk, h, y, dy);
    below = side(walk->rig, surface, walk->t + h, y);
    for (double probe = 0.5 * h; above <= 0.0 && probe > 1e-9 * h; probe *= 0.5) { /* it starts on the surface */
        advance(walk, probe, y, dy);
        low = probe;
        above = side(walk->rig, surface, walk->t + probe, y);
    }
    if (above <= 0.0) {
        return 0.0;
    }
    const double enough = 1e-15 * (above - below);
    for (int i = 0; i < 60 && high - low > 1e-13 * h; i++) {
        const double middle = low + (high - low) * above / (above - below);
        advance(walk, middle, y, dy);
        const double value = side(walk->rig, surface, walk->t + middle, y);
        if (value > 0.0) {
            low = middle;
            above = value;
            below *= last == 1 ? 0.5 : 1.0;
            last = 1;
        } else {
            high = middle;
            below = value;
            above *= last == -1 ? 0.5 : 1.0;
            last = -1;
        }
        if (fabs(value) <= enough) {
            return middle;
        }
    }
    return high;
}

/* Earliest crossing within the step of length h to `end`, or h; `surface` is -1 where there is none. */
static double earliest(const Walk *walk, double h, const double *end, int *surface)
{
    double first = h;
    *surface = -1;
    for (int i = 0; i < SURFACES; i++) {
        if (rig_active(walk->rig, i) && side(walk->rig, i, walk->t + h, end) < 0.0) {
            const double at = locate(walk, i, h);
            if (*surface < 0 || at < first) {
                first = at;
                *surface = i;
            }
        }
    }
    return first;
}

/* Part of the step at which a surface seems to be crossed and crossed back, or 1: parabola through three points. */
static double hidden(const Walk *walk, double h, const double *end, const double *slope)
{
    double middle[MOST_STATES], part = 1.0;
    for (int i = 0; i < walk->rig->states; i++) {
        middle[i] = 0.5 * (walk->y[i] + end[i]) + 0.125 * h * (walk->dy[i] - slope[i]);
    }
    for (int i = 0; i < SURFACES; i++) {
        if (rig_active(walk->rig, i)) {
            const double g0 = side(walk->rig, i, walk->t, walk->y), g2 = side(walk->rig, i, walk->t + h, end);
            const double g1 = side(walk->rig, i, walk->t + 0.5 * h, middle);
            const double bend = 2.0 * (g0 - 2.0 * g1 + g2), rise = 4.0 * g1 - 3.0 * g0 - g2;
            const double at = bend > 0.0 ? -0.5 * rise / bend : 2.0;
            if (g0 > 0.0 && at > 0.0 && at < part && g0 - 0.25 * rise * rise / bend < 0.0) {
                part = at;
            }
        }
    }
    return part;
}

/* The rig has come to a halt: does friction, or the preload at x = 0, hold it? Otherwise which way does it leave? */
static void halt(Walk *walk)
{
    Rig *rig = walk->rig;
    const double preload = rig->p.preload;
    double up, down, inertia, net;
    walk->y[1] = 0.0;
    rig->sliding = 0;
    rig->stuck = 1;
    rig_limits(rig, walk->t, &up, &down);
    rig->held = preload > 0.0 && fabs(walk->y[0]) < ORIGIN_SIZE * rig->p.amplitude;
    net = rig_net(rig, walk->t, walk->y, &inertia);
    if (rig->held) {
        if (net <= up + preload && -net <= down + preload) {
            walk->y[0] = 0.0;
            return;
        }
        rig->held = 0;
        net = rig_net(rig, walk->t, walk->y, &inertia);
    }
    if (up + down > 0.0 && net <= up && -net <= down) {
        return;
    }
    rig->stuck = 0;
    rig->sign[SPEED] = net > up ? 1 : net < -down ? -1 : -rig->sign[SPEED];
}

static void cross(Walk *walk, int surface)
{
    Rig *rig = walk->rig;
    walk->events++;
    switch (surface) {
    case SPEED:
        halt(walk);
        break;
    case BREAK_UP: case BREAK_DOWN:
        rig->stuck = 0;
        rig->sign[SPEED] = surface == BREAK_UP ? 1 : -1;
        if (rig->held) {
            rig->held = 0;
            rig->sign[ORIGIN] = rig->sign[SPEED];
        }
        break;
    case PLASTIC_UP: case PLASTIC_DOWN:
        rig->sliding = surface == PLASTIC_UP ? 1 : -1;
        walk->y[rig->plastic] = rig->sliding * rig->p.jenkins_reach;
        break;
    default:
        rig->sign[surface] = -rig->sign[surface];
    }
    rig_derivative(rig, walk->t, walk->y, walk->dy);
}

/* Carry the walk on to time `until`. */
static int carry(Walk *walk, double until)
{
    double end[MOST_STATES], slope[MOST_STATES];
    int at_once = 0;
    while (walk->t < until) {
        const double left = until - walk->t;
        double h = fmin(fmin(walk->h, walk->longest), left), error, part;
        int surface, last = h >= left * (1.0 - 1e-12);
        h = last ? left : h;
        if (++walk->steps > 200000000L) {
            return TOO_MANY_STEPS;
        }
        error = advance(walk, h, end, slope);
        if (!(error < 1e300)) {
            return DIVERGED;
        }
        if (error > 1.0) {
            walk->h = h * fmax(0.2, 0.9 * pow(error, -0.2));
            continue;
        }
        double crossing = earliest(walk, h, end, &surface);
        if (surface < 0 && (part = hidden(walk, h, end, slope)) < 1.0 && h * part > 1e-9 * walk->longest) {
            h *= part;
            last = 0;
            advance(walk, h, end, slope);
            crossing = earliest(walk, h, end, &surface);
        }
        if (surface >= 0 && !(crossing <= 0.0 && at_once > SURFACES)) {
            at_once = crossing > 0.0 ? 0 : at_once + 1;
            if (crossing > 0.0) {
                advance(walk, crossing, end, slope);
                memcpy(walk->y, end, sizeof end);
                walk->t = crossing < left ? walk->t + crossing : until;
            }
            cross(walk, surface);
        } else {
            at_once = 0;
            memcpy(walk->y, end, sizeof end);
            memcpy(walk->dy, slope, sizeof slope);
            walk->t = last ? until : walk->t + h;
            if (h >= 0.5 * fmin(walk->h, walk->longest)) { /* a step cut for a sample says little of the next */
                walk->h = h * fmin(4.0, 0.9 * pow(fmax(error, 1e-9), -0.2));
            }
        }
        if (!(fabs(walk->y[0]) < 1e3 * walk->rig->p.amplitude)) {
            return DIVERGED;
        }
    }
    return FINE;
}

static void begin(Walk *walk, double x0)
{
    Rig *rig = walk->rig;
    rig_layout(rig, x0, walk->y);
    for (int i = 0; i < SURFACES; i++) {
        rig->sign[i] = 1;
    }
    rig->stuck = rig->held = 0;
    for (int i = 0; i < SURFACES; i++) {
        rig->sign[i] = rig_surface(rig, i, 0.0, walk->y) >= 0.0 ? 1 : -1;
    }
    rig->sign[BREAK_UP] = rig->sign[BREAK_DOWN] = rig->sign[PLASTIC_UP] = rig->sign[PLASTIC_DOWN] = -1; /* inside */
    for (int i = STOP_UP; i <= STOP_DOWN; i += 2) { /* without a damper only the gap decides */
        rig->sign[i + 1] = rig_active(rig, i + 1) ? rig->sign[i + 1] : 1;
    }
    rig->sign[SPEED] = x0 > 0.0 ? -1 : 1;
    halt(walk);
    rig_derivative(rig, walk->t, walk->y, walk->dy);
}

/* Simulate one recording.

   parameters: as in PARAMETERS. drive: kind, peak N, start Hz, end Hz, length s, ramp s. lines: (count, 3) frequency
   Hz, amplitude, phase rad; of straight lines (count, 2) force and its rise; of hits (count, 3) beginning s, part of the peak, duration s.
   rest: (samples, 2) N and its rise over a sample interval, on the mass and not recorded, or none.
   The rig rests at x0 m until t = 0. Samples are taken at i/fs s. Outputs, (samples) each:
   force N as commanded, displacement m of the mass, and what its sensor shows; counted: steps and events. Returns 0,
   or why not. */
int concealed_run(const double *parameters, const double *drive, const double *lines, int count, const double *rest,
                  double x0, double fs, int samples, double tolerance, double longest, double *force, double *x, double *shown, long *counted)
{
    Rig rig;
    Walk walk;
    int status = FINE;
    memset(&rig, 0, sizeof rig);
    memset(&walk, 0, sizeof walk);
    memcpy(&rig.p, parameters, sizeof rig.p);
    rig.drive.kind = (int)drive[0];
    rig.drive.peak = drive[1];
    rig.drive.start = drive[2];
    rig.drive.end = drive[3];
    rig.drive.length = drive[4];
    rig.drive.ramp = drive[5];
    rig.drive.hits = lines;
    rig.drive.count = count;
    rig.drive.rest = rest;
    rig.drive.rests = samples;
    rig.drive.rest_interval = 1.0 / fs;
    if (rig.drive.kind == 3 || rig.drive.kind == 4) {
        rig.drive.interval = 1.0 / fs;
        rig.drive.pieces = samples;
        rig.drive.taylor = calloc(TAYLOR * (size_t)samples, sizeof(double));
        if (!rig.drive.taylor) {
            return NO_MEMORY;
        }
        (rig.drive.kind == 3 ? drive_pieces : drive_straight)(&rig.drive, lines, count);
    }
    walk.rig = &rig;
    walk.tolerance = tolerance;
    walk.longest = walk.h = longest;
    begin(&walk, x0);
    for (int i = 0; i < samples && !status; i++) {
        const double t = i / fs * (1.0 + rig.p.sensor_clock) - rig.p.output_delay;
        status = carry(&walk, t);
        force[i] = drive_force(&rig.drive, i / fs);
        x[i] = walk.y[0];
        shown[i] = rig_sensor(&rig, t, walk.y);
    }
    counted[0] = walk.steps;
    counted[1] = walk.events;
    free(rig.drive.taylor);
    return status;
}

#define TEXT(name) #name " "
const char *concealed_parameters(void)
{
    return PARAMETERS(TEXT);
}
