#include "host/twin.h"

#include <math.h>
#include <stddef.h>

/* Last whole step passed on the way to x, coming from `at`. */
static int64_t last_passed(int64_t at, double x) {
    const int64_t up = (int64_t)floor(x + TWIN_SNAP);
    if (up > at) {
        return up;
    }
    const int64_t down = (int64_t)ceil(x - TWIN_SNAP);
    return down < at ? down : at;
}

static int64_t floor_quotient(int64_t a, int64_t b) {
    const int64_t q = a / b;
    return q - (a % b < 0);
}

/* Where the motor goes for a command: updates the counted position, returns the travel. */
static double follow(trochia_twin_joint *joint, double command) {
    switch (joint->motor) {
    case TROCHIA_TWIN_STEPS:
        joint->position = last_passed(joint->position, command * joint->per_unit);
        break;
    case TROCHIA_TWIN_COUNTS:
        joint->position = (int64_t)floor(command * joint->per_unit + 0.5);
        break;
    default:
        return command;
    }
    return (double)joint->position / joint->per_unit;
}

/* The play operator: the load stays where it is until the motor has crossed the dead zone and pushes it. */
static double play(double load, double motor, double half) {
    if (load < motor - half) {
        return motor - half;
    }
    return load > motor + half ? motor + half : load;
}

static int64_t encoder_reading(const trochia_twin_joint *joint) {
    if (joint->encoder == TROCHIA_TWIN_ON_LOAD) {
        return (int64_t)floor(joint->load * joint->counts_per_unit + TWIN_SNAP);
    }
    return floor_quotient(joint->position * joint->numerator, joint->denominator);
}

void trochia_twin_start(trochia_twin_joint *joint, double command, double slack) {
    joint->position = (int64_t)floor(command * joint->per_unit + 0.5);
    joint->load = follow(joint, command) + slack * 0.5 * joint->backlash;
}

void trochia_twin_run(trochia_twin_joint *joint, const double *command, int64_t n, int64_t *position, double *motor,
                      int64_t *counts, double *load) {
    const double half = 0.5 * joint->backlash;
    for (int64_t i = 0; i < n; i++) {
        motor[i] = follow(joint, command[i]);
        load[i] = joint->load = play(joint->load, motor[i], half);
        if (position != NULL) {
            position[i] = joint->position;
        }
        if (counts != NULL) {
            counts[i] = encoder_reading(joint);
        }
    }
}
