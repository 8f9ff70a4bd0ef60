/* One two-phase stepper under voltage drive: currents, angle and speed, step by step.
 *
 *   L di/dt = v - R i - e        e_a = -K w sin(p x)        e_b = K w cos(p x)
 *   T = -K i_a sin(p x) + K i_b cos(p x) - D sin(4 p x)
 *   J dw/dt = T - B w - F w / sqrt(w^2 + creep^2) - load
 *
 * Classic Runge-Kutta of fourth order at a fixed step.  A step pulse inside a time step cuts it there, so a voltage
 * never changes within a stage.  A phase at zero volts is shorted through its driver, not open.
 */
#ifndef TROCHIA_STEPPER_H
#define TROCHIA_STEPPER_H

#include <stdint.h>

typedef struct {
    double resistance;      /* R of a phase [ohm] */
    double inductance;      /* L of a phase [H] */
    double torque_constant; /* K of a phase [N m/A] */
    double teeth;           /* p, pole pairs */
    double detent;          /* D [N m] */
    double inertia;         /* J, rotor and load [kg m^2] */
    double viscous;         /* B, rotor and load [N m s/rad] */
    double friction;        /* F, rotor and load [N m] */
    double creep;           /* where dry friction is smoothed [rad/s] */
    double load;            /* torque against positive rotation [N m] */
} trochia_stepper;

typedef struct {
    double current_a; /* [A] */
    double current_b;
    double theta;     /* x [rad] */
    double omega;     /* w [rad/s] */
    int64_t tick;     /* time steps since zero */
    int64_t position; /* row of the voltage table, counted on over whole turns */
} trochia_stepper_state;

/* Go on for `ticks` time steps of `h` seconds.  `voltages` is the table, `rows` pairs.  `times` [s from zero, rising,
 * none before now] and `directions` (1, -1) are the step pulses; a pulse at or after the end is left.  After every
 * `every` ticks a row of `samples` (current_a, current_b, theta, omega) and of `positions` is written.  Returns how
 * many pulses were taken. */
int64_t trochia_stepper_run(const trochia_stepper *motor, trochia_stepper_state *state, const double *voltages,
                            int64_t rows, const double *times, const int8_t *directions, int64_t pulses, double h,
                            int64_t ticks, int64_t every, double *samples, int64_t *positions);

#endif
