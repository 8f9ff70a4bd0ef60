/* A servo axis whose loop computes in integers, as a motion card or a small chip does: the plant of servo.h behind it.
 *
 * PMAC: command and feedback in 1/32 count a cycle; with FE = CP - AP, velocities and accelerations as differences,
 *   bits = i30 (i08 (FE' + (i32 CV + i35 CA) / 128 + i33 IE / 2^23) - i31 i09 AV / 128) / 2^19 + i29, within +-i69
 *   FE' is FE within +-i67 and behind the dead band i65, inside which it counts i64 / 16 of itself;
 *   IE sums FE' within +-i63; with i34 only while CV is 0, and never into a limit that is reached.
 * THIRTY_SECONDS: error in whole counts, 16 bits, through trochia_pid16.  One that is not mended drives one way only:
 *   the way of the command, as the chip sets its direction before it starts. */
#ifndef TROCHIA_SERVO_LAW_H
#define TROCHIA_SERVO_LAW_H

#include <stdint.h>

#include "host/servo.h"
#include "shared/pid.h"

enum trochia_law_kind { TROCHIA_LAW_PMAC = 0, TROCHIA_LAW_THIRTY_SECONDS = 1 };

typedef struct {
    uint32_t kind;  /* enum trochia_law_kind */
    uint32_t steps; /* time steps a period */
    double counts;  /* a unit of motion */
    double volts;   /* of one bit of the output, or one step of the PWM */
    int32_t i08, i09, i29, i30, i31, i32, i33, i34, i35, i64, i65;
    int64_t i63, i67;
    int32_t i69;
} trochia_law;

typedef struct {
    trochia_plant_state plant;
    int64_t commanded, velocity, actual; /* of the cycle before, 1/32 count */
    int64_t sum;                         /* IE, 1/32 count */
    int64_t saturated;                   /* the output of the cycle before was at its limit: its sign */
    int64_t way;                         /* direction of the last command, 1 or -1 */
    trochia_pid16 pid;
    uint64_t ticks;
    double command; /* volts */
} trochia_law_state;

/* As trochia_servo_run; wanted[ticks] are positions alone.  Speed in out is that of the last cycle. */
void trochia_law_run(const trochia_plant *plant, const trochia_law *law, trochia_law_state *state, const double *wanted,
                     const double *disturbance, uint64_t ticks, double *out);

/* The PMAC law alone: rows of command and feedback [1/32 count] in, bits out. */
void trochia_law_bits(const trochia_law *law, trochia_law_state *state, const int64_t *commanded, const int64_t *actual,
                      uint64_t ticks, int32_t *out);

#endif
