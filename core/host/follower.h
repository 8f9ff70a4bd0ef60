/* The electronic leadscrew as it was built: a chip counts spindle and screw pulses and holds their ratio.
 *
 * At every spindle pulse the next whole number of screw pulses due, floor(n num / den), is added to the error and what
 * has come since the last one is taken off; every `pid_steps` time steps the whole-number PID makes a duty of it.  The
 * motor is a first-order lag, dv/dt = pole (gain duty - v), run exactly over a step; a pulse comes at every whole
 * position, whatever the direction, as a single channel tells none. */
#ifndef TROCHIA_FOLLOWER_H
#define TROCHIA_FOLLOWER_H

#include <stdint.h>

#include "shared/pid.h"

typedef struct {
    double h;           /* time step [s] */
    double gain, pole;  /* pulses/s a step of the duty, 1/s */
    double spindle;     /* spindle pulses a second; the first comes one period after the start */
    int64_t num, den;   /* screw pulses a spindle pulse */
    uint32_t pid_steps; /* time steps a PID period */
    uint32_t one_way;   /* 1: the bridge never drives backwards, whatever the PID says */
} trochia_follower;

typedef struct {
    trochia_pid16 pid;
    double position, speed; /* pulses, pulses/s */
    int64_t step;           /* time steps so far */
    int64_t spindle_pulses, pulses, counted, owed;
    int32_t error, duty;
} trochia_follower_state;

/* Runs until `rows` spindle pulses have come, at most; out[rows][4]: time, error after the pulse, duty, position. */
int64_t trochia_follower_run(const trochia_follower *f, trochia_follower_state *state, int64_t rows, double *out);

#endif
