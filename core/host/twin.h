/* One joint of the digital twin, first level: an ideal motor, a transmission with backlash, an encoder.
 *
 *   command --(driver or amplifier)--> motor --(dead zone)--> load
 *                                        `------ encoder -------'  (on either)
 *
 * Everything is in travel of the joint (mm or degree), but what is counted: motor positions (steps of a stepper, counts
 * of a servo) and encoder counts, which are integers from the joint's zero.
 *
 * Conventions
 *   STEPS   the last step passed: a step happens where the command reaches k/per_unit from either side, so the motor
 *           stays within one step of the command and needs a whole step of reversal before it turns back
 *   COUNTS  the nearest count, as an amplifier rounds its set-point
 *   encoder the floor: a count covers [k, k+1)/counts_per_unit
 * A command within TWIN_SNAP positions of a boundary is on it: the end of a move is where rounding would cost a step.
 */
#ifndef TROCHIA_TWIN_H
#define TROCHIA_TWIN_H

#include <stdint.h>

#define TWIN_SNAP 1e-6

enum trochia_twin_motor { TROCHIA_TWIN_EXACT = 0, TROCHIA_TWIN_STEPS = 1, TROCHIA_TWIN_COUNTS = 2 };

enum trochia_twin_encoder { TROCHIA_TWIN_NO_ENCODER = 0, TROCHIA_TWIN_ON_MOTOR = 1, TROCHIA_TWIN_ON_LOAD = 2 };

typedef struct {
    double per_unit;        /* motor positions a unit of travel; negative where the motor turns the other way */
    double counts_per_unit; /* encoder counts a unit of travel, for an encoder on the load */
    double backlash;        /* width of the dead zone, >= 0 */
    int64_t numerator;      /* encoder counts a motor position, for an encoder on the motor: an exact fraction */
    int64_t denominator;    /* > 0 */
    int64_t position;       /* state: motor position */
    double load;            /* state: travel of the load */
    uint8_t motor;          /* enum trochia_twin_motor */
    uint8_t encoder;        /* enum trochia_twin_encoder */
} trochia_twin_joint;

/* Put the joint at rest at a command; slack in [-1, 1] is where the load lies in its dead zone: 0 centred, -1 as after
 * moving forwards, 1 as after moving backwards. */
void trochia_twin_start(trochia_twin_joint *joint, double command, double slack);

/* Follow n commands.  Each output holds n values; position and counts may be NULL where the joint has none. */
void trochia_twin_run(trochia_twin_joint *joint, const double *command, int64_t n, int64_t *position, double *motor,
                      int64_t *counts, double *load);

#endif
