/* The physics of the virtual rig: forces per unit mass, extra states, and the surfaces where the equations change. */
#include "rig.h"

#include <math.h>
#include <stddef.h>

static const double FLOOR = 1e-12; /* relative size below which a denominator counts as zero */

const double *rig_branch(const Parameters *p, int i)
{
    return (const double *)(const void *)((const char *)p + offsetof(Parameters, maxwell_1)) + 2 * i;
}

static double contact(double stiffness, double damping, double depth, double speed)
{
    return stiffness * depth + damping * speed;
}

/* Force on the rig from a stop or from a body in contact: both the gap must be closed and the contact must press. */
static double pressed(const Rig *rig, int surface, double force)
{
    return rig->sign[surface] > 0 && rig->sign[surface + 1] > 0 ? force : 0.0;
}

/* Body with play: force that it exerts on the rig (Kelvin-Voigt contacts that never pull, one each way). */
static double pushed(const Rig *rig, int surface, double gap, double stiffness, double damping, double lead,
                     double speed)
{
    return pressed(rig, surface, contact(stiffness, damping, lead - gap, speed))
         - pressed(rig, surface + 2, contact(stiffness, damping, -lead - gap, -speed));
}

/* Recorded force to what the actuator passes on, per unit mass: dead zone, then saturation. */
static double commanded(const Rig *rig, double t)
{
    const Parameters *p = &rig->p;
    double force = drive_force(&rig->drive, t - p->input_delay);
    if (p->dead_zone > 0.0) {
        force = rig->sign[DEAD_UP] > 0 ? force - p->dead_zone : rig->sign[DEAD_DOWN] > 0 ? force + p->dead_zone : 0.0;
    }
    if (p->hard_limit > 0.0) {
        force = rig->sign[LIMIT_UP] > 0 ? p->hard_limit : rig->sign[LIMIT_DOWN] > 0 ? -p->hard_limit : force;
    }
    if (p->smooth_limit > 0.0) {
        force = p->smooth_limit * tanh(force / p->smooth_limit);
    }
    return force / p->mass;
}

/* The force per unit mass that reaches the mass or the coil: behind the lag, a part of it grows with its square. */
static double arrived(const Rig *rig, double t, const double *y)
{
    const Parameters *p = &rig->p;
    const double force = rig->lag ? y[rig->lag] : commanded(rig, t);
    if (p->quadratic_part == 0.0) {
        return force;
    }
    return force + p->quadratic_part * (fabs(force) * p->mass / p->quadratic_level - 1.0) * force;
}

/* One bend of a shape that nobody wrote, smooth everywhere. */
static double bend(int kind, double u)
{
    const double size = fabs(u);
    switch (kind) {
    case 1: return atan(u);
    case 2: return exp(-u * u);
    case 3: return size + log1p(exp(-2.0 * size)); /* log cosh, but for log 2 */
    case 4: return asinh(u);
    case 5: return erf(u);
    case 6: return cos(u);
    default: return 0.0;
    }
}

/* The sum of the bends at q, none at q = 0. */
static double unwritten(const Parameters *p, double q)
{
    const double *bends = (const double *)(const void *)((const char *)p + offsetof(Parameters, bend_1));
    double sum = 0.0;
    for (int i = 0; i < BENDS; i++, bends += 4) {
        if (bends[0] != 0.0) {
            sum += bends[1] * (bend((int)bends[0], (q - bends[2]) / bends[3]) - bend((int)bends[0], -bends[2] / bends[3]));
        }
    }
    return sum;
}

static double spring(const Rig *rig, double t, const double *y)
{
    const Parameters *p = &rig->p;
    const double x = y[0], v = y[1];
    double factor = 1.0 + p->drift_rate * t, force;
    if (p->drift_gain != 0.0) {
        factor -= p->drift_gain * expm1(-t / p->drift_time);
    }
    if (p->modulation != 0.0) {
        factor += p->modulation * cos(p->modulation_omega * t + p->modulation_phase);
    }
    force = x * (p->omega2 * factor + x * (p->quadratic + x * (p->cubic + p->quintic * x * x)));
    force += p->speed_stiffness * x * v * v + p->static_load;
    if (p->tanh_stiffness != 0.0) {
        force += p->tanh_stiffness * p->tanh_length * tanh(x / p->tanh_length);
    }
    if (p->sine_stiffness != 0.0) {
        force += p->sine_stiffness * p->sine_length * sin(x / p->sine_length);
    }
    if (p->clearance_stiffness > 0.0) {
        force += rig->sign[CLEARANCE_UP] > 0 ? p->clearance_stiffness * (x - p->clearance_gap) : 0.0;
        force += rig->sign[CLEARANCE_DOWN] > 0 ? p->clearance_stiffness * (x + p->clearance_gap) : 0.0;
    }
    force += pressed(rig, STOP_UP, contact(p->up_stiffness, p->up_damping, x - p->up_at, v));
    force -= pressed(rig, STOP_DOWN, contact(p->down_stiffness, p->down_damping, -x - p->down_at, -v));
    force += p->unwritten_over == 1.0 ? unwritten(p, x) : 0.0;
    return force;
}

static double damping(const Rig *rig, double t, const double *y)
{
    const Parameters *p = &rig->p;
    const double x = y[0], v = y[1];
    const double speed = rig->stuck ? 0.0 : rig->sign[SPEED] * v;
    double force = v * (p->viscous * (1.0 + p->damping_rate * t) + p->x2_damping * x * x + p->cubic_damping * v * v);
    force += p->drag * v * speed + p->direction_viscous * speed;
    if (p->unwritten_over > 1.0) {
        force += p->unwritten_over == 2.0 ? unwritten(p, v) : unwritten(p, x) * v;
    }
    if (p->valve_damping > 0.0) {
        force += rig->sign[VALVE_UP] > 0 ? p->valve_damping * (v - p->valve_speed) : 0.0;
        force += rig->sign[VALVE_DOWN] > 0 ? p->valve_damping * (v + p->valve_speed) : 0.0;
    }
    if (rig->mean) {
        const double square = fmax(y[rig->mean], 0.0) + FLOOR * p->amplitude * p->amplitude;
        const double omega = sqrt(fmax(y[rig->mean + 1], 0.0) / square);
        force += 0.5 * p->switched_damping * (1.0 + tanh((omega - p->switch_omega) / p->switch_width)) * v;
    }
    return force;
}

static double memory(const Rig *rig, const double *y)
{
    const Parameters *p = &rig->p;
    double force = 0.0;
    force += rig->bouc ? p->bouc_stiffness * y[rig->bouc] : 0.0;
    force += rig->dahl ? p->dahl_stiffness * y[rig->dahl] : 0.0;
    force += rig->plastic ? p->jenkins_stiffness * y[rig->plastic] : 0.0;
    for (int i = 0; i < MAXWELLS; i++) {
        force += rig->maxwell[i] ? y[rig->maxwell[i]] : 0.0;
    }
    return force;
}

/* A hand that grasps the rig within a quarter of a cycle: a spring to where it is and a damper. */
static double hand(const Parameters *p, double t, double x, double v)
{
    const double part = (t - p->hand_at) * p->omega / 1.5707963267948966;
    if (p->hand_damping == 0.0 || part <= 0.0) {
        return 0.0;
    }
    return (part < 1.0 ? part * part * (3.0 - 2.0 * part) : 1.0)
         * (p->hand_damping * v + p->hand_stiffness * (x - p->hand_place));
}

/* Force per unit mass on the rig without dry friction, and the inertia that it moves, relative to the mass. */
double rig_net(const Rig *rig, double t, const double *y, double *effective_mass)
{
    const Parameters *p = &rig->p;
    const double x = y[0], v = y[1];
    double force = arrived(rig, t, y), inertia = 1.0;
    force *= 1.0 - p->force_factor * x * x;
    if (rig->coil) {
        const double lead = y[rig->coil] - x, speed = y[rig->coil + 1] - v;
        force = pushed(rig, COIL_UP, p->coil_gap, p->coil_stiffness, p->coil_damping, lead, speed);
        inertia -= p->coil_mass;
    }
    if (p->tone != 0.0) {
        force += p->tone * sin(p->tone_omega * t + p->tone_phase);
    }
    force += drive_rest(&rig->drive, t) / p->mass;
    force -= spring(rig, t, y) + damping(rig, t, y) + memory(rig, y) + hand(p, t, x, v);
    if (p->preload != 0.0 && !rig->held) {
        force -= p->preload * rig->sign[ORIGIN];
    }
    if (rig->resonator) {
        const double *r = y + rig->resonator;
        force += p->resonator_mass * p->resonator_omega
               * (p->resonator_omega * (r[0] - x) + 2.0 * p->resonator_zeta * (r[1] - v));
    }
    if (rig->loose) {
        const double lead = y[rig->loose] - x, speed = y[rig->loose + 1] - v;
        force += pushed(rig, LOOSE_UP, p->loose_gap, p->loose_stiffness, p->loose_damping, lead, speed);
    }
    if (rig->second) {
        force -= 2.0 * p->second_coupling * x * y[rig->second];
    }
    if (rig->pendulum) { /* bob at x + length sin(angle), turned back by a torsion spring */
        const double angle = y[rig->pendulum], turn = y[rig->pendulum + 1], s = sin(angle);
        const double back = p->pendulum_omega * (p->pendulum_omega * angle + 2.0 * p->pendulum_zeta * turn);
        force += p->pendulum_mass * p->pendulum_length * (turn * turn * s + cos(angle) * back);
        inertia += p->pendulum_mass * s * s;
    }
    if (p->inertia != 0.0) { /* kinetic energy (1 + inertia x^2) v^2 / 2 */
        force -= p->inertia * x * v * v;
        inertia += p->inertia * x * x;
    }
    *effective_mass = inertia;
    return force;
}

/* Dry friction just above and just below standstill, both positive. */
void rig_limits(const Rig *rig, double t, double *up, double *down)
{
    const Parameters *p = &rig->p;
    double level = p->dry + p->stribeck_excess;
    if (p->friction_gain != 0.0) {
        level -= p->friction_gain * expm1(-t / p->friction_time);
    }
    *up = level + p->direction_dry;
    *down = level - p->direction_dry;
}

static double friction(const Rig *rig, double t, double v)
{
    const Parameters *p = &rig->p;
    const double speed = fmax(rig->sign[SPEED] * v, 0.0);
    double up, down, force;
    rig_limits(rig, t, &up, &down);
    force = rig->sign[SPEED] > 0 ? up : -down;
    if (p->stribeck_excess != 0.0) {
        force -= rig->sign[SPEED] * p->stribeck_excess
               * -expm1(-(p->stribeck_power > 1.5 ? speed * speed / p->stribeck_speed : speed) / p->stribeck_speed);
    }
    return force;
}

static void memory_derivative(const Rig *rig, const double *y, double *dy)
{
    const Parameters *p = &rig->p;
    const double v = rig->stuck ? 0.0 : y[1], speed = rig->sign[SPEED] * v;
    if (rig->bouc) {
        const double z = y[rig->bouc], size = rig->sign[LOOP] * z;
        const double power = p->bouc_power == 1.0 ? size : pow(fmax(size, 0.0), p->bouc_power);
        dy[rig->bouc] = v - p->bouc_beta * speed * power * rig->sign[LOOP] - p->bouc_gamma * v * power;
    }
    if (rig->dahl) {
        dy[rig->dahl] = v - speed * y[rig->dahl] / p->dahl_reach;
    }
    if (rig->plastic) {
        dy[rig->plastic] = rig->sliding ? 0.0 : v;
    }
    for (int i = 0; i < MAXWELLS; i++) {
        if (rig->maxwell[i]) {
            const double *branch = rig_branch(p, i);
            dy[rig->maxwell[i]] = branch[0] * v - branch[1] * y[rig->maxwell[i]];
        }
    }
}

static void mass_derivative(const Rig *rig, double t, const double *y, double *dy)
{
    const Parameters *p = &rig->p;
    const double x = y[0], v = y[1];
    if (rig->lag) {
        dy[rig->lag] = (commanded(rig, t) - y[rig->lag]) / p->actuator_lag;
    }
    if (rig->resonator) {
        const double *r = y + rig->resonator;
        dy[rig->resonator] = r[1];
        dy[rig->resonator + 1] = p->resonator_omega
                               * (p->resonator_omega * (x - r[0]) + 2.0 * p->resonator_zeta * (v - r[1]));
    }
    if (rig->coil) {
        const double *c = y + rig->coil;
        const double on = pushed(rig, COIL_UP, p->coil_gap, p->coil_stiffness, p->coil_damping, c[0] - x, c[1] - v);
        dy[rig->coil] = c[1];
        dy[rig->coil + 1] = (arrived(rig, t, y) - on) / p->coil_mass;
    }
    if (rig->loose) {
        const double *c = y + rig->loose;
        const double on = pushed(rig, LOOSE_UP, p->loose_gap, p->loose_stiffness, p->loose_damping, c[0] - x, c[1] - v);
        dy[rig->loose] = c[1];
        dy[rig->loose + 1] = -on / p->loose_mass;
    }
    if (rig->pendulum) {
        const double angle = y[rig->pendulum], turn = y[rig->pendulum + 1];
        dy[rig->pendulum] = turn;
        dy[rig->pendulum + 1] = -dy[1] * cos(angle) / p->pendulum_length
                              - p->pendulum_omega * (p->pendulum_omega * angle + 2.0 * p->pendulum_zeta * turn);
    }
    if (rig->second) {
        const double *q = y + rig->second;
        dy[rig->second] = q[1];
        dy[rig->second + 1] = -p->second_omega * (p->second_omega * q[0] + 2.0 * p->second_zeta * q[1])
                            - p->second_coupling * x * x;
    }
}

/* What reaches the sensor: a displacement, or an acceleration as the displacement of a sine that has it. */
static double sensed(const Rig *rig, const double *y, const double *dy)
{
    return rig->p.accelerometer > 0.0 ? dy[1] / (rig->p.omega * rig->p.omega) : y[0];
}

void rig_derivative(const Rig *rig, double t, const double *y, double *dy)
{
    const Parameters *p = &rig->p;
    if (rig->stuck) {
        dy[0] = dy[1] = 0.0;
    } else {
        double inertia;
        const double net = rig_net(rig, t, y, &inertia);
        dy[0] = y[1];
        dy[1] = (net - friction(rig, t, y[1])) / inertia;
    }
    memory_derivative(rig, y, dy);
    mass_derivative(rig, t, y, dy);
    if (rig->sensor) {
        dy[rig->sensor] = (sensed(rig, y, dy) - y[rig->sensor]) / p->sensor_lag;
    }
    if (rig->mean) {
        dy[rig->mean] = (y[0] * y[0] - y[rig->mean]) / p->switch_memory;
        dy[rig->mean + 1] = (y[1] * y[1] - y[rig->mean + 1]) / p->switch_memory;
    }
}

/* What the sensor shows of a state, m or m/s^2. */
double rig_sensor(const Rig *rig, double t, const double *y)
{
    const Parameters *p = &rig->p;
    double dy[MOST_STATES], x;
    if (rig->sensor) {
        x = y[rig->sensor];
    } else {
        rig_derivative(rig, t, y, dy);
        x = sensed(rig, y, dy);
    }
    if (p->sensor_play > 0.0) {
        x -= y[rig->plastic];
    }
    if (p->sensor_length > 0.0) {
        x = p->sensor_length * tanh(x / p->sensor_length);
    }
    x = x * (1.0 + x * (p->sensor_square + x * p->sensor_cube)) + p->sensor_offset;
    return p->accelerometer > 0.0 ? x * p->omega * p->omega : x;
}
