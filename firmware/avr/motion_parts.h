/* What the files of motion share. */
#ifndef TROCHIA_MOTION_PARTS_H
#define TROCHIA_MOTION_PARTS_H

#include <avr/interrupt.h>
#include <util/atomic.h>

#include "board.h"
#include "motion.h"
#include "registers.h"

enum { BEAMS = 16 };
extern uint8_t step_ring[256 + 3 * BEAMS]; /* begins at a multiple of 256; the beam's is behind it (line_isr.S) */
extern volatile uint8_t step_head, step_on;

#define TROCHIA_TIMELINE_MOTORS BOARD_MOTORS
#define TROCHIA_RING(line, i) (step_ring[(uint8_t)(i)])
#define TROCHIA_TAIL(line) (isr_tail)
#define TROCHIA_PUBLISH(line, i)                                                                                       \
    do {                                                                                                               \
        __asm__ volatile("" ::: "memory");                                                                             \
        (line)->head = step_head = (uint8_t)(i);                                                                       \
    } while (0)
#define TROCHIA_LIGHT(line, at, to) beam_light(at, to)
uint8_t beam_light(uint16_t at, uint8_t power);
/* grid.S, rows.S */
#define TROCHIA_BEND(run) run_bend(run)
#define TROCHIA_PLACE(line, row, most) row_place(row, most)
#define TROCHIA_CLEAR(line, from, slots) row_clear(from, slots)
#define TROCHIA_ROW(motor, row) row_full(motor, row)
#define TROCHIA_ROW_BRISK(motor, row) row_brisk(motor, row)
struct trochia_row;
struct trochia_motor;
uint8_t row_full(struct trochia_motor *motor, struct trochia_row *row);
uint8_t row_brisk(struct trochia_motor *motor, struct trochia_row *row);
uint8_t row_place(struct trochia_row *row, uint8_t most);
#define TROCHIA_PACK(line, to, from, slots) slots_pack(to, from, slots)
#define TROCHIA_STEPS(line, limit) steps_made(limit)
uint8_t steps_made(uint16_t limit);
uint8_t slots_pack(uint8_t to, uint8_t from, uint8_t slots);
void run_bend(void *run);
void row_clear(uint8_t from, uint8_t slots);
#include "shared/timeline.h"

/* Stream time, rate and steps made at the start of the last few slices, by the slice's number. */
typedef struct {
    uint32_t stream;
    uint16_t steps[BOARD_MOTORS]; /* lower half */
    uint16_t rate;
} slice_begin;

enum { SLICES = 8 };

extern trochia_timeline line;
extern slice_begin slices[SLICES];

/* Written by interrupts. */
extern volatile uint8_t slice_done;   /* slices that have ended */
extern volatile uint16_t slice_since; /* when the last of them did [timer 1] */
extern volatile uint8_t directions;   /* motors that go backwards */
extern volatile uint8_t span_power, span_lit, outputs, silence_over;
extern volatile uint8_t caught, caught_slice, caught_new, estop_seen;
extern volatile uint16_t caught_after;
extern volatile uint8_t ended; /* END has been reached */

/* When the last frame ended: that is the instant a status speaks of, however long it takes to make one. */
extern volatile uint16_t noted_at, noted_since;
extern volatile uint8_t noted_slice;

extern trochia_look watched;
extern uint8_t estop_inputs;
extern uint16_t silence_most;

/* How things stand (motion.c). */
extern uint8_t state, cause, epoch, enabled, end_put;
extern uint8_t underway; /* 2: the interrupt is still to be started */
extern uint32_t caught_at;

/* Takes steps off positions that are in the ring but not yet at the pins (where.c). */
void take_back(int32_t *position);

/* Stream time some ticks after a slice began, and now. */
uint32_t stream_at(uint8_t slice, uint16_t after);
uint32_t executed_now(void);

/* Looks at watched inputs; with interrupts off. */
void watch_look(void);

/* Lights the beam if it may be lit now; with interrupts off. */
void beam_put(void);

/* Changes of the beam's power to come (act.c): none; and from a tick on, at which the first slice begins. */
void beam_begin(void);
void beam_kick(uint16_t tick);
extern uint16_t beam_since; /* when the slice that is being made begins [timer 1] */

/* The queue, bytes of spans (queue.c). */
void queue_clear(void);
uint16_t queue_free(void);
uint8_t queue_put(const uint8_t *payload, uint8_t size);
uint16_t queue_size(const trochia_span *span);
uint8_t queue_next(uint8_t *bytes, uint8_t size); /* the beginning of the next span; returns 0 where there is none */
void queue_get(uint8_t *bytes, uint8_t size);     /* more of it */
void queue_cut(uint16_t number, uint32_t duration, uint8_t *found);
uint32_t queue_hand(void);

#endif
