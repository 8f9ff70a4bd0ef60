/* Where things stand at an instant: steps made, stream time run through; and the status. */
#include "motion_parts.h"

volatile uint16_t noted_at, noted_since;
volatile uint8_t noted_slice;

/* Where the interrupt stands in the ring. */
typedef struct {
    uint8_t tail, pins, count, backwards, grid;
} place;

static place look(void) {
    place now;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        now.tail = isr_tail;
        now.pins = isr_pins;
        now.count = isr_count;
        now.backwards = directions;
        now.grid = GPIOR0 & 2;
    }
    return now;
}

/* Steps that are to be taken off, by motor. */
typedef int16_t steps[BOARD_MOTORS];

static void back(int16_t *made, const place *at, uint8_t pins, uint8_t count) {
    for (uint8_t i = 0; i < BOARD_MOTORS; i++) {
        if (pins & board_pins[i])
            made[i] = (int16_t)(made[i] + (at->backwards & 1 << i ? -(int16_t)count : count));
    }
}

void slots_count(uint8_t place, uint8_t slots, uint8_t *counts);

/* Slots of a grid, from the tail on. */
static void back_grid(int16_t *made, place *at, uint8_t slots) {
    uint8_t counts[8];
    slots_count(at->tail, slots, counts + 1);
    for (uint8_t i = 0; i < BOARD_MOTORS; i++) {
        uint8_t count = counts[board_bits[i]];
        made[i] = (int16_t)(made[i] + (at->backwards & 1 << i ? -(int16_t)count : count));
    }
    at->tail = (uint8_t)(at->tail + slots + 3) & (uint8_t)~3;
}

void take_back(int32_t *position) {
    place at = look();
    steps made = {0};
    uint8_t head = line.head;
    if (at.grid && at.count)
        back_grid(made, &at, at.count);
    else
        back(made, &at, at.pins, at.count);
    while (at.tail != head) {
        uint8_t pins = step_ring[(uint8_t)(at.tail + 2)], count = step_ring[(uint8_t)(at.tail + 3)];
        if (count) {
            back(made, &at, pins, count);
            at.tail = (uint8_t)(at.tail + (count > 1 ? 8 : 4));
        } else if (pins & TROCHIA_GRID) {
            at.tail = (uint8_t)(at.tail + 4);
            back_grid(made, &at, pins & (uint8_t)~TROCHIA_GRID);
        } else {
            if (pins == TROCHIA_ACT)
                at.backwards ^= step_ring[(uint8_t)(at.tail + 4)];
            at.tail = (uint8_t)(at.tail + 8);
        }
    }
    for (uint8_t i = 0; i < BOARD_MOTORS; i++)
        position[i] -= made[i];
}

uint32_t stream_at(uint8_t slice, uint16_t after) {
    const slice_begin *begin = &slices[slice & (SLICES - 1)];
    if (after > TROCHIA_SLICE)
        after = TROCHIA_SLICE;
    return begin->stream + ((uint32_t)after * begin->rate >> 15);
}

/* Stream time run through, and the rate, at an instant. */
static uint32_t executed(uint8_t slice, uint16_t after, uint16_t *rate) {
    *rate = 0;
    if (!underway || ended)
        return line.stream;
    if (after >= 0x8000) /* before the first slice */
        after = 0;
    /* smoothed: the next slice's is not always known yet, the last one's is */
    uint16_t before = slices[(slice - 1) & (SLICES - 1)].rate, begin = slices[slice & (SLICES - 1)].rate;
    if (after > TROCHIA_SLICE)
        after = TROCHIA_SLICE;
    *rate = (uint16_t)((int32_t)before + ((int32_t)((int32_t)begin - before) * after >> 14));
    uint32_t at = stream_at(slice, after);
    if (end_put && (int32_t)(at - line.stream) > 0)
        at = line.stream;
    return at;
}

uint32_t executed_now(void) {
    uint8_t slice;
    uint16_t after, rate;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        slice = slice_done;
        after = (uint16_t)(TCNT1 - slice_since);
    }
    return executed(slice, after, &rate);
}

void motion_tell(trochia_status *told) {
    uint8_t slice, running;
    uint16_t at, since, late;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        at = noted_at;
        since = noted_since;
        slice = noted_slice;
        running = step_on && !ended;
    }
    /* in motion where it was when the slice began: to look through the ring would take too long */
    for (uint8_t i = 0; i < TROCHIA_MOTORS; i++)
        told->position[i] = 0;
    for (uint8_t i = 0; i < BOARD_MOTORS; i++) {
        int32_t position = line.motors[i].position;
        uint16_t since = (uint16_t)((uint16_t)position - slices[slice & (SLICES - 1)].steps[i]);
        told->position[i] = running ? position - (int16_t)since : position;
    }
    told->clock = motion_clock();
    late = (uint16_t)((uint16_t)told->clock - at);
    told->clock -= late;
    told->executed = executed(slice, (uint16_t)(at - since), &told->rate);
    told->epoch = epoch;
    told->room = queue_free();
    told->caught_at = caught_at;
    told->number = line.number;
    told->state = state;
    told->cause = cause;
    told->inputs = board_inputs();
    told->outputs = outputs;
    told->beam = board_beam_power();
    told->enabled = enabled;
    told->caught = caught;
    told->worst = 0;
}
