/* A servo axis: plant, encoder, cascaded loops, run from servo tick to servo tick.
 *
 * Plant, in steps of h.  Angles may be ways and torques forces, as long as all agree.
 *   L di/dt = v - R i - Kb w          v: the amplifier's output (mode VOLTAGE)
 *   di/dt = (i_cmd - i) / lag         the current loop is closed inside the amplifier (mode CURRENT)
 *   i_cmd = Kv e + Ki sum(e),  e = w_cmd - w         and the speed loop too (mode SPEED), no sum while at its limit
 *   BRAKED: v = 0, whatever the mode: the winding is shorted.  FREE: i = 0.
 *   Jm dw/dt = Kt i - friction(w) - c           c = k dead(x - y, gap) + d (w - z) where the gap is closed
 *   Jl dz/dt = c - friction(z) - load
 *   friction(w) = (Fc + (Fs - Fc) exp(-(w / ws)^2)) tanh(w / eps) + B w + offset
 * Position by the midpoint rule, speed with the force at the middle of the step (second order), current exactly for a
 * speed that stays over a step.  Without stiffness motor and load are one body.
 *
 * Loops: position -> speed -> current, each a PID that may be left out; see trochia_pid. */
#ifndef TROCHIA_SERVO_H
#define TROCHIA_SERVO_H

#include <stdint.h>

#include "host/encoder.h"

enum trochia_amplifier { TROCHIA_VOLTAGE = 0, TROCHIA_CURRENT = 1, TROCHIA_SPEED = 2 };
enum trochia_power { TROCHIA_DRIVEN = 0, TROCHIA_BRAKED = 1, TROCHIA_FREE = 2 };
enum trochia_windup {
    TROCHIA_WINDUP_NONE = 0,
    TROCHIA_WINDUP_CLAMP = 1,
    TROCHIA_WINDUP_BACK = 2,
    TROCHIA_WINDUP_HOLD = 3
};

typedef struct {
    double coulomb, stick, stribeck; /* Fc, Fs, ws */
    double smooth;                   /* eps */
    double viscous, offset;          /* B; a constant force against positive motion */
} trochia_friction;

typedef struct {
    double h;                             /* time step [s] */
    double gain;                          /* command to volts (VOLTAGE), amperes (CURRENT) or speed (SPEED) */
    double offset;                        /* that it adds to its command */
    double speed_gain, speed_integral;    /* Kv, Ki of the amplifier's own speed loop (SPEED) */
    double most_voltage;                  /* what the supply gives, after the bridge's drop */
    double drop;                          /* lost in the bridge, against the current */
    double quantum;                       /* of the voltage: PWM's resolution; 0: none */
    double most_current;                  /* the amplifier's limit */
    double lag;                           /* of the current loop inside the amplifier [s]; 0: none */
    double resistance, inductance;        /* R, L (0: none) */
    double torque_constant, emf_constant; /* Kt, Kb */
    double motor_inertia, load_inertia;   /* Jm, Jl */
    double stiffness, damping, gap;       /* k (0: rigid), d, whole width of the dead zone */
    double load;                          /* against positive motion */
    double counts;                        /* encoder counts a unit; 0: exact */
    trochia_friction motor_friction, load_friction;
    uint32_t mode;    /* enum trochia_amplifier */
    uint32_t on_load; /* 1: the encoder reads the load */
    uint32_t power;   /* enum trochia_power */
    trochia_encoder encoder;
} trochia_plant;

typedef struct {
    double motor, load; /* positions */
    double motor_speed, load_speed;
    double current;
    double motor_force, load_force; /* accelerations of the last step, for the next one's middle */
    double sum;                     /* of the amplifier's speed loop [A] */
    trochia_encoder_state encoder;
} trochia_plant_state;

/* u = p (b r - y) + i sum(e) + d ((c r - y) filtered) + bias, between -most and most.
 * integral: i_now e + i_before e_before is added to it a tick;  derivative: d_keep of itself and d_gain of the change.
 */
typedef struct {
    double p, b, c;
    double i_now, i_before;
    double d_keep, d_gain;
    double most;     /* of the output; infinity: none */
    double most_sum; /* of the integral (WINDUP_CLAMP) */
    double back;     /* of back-calculation, a tick */
    double dead;     /* errors within it are none */
    uint32_t windup;
    uint32_t incremental; /* 1: the output is a sum of changes */
} trochia_pid;

typedef struct {
    double sum, derivative, output;
    double error, damped; /* of the tick before */
    double proportional;
} trochia_pid_state;

/* Second-order section, transposed direct form II: y = b0 x + s1, and so on; a0 is 1. */
typedef struct {
    double b0, b1, b2, a1, a2;
} trochia_biquad;

typedef struct {
    double period;     /* of the position loop [s] */
    uint32_t steps;    /* time steps a period */
    uint32_t loops;    /* bit 0: position, 1: speed, 2: current */
    uint32_t filters;  /* biquads on the command, at most 4 */
    uint32_t averaged; /* speed over this many periods, 1 or more (at most 8) */
    double speed_forward,
        acceleration_forward;  /* feed-forward: of the speed into the speed loop, of force into the command */
    double speed_into_command; /* the same of speed into the command */
    double friction_forward, friction_smooth; /* compensation: times tanh(speed wanted / smooth) */
    double bias;                              /* added to the command */
    double most_command;                      /* +- */
    trochia_pid position, speed, current;
    trochia_biquad filter[4];
} trochia_loop;

typedef struct {
    trochia_plant_state plant;
    trochia_pid_state position, speed, current;
    double filter[8];
    double seen[9]; /* measured positions, newest first */
    double command;
    uint64_t ticks;
} trochia_servo_state;

/* Goes on for `ticks` periods.  wanted[ticks][3]: position, speed, acceleration at each tick.  Writes a row of out a
 * tick, as things stand at its start: measured position, motor, load, measured speed, command, current, force of the
 * motor.  disturbance[ticks], or NULL: added to the load.  injected[ticks], or NULL: added to the command. */
void trochia_servo_run(const trochia_plant *plant, const trochia_loop *loop, trochia_servo_state *state,
                       const double *wanted, const double *disturbance, const double *injected, uint64_t ticks,
                       double *out);

/* The plant alone: `commands` are held for `steps` time steps each; out[count][7] as above, speed exact. */
void trochia_plant_run(const trochia_plant *plant, trochia_plant_state *state, const double *commands, uint64_t count,
                       uint32_t steps, double *out);

#endif
