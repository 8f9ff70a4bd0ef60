/* One variable reluctance stepper of any number of phases behind unipolar switches: currents, angle, speed.
 *
 *   v = R i + L di/dt + i w dL/dx        L(x) = L0 + L1 cos(N x - k shift)        k = 0 ... phases - 1
 *   T = 1/2 sum i^2 dL/dx                J dw/dt = T - B w - F w / sqrt(w^2 + creep^2) - load
 *
 * A phase that is on sees the supply.  One that is off has its current led on by a diode, against a voltage and through
 * a resistor, until the current is gone; there the diode blocks, so a current never falls below zero.
 *
 * Classic Runge-Kutta of fourth order at a fixed step.  A step pulse inside a time step cuts it there, so a switch
 * never changes within a stage.
 */
#ifndef TROCHIA_RELUCTANCE_H
#define TROCHIA_RELUCTANCE_H

#include <stdint.h>

typedef struct {
    double resistance; /* R of a phase [ohm] */
    double mean;       /* L0 [H] */
    double swing;      /* L1, half of what it changes by [H] */
    double teeth;      /* N, of the rotor */
    double shift;      /* from phase to phase [electrical rad]; below zero where the rotor turns against the order */
    double supply;     /* across a phase that is on [V] */
    double against;    /* what the current of a phase that is off runs against [V] */
    double series;     /* and through [ohm] */
    double inertia;    /* J, rotor and load [kg m^2] */
    double viscous;    /* B, rotor and load [N m s/rad] */
    double friction;   /* F, rotor and load [N m] */
    double creep;      /* where dry friction is smoothed [rad/s] */
    double load;       /* torque against positive rotation [N m] */
    int64_t phases;    /* at most 16 */
} trochia_reluctance;

typedef struct {
    double current[16]; /* [A] */
    double theta;       /* x [rad] */
    double omega;       /* w [rad/s] */
    int64_t tick;       /* time steps since zero */
    int64_t position;   /* row of the table, counted on over whole turns */
} trochia_reluctance_state;

/* Go on for `ticks` time steps of `h` seconds.  `table` has `rows` words, bit k of a word: phase k is on.  `times` [s
 * from zero, rising, none before now] and `directions` (1, -1) are the step pulses; a pulse at or after the end is
 * left. After every `every` ticks a row of `samples` (currents, theta, omega) and of `positions` is written.  Returns
 * how many pulses were taken. */
int64_t trochia_reluctance_run(const trochia_reluctance *motor, trochia_reluctance_state *state, const uint32_t *table,
                               int64_t rows, const double *times, const int8_t *directions, int64_t pulses, double h,
                               int64_t ticks, int64_t every, double *samples, int64_t *positions);

#endif
