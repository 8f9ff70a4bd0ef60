/* What happens at its tick and is no pulse: a span or a slice begins, motion ends, an input changes. */
#include "motion_parts.h"

volatile uint8_t slice_done, directions, span_power, span_lit, outputs;
volatile uint16_t slice_since, silent_slices, caught_after;
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

void line_act(void);

/* The entry at the ring's tail is due now; called by the step interrupt, which does by itself what happens often. */
void line_act(void) {
    uint8_t at = isr_tail;
    uint8_t kind = step_ring[(uint8_t)(at + 2)];
    if (kind == TROCHIA_ACT) {
        uint8_t turned = step_ring[(uint8_t)(at + 4)], flags = step_ring[(uint8_t)(at + 6)];
        directions ^= turned;
        if (turned)
            board_turn(turned);
        if (flags & TROCHIA_SET_OUTPUTS) {
            outputs = step_ring[(uint8_t)(at + 7)];
            board_outputs(outputs);
        }
        span_power = step_ring[(uint8_t)(at + 5)];
    } else {
        ended = kind == TROCHIA_END;
    }
    beam_put();
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
        span_power = 0;
    }
    if (estop_inputs & ~levels) {
        TIMSK1 &= (uint8_t)~(1 << OCIE1A);
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
