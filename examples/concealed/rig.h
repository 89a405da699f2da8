/* The virtual rig: its parameters, its states, its modes. Everything is SI and per unit of the rig's mass.

   A parameter that is zero switches its physics off. Python reads the list of names from the compiled library, so that
   it stands here alone. */
#ifndef CONCEALED_RIG_H
#define CONCEALED_RIG_H

#define PARAMETERS(X) \
    /* the base: x'' + viscous x' + dry sgn x' + omega2 x + cubic x^3 + preload sgn x = F/mass */ \
    X(mass) X(omega2) X(viscous) X(dry) X(cubic) X(preload) \
    /* restoring: stops press back beyond +up_at and -down_at, with a damper that cannot pull */ \
    X(quadratic) X(quintic) X(tanh_stiffness) X(tanh_length) X(sine_stiffness) X(sine_length) \
    X(clearance_stiffness) X(clearance_gap) X(static_load) \
    X(up_stiffness) X(up_damping) X(up_at) X(down_stiffness) X(down_damping) X(down_at) \
    /* dissipation: friction is dry + direction_dry for v > 0 and dry - direction_dry for v < 0 */ \
    X(drag) X(cubic_damping) X(x2_damping) X(stribeck_excess) X(stribeck_speed) X(stribeck_power) \
    X(direction_dry) X(direction_viscous) \
    /* memory: Bouc-Wen, Dahl, Jenkins, Maxwell */ \
    X(bouc_stiffness) X(bouc_beta) X(bouc_gamma) X(bouc_power) X(dahl_stiffness) X(dahl_reach) \
    X(jenkins_stiffness) X(jenkins_reach) \
    X(maxwell_1) X(relaxation_1) X(maxwell_2) X(relaxation_2) X(maxwell_3) X(relaxation_3) \
    X(maxwell_4) X(relaxation_4) X(maxwell_5) X(relaxation_5) \
    /* inertia */ \
    X(resonator_mass) X(resonator_omega) X(resonator_zeta) \
    /* excitation: dead zone, then saturation, then lag, then a part that is quadratic, then backlash; limits in N */ \
    X(dead_zone) X(hard_limit) X(smooth_limit) X(actuator_lag) X(input_delay) X(quadratic_part) X(quadratic_level) \
    X(coil_mass) X(coil_gap) X(coil_stiffness) X(coil_damping) \
    /* measurement: lag, then nonlinearity and offset; an accelerometer (1, else 0) in units of omega^2, so as lengths */ \
    X(accelerometer) X(sensor_lag) X(sensor_square) X(sensor_cube) X(sensor_length) X(sensor_offset) X(output_delay) \
    /* environment */ \
    X(drift_rate) X(drift_gain) X(drift_time) X(tone) X(tone_omega) X(tone_phase) \
    /* physics that is in no list */ \
    X(modulation) X(modulation_omega) X(modulation_phase) \
    X(pendulum_mass) X(pendulum_length) X(pendulum_omega) X(pendulum_zeta) \
    X(loose_mass) X(loose_gap) X(loose_stiffness) X(loose_damping) \
    X(speed_stiffness) X(inertia) X(damping_rate) X(friction_gain) X(friction_time) \
    X(valve_damping) X(valve_speed) X(switched_damping) X(switch_omega) X(switch_width) X(switch_memory) \
    X(second_coupling) X(second_omega) X(second_zeta) X(force_factor) X(sensor_play) \
    /* a force of an unwritten shape, a sum of bends: over x, over v, or over x and times v (unwritten_over 1, 2, 3) */ \
    X(unwritten_over) X(bend_1) X(size_1) X(place_1) X(width_1) X(bend_2) X(size_2) X(place_2) X(width_2) \
    X(bend_3) X(size_3) X(place_3) X(width_3) X(bend_4) X(size_4) X(place_4) X(width_4) \
    /* a lab's imperfections: a hand that stops the rig from `hand_at` s on; a sensor whose clock runs fast by a part */ \
    X(hand_at) X(hand_damping) X(hand_stiffness) X(hand_place) X(sensor_clock) \
    /* sizes, for tolerances: working amplitude m, natural frequency rad/s, peak force per mass m/s^2 */ \
    X(amplitude) X(omega) X(force)

#define MEMBER(name) double name;
typedef struct {
    PARAMETERS(MEMBER)
} Parameters;

enum { MAXWELLS = 5, BENDS = 4, TAYLOR = 10, MOST_STATES = 24 };

/* Surfaces whose crossing changes the equations. */
enum {
    SPEED,
    ORIGIN,
    BREAK_UP,
    BREAK_DOWN,
    LOOP,
    PLASTIC_UP,
    PLASTIC_DOWN,
    CLEARANCE_UP,
    CLEARANCE_DOWN,
    STOP_UP,
    STOP_UP_FORCE,
    STOP_DOWN,
    STOP_DOWN_FORCE,
    COIL_UP,
    COIL_UP_FORCE,
    COIL_DOWN,
    COIL_DOWN_FORCE,
    LOOSE_UP,
    LOOSE_UP_FORCE,
    LOOSE_DOWN,
    LOOSE_DOWN_FORCE,
    DEAD_UP,
    DEAD_DOWN,
    LIMIT_UP,
    LIMIT_DOWN,
    VALVE_UP,
    VALVE_DOWN,
    SURFACES
};

typedef struct {
    int kind;                   /* 0 none, 1 linear sweep, 2 logarithmic sweep, 3 multisine, 4 straight lines, 5 hits */
    double peak, start, end;    /* N, Hz, Hz; for a multisine the factor of its lines */
    double length, ramp;        /* s; the force rises over `ramp` as sin^2 */
    double interval;            /* s, of one Taylor piece */
    int pieces;
    double *taylor;             /* (pieces, TAYLOR), of kinds 3 and 4, about the middle of the piece */
    const double *hits;         /* (count, 3), of kind 5: beginning s, part of the peak, duration s */
    int count;
    const double *rest;         /* (rests, 2) N, or none: a force on the mass that is not recorded, in straight lines */
    int rests;
    double rest_interval;       /* s */
} Drive;

typedef struct {
    Parameters p;
    Drive drive;
    int states;
    int bouc, dahl, plastic, maxwell[MAXWELLS], resonator, lag, coil, sensor, pendulum, loose, mean, second;
    double scale[MOST_STATES];  /* size of each state, for the error norm */
    /* modes */
    int sign[SURFACES];         /* +1 or -1: the side of each surface */
    int stuck, held, sliding;   /* held: at rest at x = 0 on the preload; sliding: -1, 0, +1 of the Jenkins element */
} Rig;

const double *rig_branch(const Parameters *p, int i); /* stiffness and relaxation rate of a Maxwell branch */
double drive_force(const Drive *drive, double t);
double drive_rest(const Drive *drive, double t);
void drive_pieces(Drive *drive, const double *lines, int count);
void drive_straight(Drive *drive, const double *lines, int count);

void rig_layout(Rig *rig, double x0, double *y);
double rig_net(const Rig *rig, double t, const double *y, double *effective_mass);
void rig_limits(const Rig *rig, double t, double *up, double *down);
void rig_derivative(const Rig *rig, double t, const double *y, double *dy);
int rig_active(const Rig *rig, int surface);
double rig_surface(const Rig *rig, int surface, double t, const double *y);
double rig_sensor(const Rig *rig, double t, const double *y);

#endif
