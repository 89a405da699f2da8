/* Which states a rig has, how they start, and the surfaces in its state space where its equations change. */
#include "rig.h"

#include <math.h>

static int take(Rig *rig, int used, double scale)
{
    if (!used) {
        return 0;
    }
    rig->scale[rig->states] = scale;
    return rig->states++;
}

static int take_body(Rig *rig, int used, double scale)
{
    const int first = take(rig, used, scale);
    take(rig, used, scale * rig->p.omega);
    return first;
}

/* Bouc-Wen's z after a slow pull from 0 to x0: dz/dx on the virgin curve, by the classical Runge-Kutta rule. */
static double virgin(const Parameters *p, double x0)
{
    enum { STEPS = 2000 };
    const double h = fabs(x0) / STEPS, loss = p->bouc_beta + p->bouc_gamma;
    double z = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double a = 1.0 - loss * pow(z, p->bouc_power);
        const double b = 1.0 - loss * pow(z + 0.5 * h * a, p->bouc_power);
        const double c = 1.0 - loss * pow(z + 0.5 * h * b, p->bouc_power);
        const double d = 1.0 - loss * pow(z + h * c, p->bouc_power);
        z += h * (a + 2.0 * b + 2.0 * c + d) / 6.0;
    }
    return copysign(z, x0);
}

/* Give the rig its states, at rest at x0 after a slow pull, and its first modes. */
void rig_layout(Rig *rig, double x0, double *y)
{
    const Parameters *p = &rig->p;
    const double size = p->amplitude;
    rig->states = 2;
    rig->scale[0] = size;
    rig->scale[1] = size * p->omega;
    const double yields = p->bouc_stiffness != 0.0 ? pow(p->bouc_beta + p->bouc_gamma, -1.0 / p->bouc_power) : size;
    rig->bouc = take(rig, p->bouc_stiffness != 0.0, fmin(size, yields));
    rig->dahl = take(rig, p->dahl_stiffness != 0.0, fmin(size, p->dahl_reach));
    rig->plastic = take(rig, p->jenkins_stiffness != 0.0 || p->sensor_play > 0.0, fmin(size, p->jenkins_reach));
    for (int i = 0; i < MAXWELLS; i++) {
        const double stiffness = rig_branch(p, i)[0];
        rig->maxwell[i] = take(rig, stiffness != 0.0, stiffness * size);
    }
    rig->resonator = take_body(rig, p->resonator_mass > 0.0, size);
    rig->lag = take(rig, p->actuator_lag > 0.0, p->force);
    rig->coil = take_body(rig, p->coil_mass > 0.0, size);
    rig->sensor = take(rig, p->sensor_lag > 0.0, size);
    rig->pendulum = take_body(rig, p->pendulum_mass > 0.0, size / p->pendulum_length);
    rig->loose = take_body(rig, p->loose_mass > 0.0, size);
    rig->second = take_body(rig, p->second_coupling != 0.0, size);
    rig->mean = take(rig, p->switched_damping != 0.0, size * size);
    take(rig, rig->mean, size * size * p->omega * p->omega);
    for (int i = 0; i < rig->states; i++) {
        y[i] = 0.0;
    }
    y[0] = x0;
    if (rig->bouc) {
        y[rig->bouc] = virgin(p, x0);
    }
    if (rig->dahl) {
        y[rig->dahl] = copysign(-p->dahl_reach * expm1(-fabs(x0) / p->dahl_reach), x0);
    }
    rig->sliding = 0;
    if (rig->plastic) {
        y[rig->plastic] = copysign(fmin(fabs(x0), p->jenkins_reach), x0);
    }
    y[rig->resonator] = x0; /* index 0, the rig itself, where there is none */
    y[rig->coil] = x0;
    y[rig->sensor] = x0;
    y[rig->loose] = x0;
    if (rig->second) { /* in static balance with the rig */
        y[rig->second] = -p->second_coupling * x0 * x0 / (p->second_omega * p->second_omega);
    }
    if (rig->mean) {
        y[rig->mean] = x0 * x0;
    }
}

static int rubs(const Parameters *p)
{
    return p->dry != 0.0 || p->stribeck_excess != 0.0 || p->direction_dry != 0.0 || p->friction_gain != 0.0;
}

/* Whether a surface matters in the present mode. */
int rig_active(const Rig *rig, int surface)
{
    const Parameters *p = &rig->p;
    switch (surface) {
    case SPEED:
        return !rig->stuck && (rubs(p) || p->preload != 0.0 || p->drag != 0.0 || p->direction_viscous != 0.0
                               || rig->bouc || rig->dahl || rig->plastic);
    case ORIGIN: return p->preload != 0.0 && !rig->stuck;
    case BREAK_UP: case BREAK_DOWN: return rig->stuck;
    case LOOP: return rig->bouc != 0;
    case PLASTIC_UP: case PLASTIC_DOWN: return rig->plastic && !rig->sliding;
    case CLEARANCE_UP: case CLEARANCE_DOWN: return p->clearance_stiffness > 0.0;
    case STOP_UP: return p->up_stiffness > 0.0;
    case STOP_UP_FORCE: return p->up_damping > 0.0;
    case STOP_DOWN: return p->down_stiffness > 0.0;
    case STOP_DOWN_FORCE: return p->down_damping > 0.0;
    case COIL_UP: case COIL_UP_FORCE: case COIL_DOWN: case COIL_DOWN_FORCE: return rig->coil != 0;
    case LOOSE_UP: case LOOSE_UP_FORCE: case LOOSE_DOWN: case LOOSE_DOWN_FORCE: return rig->loose != 0;
    case DEAD_UP: case DEAD_DOWN: return p->dead_zone > 0.0;
    case LIMIT_UP: case LIMIT_DOWN: return p->hard_limit > 0.0;
    case VALVE_UP: case VALVE_DOWN: return p->valve_damping > 0.0;
    default: return 0;
    }
}

static double balance(const Rig *rig, int surface, double t, const double *y)
{
    double up, down, inertia;
    const double net = rig_net(rig, t, y, &inertia), hold = rig->held ? rig->p.preload : 0.0;
    rig_limits(rig, t, &up, &down);
    return surface == BREAK_UP ? net - up - hold : -net - down - hold;
}

static double gap(int surface, int first, double room, double stiffness, double damping, double lead, double speed)
{
    switch (surface - first) {
    case 0: return lead - room;
    case 1: return stiffness * (lead - room) + damping * speed;
    case 2: return -lead - room;
    default: return stiffness * (-lead - room) - damping * speed;
    }
}

/* The surface's function; its mode is the sign. */
double rig_surface(const Rig *rig, int surface, double t, const double *y)
{
    const Parameters *p = &rig->p;
    const double x = y[0], v = y[1];
    switch (surface) {
    case SPEED: return v;
    case ORIGIN: return x;
    case BREAK_UP: case BREAK_DOWN: return balance(rig, surface, t, y);
    case LOOP: return y[rig->bouc];
    case PLASTIC_UP: return y[rig->plastic] - p->jenkins_reach;
    case PLASTIC_DOWN: return -y[rig->plastic] - p->jenkins_reach;
    case CLEARANCE_UP: return x - p->clearance_gap;
    case CLEARANCE_DOWN: return -x - p->clearance_gap;
    case STOP_UP: return x - p->up_at;
    case STOP_UP_FORCE: return p->up_stiffness * (x - p->up_at) + p->up_damping * v;
    case STOP_DOWN: return -x - p->down_at;
    case STOP_DOWN_FORCE: return p->down_stiffness * (-x - p->down_at) - p->down_damping * v;
    case COIL_UP: case COIL_UP_FORCE: case COIL_DOWN: case COIL_DOWN_FORCE:
        return gap(surface, COIL_UP, p->coil_gap, p->coil_stiffness, p->coil_damping, y[rig->coil] - x,
                   y[rig->coil + 1] - v);
    case LOOSE_UP: case LOOSE_UP_FORCE: case LOOSE_DOWN: case LOOSE_DOWN_FORCE:
        return gap(surface, LOOSE_UP, p->loose_gap, p->loose_stiffness, p->loose_damping, y[rig->loose] - x,
                   y[rig->loose + 1] - v);
    case DEAD_UP: return drive_force(&rig->drive, t - p->input_delay) - p->dead_zone;
    case DEAD_DOWN: return -drive_force(&rig->drive, t - p->input_delay) - p->dead_zone;
    case LIMIT_UP: return drive_force(&rig->drive, t - p->input_delay) - p->hard_limit - p->dead_zone;
    case LIMIT_DOWN: return -drive_force(&rig->drive, t - p->input_delay) - p->hard_limit - p->dead_zone;
    case VALVE_UP: return v - p->valve_speed;
    case VALVE_DOWN: return -v - p->valve_speed;
    default: return 1.0;
    }
}
