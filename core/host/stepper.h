/* One two-phase stepper behind any driver, its load on the shaft or behind an elastic coupling.
 *
 *   L di/dt = v - R i - e        e_a = -K w sin(p x)        e_b = K w cos(p x)
 *   T = -K i_a sin(p x) + K i_b cos(p x) - D sin(4 p x)
 *   J dw/dt = T - B w - F w / sqrt(w^2 + creep^2) - load - C        C = k (x - y) + c (w - u)
 *   J_l du/dt = C - B_l u - F_l u / sqrt(u^2 + creep^2) - load_l    behind a coupling; without one C is nothing
 *
 * trochia_stepper_run: v is constant between step pulses (voltage; a phase at level 0 is shorted), or so but for a drop
 * that is against the current, v = level V - drop i / sqrt(i^2 + knee^2) (bridge), or what a chopper gives on average
 * (mean), or what the diodes of an open bridge give (open); Runge-Kutta of fourth order, a pulse cuts the step, so a
 * level never changes within a stage.  trochia_chopper_run: every switching of the chopper, at `sub`
 * steps a tick; the currents step exactly for a voltage that is constant over the step, the mechanics semi-implicitly.
 */
#ifndef TROCHIA_STEPPER_H
#define TROCHIA_STEPPER_H

#include <stdint.h>

enum trochia_stepper_mode {
    TROCHIA_STEPPER_VOLTAGE = 0,
    TROCHIA_STEPPER_MEAN = 1,
    TROCHIA_STEPPER_OPEN = 2,
    TROCHIA_STEPPER_BRIDGE = 3
};

typedef struct {
    double resistance;      /* R of a phase [ohm] */
    double inductance;      /* L of a phase [H] */
    double torque_constant; /* K of a phase [N m/A] */
    double teeth;           /* p, pole pairs */
    double detent;          /* D [N m] */
    double inertia;         /* J of the rotor, and of a load that is rigidly on it [kg m^2] */
    double viscous;         /* B, likewise [N m s/rad] */
    double friction;        /* F, likewise [N m] */
    double creep;           /* where dry friction is smoothed [rad/s] */
    double load;            /* torque against positive rotation [N m] */
} trochia_stepper;

typedef struct {
    double supply;     /* across a phase at level 1, or while a chopper drives it; of a bridge without its drop [V] */
    double drop;       /* of a bridge, against the current, driven or idle [V] */
    double knee;       /* current at which that drop is 1/sqrt(2) of it [A] */
    double current;    /* of a chopper at level 1 [A] */
    double lowest;     /* mean voltage of a chopper that is off but for the blanking [V] */
    double fast;       /* part of the off time in fast decay, 0 to 1 */
    double off_time;   /* [s] */
    double blanking;   /* [s] */
    double lag;        /* time constant of the mean current's control [s] */
    double scale;      /* of all levels: 1, or 0 for phases shorted */
    double hold;       /* of all levels at rest, 0 to 1 */
    double hold_delay; /* from the last pulse until then [s] */
} trochia_driver;

typedef struct {
    double stiffness; /* k [N m/rad]; 0: no coupling, and nothing here counts */
    double damping;   /* c [N m s/rad] */
    double inertia;   /* J_l [kg m^2] */
    double viscous;   /* B_l [N m s/rad] */
    double friction;  /* F_l [N m] */
    double load;      /* torque against positive rotation [N m] */
} trochia_coupling;

typedef struct {
    double off;   /* left of the off time [s] */
    double blank; /* left of the blanking [s] */
} trochia_switch;

typedef struct {
    double current_a; /* [A] */
    double current_b;
    double theta; /* x [rad] */
    double omega; /* w [rad/s] */
    double load_theta;
    double load_omega;
    trochia_switch switch_a;
    trochia_switch switch_b;
    double last_pulse; /* [s] */
    int64_t tick;      /* ticks of `h` since zero */
    int64_t position;  /* row of the table of levels, counted on over whole turns */
} trochia_stepper_state;

typedef struct {
    const double *levels; /* rows pairs, -1 to 1 */
    int64_t rows;
    const double *times; /* step pulses [s from zero], rising, none before now; one at or after the end is left */
    const int8_t *directions;
    int64_t pulses;
} trochia_stepper_input;

/* Go on for `ticks` ticks of `h` seconds.  After every `every` ticks a row of `samples` (current_a, current_b, theta,
 * omega, load_theta) and of `positions` is written.  Returns how many pulses were taken. */
int64_t trochia_stepper_run(const trochia_stepper *motor, const trochia_driver *driver,
                            const trochia_coupling *coupling, int32_t mode, trochia_stepper_state *state,
                            const trochia_stepper_input *input, double h, int64_t ticks, int64_t every, double *samples,
                            int64_t *positions);

/* The same for a chopper, switch by switch, with `sub` steps a tick. */
int64_t trochia_chopper_run(const trochia_stepper *motor, const trochia_driver *driver,
                            const trochia_coupling *coupling, trochia_stepper_state *state,
                            const trochia_stepper_input *input, double h, int64_t sub, int64_t ticks, int64_t every,
                            double *samples, int64_t *positions);

#endif
