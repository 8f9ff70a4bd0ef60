/* What happens at its tick and is no pulse: a span or a slice begins, motion ends, an input changes. */
#include "motion_parts.h"

enum {
    SOON = 32,    /* ticks: no change of the beam's power is armed for earlier */
    GONE = 0xf000 /* ticks ahead that are ticks ago: what is in the ring is at most three slices ahead */
};

volatile uint8_t slice_done, directions, span_power, span_lit, outputs;
volatile uint16_t slice_since, caught_after;
volatile uint8_t caught, caught_slice, caught_new, estop_seen, ended;
trochia_look watched;
uint8_t estop_inputs;

void beam_put(void) {
    uint8_t full = slices[slice_done & (SLICES - 1)].rate == TROCHIA_FULL_RATE;
    if (span_lit && full && !line.brake && !ended) {
        GPIOR0 |= 1 << MAY_SHINE;
        board_beam(span_power);
    } else {
        GPIOR0 &= (uint8_t)~(1 << MAY_SHINE);
        board_beam(0);
    }
}

uint16_t beam_since;
volatile uint8_t beam_head; /* of its ring: ticks, lower and upper bytes, and powers, BEAMS of each */

void beam_begin(void) {
    beam_head = GPIOR2;
    beam_since = 0;
}

/* The next change is armed, unless one is. */
static void arm(void) {
    uint8_t tail = GPIOR2;
    if (tail == beam_head || TIMSK1 & 1 << OCIE1B)
        return;
    const uint8_t *entry = step_ring + 256 + tail;
    uint16_t at = (uint16_t)(entry[0] | entry[BEAMS] << 8), soon = (uint16_t)(TCNT1 + SOON);
    if ((uint16_t)(at - soon) >= GONE)
        at = soon;
    OCR1B = at;
    TIFR1 = 1 << OCF1B;
    TIMSK1 |= 1 << OCIE1B;
}

/* The beam's power from a tick after the start of the slice that is being made; returns whether there was room. */
uint8_t beam_light(uint16_t at, uint8_t power) {
    uint8_t head = beam_head, next = (uint8_t)(head + 1) & (BEAMS - 1);
    if (next == GPIOR2)
        return 0;
    at = (uint16_t)(at + beam_since);
    step_ring[256 + head] = (uint8_t)at;
    step_ring[256 + BEAMS + head] = (uint8_t)(at >> 8);
    step_ring[256 + 2 * BEAMS + head] = power;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        beam_head = next;
        if (underway == 1)
            arm();
    }
    return 1;
}

/* What was put before it was known when the first slice begins. */
void beam_kick(uint16_t tick) {
    beam_since = (uint16_t)(beam_since + tick);
    for (uint8_t i = GPIOR2; i != beam_head; i = (uint8_t)(i + 1) & (BEAMS - 1)) {
        uint8_t *entry = step_ring + 256 + i;
        uint16_t at = (uint16_t)((uint16_t)(entry[0] | entry[BEAMS] << 8) + tick);
        entry[0] = (uint8_t)at;
        entry[BEAMS] = (uint8_t)(at >> 8);
    }
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        arm();
    }
}

void line_act(void);

/* The entry at the ring's tail is due now; called by the step interrupt, which does by itself what happens often. */
void line_act(void) {
    uint8_t at = isr_tail;
    uint8_t kind = step_ring[(uint8_t)(at + 2)];
    if (kind == TROCHIA_ACT) {
        uint8_t turned = step_ring[(uint8_t)(at + 4)], flags = step_ring[(uint8_t)(at + 5)];
        directions ^= turned;
        if (turned)
            board_turn(turned);
        if (flags & TROCHIA_SET_OUTPUTS) {
            outputs = step_ring[(uint8_t)(at + 6)];
            board_outputs(outputs);
        }
    } else {
        ended = kind == TROCHIA_END;
        beam_put();
    }
    isr_tail = (uint8_t)(at + 8);
}

void watch_look(void) {
    uint8_t levels = board_inputs();
    uint8_t hit = (uint8_t)(~(levels ^ watched.levels) & watched.mask);
    if (hit) {
        watched.mask = 0;
        caught |= hit;
        caught_slice = slice_done;
        caught_after = (uint16_t)(TCNT1 - slice_since);
        caught_new = 1;
        board_beam(0);
        GPIOR0 &= (uint8_t)~(1 << MAY_SHINE);
        span_power = 0;
    }
    if (estop_inputs & ~levels) {
        TIMSK1 &= (uint8_t)~(1 << OCIE1A | 1 << OCIE1B);
        board_beam(0);
        board_enable(0);
        estop_seen = 1;
    }
}

ISR(PCINT0_vect) {
    watch_look();
}

ISR(PCINT1_vect, ISR_ALIASOF(PCINT0_vect));

ISR(PCINT2_vect, ISR_ALIASOF(PCINT0_vect));
