/* One time step of the plant.  Internal to servo*.c, not part of the schema. */
#ifndef TROCHIA_SERVO_PLANT_H
#define TROCHIA_SERVO_PLANT_H

#include "host/servo.h"

/* What does not change from step to step. */
typedef struct {
    double keep, gather; /* of the current over a step; VOLTAGE without inductance: keep 0 */
    double per_motor, per_load;
    double half;                                  /* of the gap */
    double conductance;                           /* 1 / R */
    double per_smooth_motor, per_smooth_load;     /* 1 / eps */
    double per_stribeck_motor, per_stribeck_load; /* 1 / ws */
    int volts, rigid, dry_motor, dry_load, sticky_motor, sticky_load;
} trochia_plant_constants;

trochia_plant_constants trochia_plant_prepare(const trochia_plant *plant);

/* One step under a command (the amplifier's input) and a force on the load besides the plant's own. */
void trochia_plant_step(const trochia_plant *plant, const trochia_plant_constants *k, trochia_plant_state *s,
                        double command, double disturbance);

/* What the encoder says. */
double trochia_plant_measured(const trochia_plant *plant, const trochia_plant_state *s);

/* A row of what the runs of servo.h write: measured position, motor, load, measured speed, command, current, force. */
static inline void trochia_plant_row(const trochia_plant *plant, const trochia_plant_state *s, double measured,
                                     double speed, double command, double *row) {
    row[0] = measured;
    row[1] = s->motor;
    row[2] = s->load;
    row[3] = speed;
    row[4] = command;
    row[5] = s->current;
    row[6] = plant->torque_constant * s->current;
}

#endif
