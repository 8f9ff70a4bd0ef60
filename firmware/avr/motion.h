/* What moves: the queue of spans, the time line made of them, and the pins.
 *
 * In: orders, as link.c takes them off the line.  Out: pulses, light, outputs; where things stand. */
#ifndef TROCHIA_MOTION_H
#define TROCHIA_MOTION_H

#include <avr/io.h>

#include "shared/protocol.h"

/* When the last frame ended: that is the instant a status speaks of, however long it takes to make one. */
extern volatile uint16_t noted_at, noted_since;
extern volatile uint8_t noted_slice, slice_done;
extern volatile uint16_t slice_since;

static inline void motion_note(void) {
    noted_at = TCNT1;
    noted_since = slice_since;
    noted_slice = slice_done;
}

void motion_setup(void);

/* Goes on with the time line; to be called at least every few hundred microseconds. */
void motion_work(void);

/* Ticks since reset. */
uint32_t motion_clock(void);

/* Orders.  What cannot be done stops motion with a cause. */
void motion_begin(const trochia_begin *order);
void motion_span(const uint8_t *payload, uint8_t size);
void motion_go(void);
void motion_cut(const trochia_cut *order);
void motion_switch(const trochia_put *order);
void motion_watch(const trochia_look *order);
void motion_brake(uint8_t cause);
void motion_stop(uint8_t cause);
void motion_greet(const trochia_hello *hello);

uint16_t motion_room(void);
uint8_t motion_epoch(void);

/* All of a status but `expected`. */
void motion_tell(trochia_status *status);

#endif
