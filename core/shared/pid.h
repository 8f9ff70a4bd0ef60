/* An integer PID for a small chip: gains in 32nds, 16-bit errors, output 0..most or -most..most.
 *
 * `mended` 0 is the controller of the electronic leadscrew as it was built: its derivative is a 16-bit product that
 * wraps, and its output is never below zero.  `mended` 1 saturates the derivative, and drives both ways. */
#ifndef TROCHIA_SHARED_PID_H
#define TROCHIA_SHARED_PID_H

#include <stdint.h>

typedef struct {
    uint16_t p, i, d; /* Kp 32, Ki Ts 32, Kd / Ts 32 */
    int16_t most;     /* of the output: 1023 of a 10-bit PWM */
    uint8_t mended;
    int32_t sum;
    int16_t last;
    int16_t p_term, d_term; /* of the last tick, for those who look on */
    int32_t i_term, raw;
} trochia_pid16;

/* 16 bits of a product, as an assignment to int16_t takes them on every compiler we use. */
static inline int16_t trochia_pid16_wrap(int32_t value) {
    uint16_t low = (uint16_t)value;
    return low < 32768u ? (int16_t)low : (int16_t)((int32_t)low - 65536);
}

static inline int16_t trochia_pid16_saturate(int32_t value) {
    if (value > 32767)
        return 32767;
    return value < -32767 ? -32767 : (int16_t)value;
}

/* Half of the greatest 32-bit number: what the integral term is held to. */
enum trochia_pid16_bound { TROCHIA_PID16_MOST_I = 1073741823 };

static inline int32_t trochia_pid16_sum(trochia_pid16 *s, int16_t error) {
    int32_t most = (int32_t)TROCHIA_PID16_MOST_I / ((int32_t)s->i + 1), sum = s->sum + error;
    if (sum > most) {
        s->sum = most;
        return (int32_t)TROCHIA_PID16_MOST_I;
    }
    if (sum < -most) {
        s->sum = -most;
        return -(int32_t)TROCHIA_PID16_MOST_I;
    }
    s->sum = sum;
    return (int32_t)s->i * sum;
}

/* The output for an error; one call a tick. */
static inline int16_t trochia_pid16_step(trochia_pid16 *s, int16_t error) {
    int32_t most_e = 32767 / ((int32_t)s->p + 1), change = (int32_t)error - s->last;
    if (error > most_e)
        s->p_term = 32767;
    else
        s->p_term = error < -most_e ? -32767 : (int16_t)((int32_t)s->p * error);
    s->i_term = trochia_pid16_sum(s, error);
    if (s->mended) {
        if (change > 32767 / ((int32_t)s->d + 1))
            s->d_term = 32767;
        else if (change < -(32767 / ((int32_t)s->d + 1)))
            s->d_term = -32767;
        else
            s->d_term = trochia_pid16_saturate((int32_t)s->d * change);
    } else
        s->d_term = trochia_pid16_wrap((int32_t)((uint32_t)s->d * (uint32_t)change));
    s->last = error;
    s->raw = (s->p_term + s->i_term + s->d_term) >> 5;
    if (s->raw > s->most)
        return s->most;
    if (s->raw < 0 && !s->mended)
        return 0;
    return s->raw < -s->most ? (int16_t)-s->most : (int16_t)s->raw;
}

#endif
