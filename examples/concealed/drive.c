/* The driving force as a smooth function of time, evaluated where the integrator asks for it. */
#include "rig.h"

#include <math.h>

static const double TWO_PI = 6.283185307179586476925287;

/* Blows of a hammer, each a sin^2. */
static double hits_force(const Drive *drive, double t)
{
    double value = 0.0;
    for (int i = 0; i < drive->count; i++) {
        const double *hit = drive->hits + 3 * i;
        const double part = (t - hit[0]) / hit[2];
        if (part > 0.0 && part < 1.0) {
            const double s = sin(0.5 * TWO_PI * part);
            value += hit[1] * s * s;
        }
    }
    return drive->peak * value;
}

double drive_force(const Drive *drive, double t)
{
    double rise = 1.0, value;
    if (drive->kind == 0 || t < 0.0) {
        return 0.0;
    }
    if (drive->kind == 5) {
        return hits_force(drive, t);
    }
    if (t < drive->ramp) {
        const double s = sin(0.25 * TWO_PI * t / drive->ramp);
        rise = s * s;
    }
    if (drive->kind == 1) {
        const double slope = (drive->end - drive->start) / drive->length;
        value = sin(TWO_PI * (drive->start + 0.5 * slope * t) * t);
    } else if (drive->kind == 2) {
        const double growth = log(drive->end / drive->start) / drive->length;
        value = sin(TWO_PI * drive->start * expm1(growth * t) / growth);
    } else {
        int piece = (int)(t / drive->interval);
        const double *c;
        double s;
        piece = piece < drive->pieces ? piece : drive->pieces - 1;
        c = drive->taylor + piece * TAYLOR;
        s = t - (piece + 0.5) * drive->interval;
        value = c[TAYLOR - 1];
        for (int k = TAYLOR - 2; k >= 0; k--) {
            value = value * s + c[k];
        }
    }
    return drive->peak * rise * value;
}

/* The force that is not recorded, N: straight lines between samples. */
double drive_rest(const Drive *drive, double t)
{
    if (!drive->rest || t < 0.0) {
        return 0.0;
    }
    const int last = drive->rests - 1, piece = (int)(t / drive->rest_interval);
    const double *line = drive->rest + 2 * (piece < last ? piece : last);
    const double part = t / drive->rest_interval - (piece < last ? piece : last);
    return line[0] + line[1] * part;
}

/* Taylor coefficients of the sum of amplitude sin(2 pi f t + phase); lines holds f, amplitude, phase of each.
   With 25 samples a cycle of the highest line the remainder is (pi/25)^10/10! = 3e-16. */
void drive_pieces(Drive *drive, const double *lines, int count)
{
    for (int piece = 0; piece < drive->pieces; piece++) {
        double *c = drive->taylor + piece * TAYLOR;
        const double middle = (piece + 0.5) * drive->interval;
        for (int k = 0; k < TAYLOR; k++) {
            c[k] = 0.0;
        }
        for (int i = 0; i < count; i++) {
            const double omega = TWO_PI * lines[3 * i];
            const double phase = omega * middle + lines[3 * i + 2];
            double sine = lines[3 * i + 1] * sin(phase), cosine = lines[3 * i + 1] * cos(phase);
            for (int k = 0; k < TAYLOR; k++) {
                const double next = cosine * omega / (k + 1);
                c[k] += sine;
                cosine = -sine * omega / (k + 1);
                sine = next;
            }
        }
    }
}

/* Straight lines between samples; lines holds the force at the beginning of each interval and its rise over it. */
void drive_straight(Drive *drive, const double *lines, int count)
{
    for (int piece = 0; piece < drive->pieces && piece < count; piece++) {
        double *c = drive->taylor + piece * TAYLOR;
        c[0] = lines[2 * piece] + 0.5 * lines[2 * piece + 1];
        c[1] = lines[2 * piece + 1] / drive->interval;
    }
}
