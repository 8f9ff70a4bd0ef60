/* The linear speed controller: a move of so many steps up, at speed, and down, one call a step.
 *
 * Whoever plans the move decides the three counts (n1 a1 = n2 a2, so that both ramps meet at one speed); here nothing
 * is left but to count.  At speed the interval's 8 fraction bits are carried, so nothing drifts. */
#ifndef TROCHIA_SPEED_H
#define TROCHIA_SPEED_H

#include <stdint.h>

#include "shared/ramp.h"

enum trochia_speed_state { TROCHIA_STOP = 0, TROCHIA_ACCEL = 1, TROCHIA_RUN = 2, TROCHIA_DECEL = 3 };

typedef struct {
    trochia_ramp ramp;
    uint64_t down_per_step;   /* C of braking */
    uint32_t up, level, down; /* steps still to make of each kind */
    uint32_t interval;        /* at speed [2^-8 ticks] */
    uint8_t fraction;         /* of a tick, carried [2^-8] */
    uint8_t state;
} trochia_speed;

/* A move from rest to rest. */
static inline void trochia_speed_begin(trochia_speed *move, uint64_t up_per_step, uint64_t down_per_step, uint32_t up,
                                       uint32_t level, uint32_t down, uint32_t interval) {
    trochia_ramp_begin(&move->ramp, up_per_step, 0);
    move->down_per_step = down_per_step;
    move->up = up;
    move->level = level;
    move->down = down;
    move->interval = interval;
    move->fraction = 0;
    move->state = TROCHIA_STOP;
}

static inline uint32_t trochia_speed_level(trochia_speed *move) {
    uint16_t fraction = (uint16_t)(move->fraction + (uint8_t)move->interval);
    move->fraction = (uint8_t)fraction;
    return (move->interval >> 8) + (fraction >> 8);
}

/* Ticks from the step before to the next one; 0 where the move is at its end. */
static inline uint32_t trochia_speed_step(trochia_speed *move) {
    if (move->up) {
        move->up--;
        move->state = TROCHIA_ACCEL;
        return trochia_ramp_up(&move->ramp);
    }
    if (move->level) {
        move->level--;
        move->state = TROCHIA_RUN;
        return trochia_speed_level(move);
    }
    if (!move->down) {
        move->state = TROCHIA_STOP;
        return 0;
    }
    if (move->state != TROCHIA_DECEL) /* the steps to rest are known: so is the square */
        trochia_ramp_begin(&move->ramp, move->down_per_step, move->down * move->down_per_step);
    move->down--;
    move->state = TROCHIA_DECEL;
    return trochia_ramp_down(&move->ramp);
}

#endif
