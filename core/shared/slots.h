/* Steps of several motors on a grid: see pulses.h. */
#ifndef TROCHIA_SLOTS_H
#define TROCHIA_SLOTS_H

#include "shared/pulses.h"

/* One motor's steps of one interval, on their way into slots. */
typedef struct trochia_row {
    uint32_t real;     /* of the first [2^-8 ticks] */
    uint32_t interval; /* [2^-8 ticks] */
    int32_t bound;     /* steps due from here on are not put [2^-8 ticks of stream time] */
    uint16_t until;    /* nor those from here on [ticks], unless it is the span's or the slice's last chunk */
    uint8_t base;      /* place of the slice's first slot in the ring */
    uint8_t free;      /* first slot that is the motor's */
    uint8_t stop;      /* first slot that is nobody's */
    uint8_t pin;
    uint8_t last;
    uint16_t extra; /* of the time line */
} trochia_row;

/* Clears slots from a place of the ring on. */
static inline void trochia_row_clear(trochia_timeline *line, uint8_t from, uint8_t slots) {
    (void)line;
    for (uint8_t i = 0; i < slots; i++)
        TROCHIA_RING(line, from + i) = 0;
}

/* Takes slots without pulses together, the first and the last having some; returns how many bytes are left. */
static inline uint8_t trochia_slots_pack(trochia_timeline *line, uint8_t to, uint8_t from, uint8_t slots) {
    uint8_t bytes = 0, empty = 0;
    (void)line;
    for (uint8_t i = 0; i < slots; i++) {
        uint8_t pins = TROCHIA_RING(line, from + i);
        if (!pins) {
            empty++;
            continue;
        }
        if (empty)
            TROCHIA_RING(line, to + bytes++) = (uint8_t)(empty << 1 | 1);
        TROCHIA_RING(line, to + bytes++) = pins;
        empty = 0;
    }
    return bytes;
}

/* Puts steps into slots, at most `most`, each into its own or the next that is free; returns how many found one.
 * row->real is the next one's then. */
static inline uint8_t trochia_row_place(trochia_timeline *line, trochia_row *row, uint8_t most) {
    uint32_t real = row->real;
    uint8_t made = 0;
    (void)line;
    do {
        uint8_t slot = (uint8_t)(real >> 15);
        if (slot < row->free)
            slot = row->free;
        if (slot >= row->stop)
            break;
        TROCHIA_RING(line, row->base + slot) |= row->pin;
        row->free = (uint8_t)(slot + 1);
        real += row->interval;
        made++;
    } while (made < most && (uint16_t)(real >> 8) < row->until);
    row->real = real;
    return made;
}

/* Where the next step of a motor is in real time, and how far apart its steps are; returns whether that is the same. */
static inline uint8_t trochia_row_scale(const trochia_timeline *line, const trochia_motor *motor, trochia_row *row) {
    row->real = (uint32_t)motor->due;
    row->interval = motor->run.interval;
    if (line->full)
        return row->interval < (uint32_t)TROCHIA_LONG;
    row->real = trochia_real_fine(line, row->real);
    row->interval = trochia_real_fine(line, row->interval);
    return 0;
}

/* One motor's steps of a chunk. */
static inline void trochia_timeline_row(trochia_timeline *line, trochia_motor *motor, trochia_row *row) {
    trochia_segment_run *run = &motor->run;
    if ((line->full && TROCHIA_ROW(motor, row)) || (line->brisk && TROCHIA_ROW_BRISK(motor, row)))
        return;
    while (motor->on && motor->due < row->bound) {
        uint8_t same = trochia_row_scale(line, motor, row);
        if (!row->last && (uint16_t)(row->real >> 8) >= row->until)
            return;
        uint8_t most = run->phase;
        if (most == 0 || run->interval >= (uint32_t)TROCHIA_LONG)
            most = 1;
        uint8_t made = TROCHIA_PLACE(line, row, most);
        if (!made) {
            line->crowded |= row->last;
            return;
        }
        int32_t due = motor->due;
        trochia_motor_on(motor, made, same ? (int32_t)row->real : due + trochia_steps_ahead(run, made));
    }
}

/* The steps of all motors in the next slots, from the first that is due; returns whether those up to `limit` are all
 * there.  Where there is no room, nothing is done. */
static inline uint8_t trochia_timeline_chunk(trochia_timeline *line, int32_t first, uint16_t limit) {
    enum { HALF = TROCHIA_SLOT / 2 };
    if (trochia_timeline_space(line) < TROCHIA_CHUNK + TROCHIA_SPARE + 24)
        return 0;
    uint8_t start = (uint8_t)((uint16_t)(line->last + line->apart + HALF - 1) / TROCHIA_SLOT);
    uint8_t slot = (uint8_t)(trochia_real(line, (uint16_t)(first >> 8)) / TROCHIA_SLOT);
    if (slot > start)
        start = slot;
    uint16_t end = trochia_real(line, limit);
    uint8_t stop = (uint8_t)((uint16_t)(end + TROCHIA_SLOT - 1) / TROCHIA_SLOT), last = 1;
    if (start > stop + TROCHIA_BEHIND)
        line->crowded = 1;
    if (line->crowded)
        return 0;
    if (stop < start)
        stop = start;
    if ((uint8_t)(stop - start) > TROCHIA_CHUNK) {
        stop = (uint8_t)(start + TROCHIA_CHUNK);
        end = (uint16_t)(stop * TROCHIA_SLOT);
        last = 0;
    } else {
        stop = (uint8_t)(stop + TROCHIA_SPARE);
    }
    uint8_t from = (uint8_t)(line->head + 4), used = start;
    TROCHIA_CLEAR(line, from, (uint8_t)(stop - start));
    trochia_row row = {.until = end, .base = (uint8_t)(from - start), .stop = stop, .last = last, .extra = line->extra};
    row.bound = (int32_t)limit << 8;
    for (uint8_t i = 0; i < TROCHIA_TIMELINE_MOTORS; i++) {
        if (!line->motors[i].on)
            continue;
        row.free = start;
        row.pin = line->motors[i].pin;
        trochia_timeline_row(line, &line->motors[i], &row);
        if (row.free > used)
            used = row.free;
    }
    line->dense = !last && used != start;
    if (used == start)
        return last;
    uint8_t slots = (uint8_t)(used - start), before = 0;
    while (!TROCHIA_RING(line, from + before))
        before++;
    uint16_t at = (uint16_t)((start + before) * TROCHIA_SLOT + HALF);
    uint16_t delta = trochia_timeline_delta(line, at, line->apart);
    slots = (uint8_t)(slots - before);
    uint8_t bytes = TROCHIA_PACK(line, from, (uint8_t)(from + before), slots);
    trochia_timeline_put(line, delta, TROCHIA_GRID | bytes, 0);
    line->last = (uint16_t)(line->last + (uint16_t)((uint8_t)(slots - 1) * TROCHIA_SLOT));
    TROCHIA_PUBLISH(line, (uint8_t)(from + ((bytes + 3) & ~3)));
    return last && !line->crowded;
}

/* Steps due before `limit` [ticks]; returns whether all found room.  Takes turns with others: a chunk at a time. */
static inline uint8_t trochia_timeline_steps(trochia_timeline *line, uint16_t limit) {
    if (line->dense) /* several have steps, and more than the last chunk took */
        return trochia_timeline_chunk(line, 0, limit);
    int32_t bound = (int32_t)limit << 8, first = bound;
    trochia_motor *near = line->motors;
    uint8_t count = 0;
    for (uint8_t i = 0; i < TROCHIA_TIMELINE_MOTORS; i++) {
        trochia_motor *motor = &line->motors[i];
        if (!motor->on || motor->due >= bound)
            continue;
        near = motor;
        count++;
        if (motor->due < first)
            first = motor->due;
    }
    if (count == 0)
        return 1;
    if (count == 1 && trochia_motor_runs(line, near)) {
        trochia_timeline_alone(line, near, bound);
        return !(near->on && near->due < bound);
    }
    return trochia_timeline_chunk(line, first, limit);
}

#endif
