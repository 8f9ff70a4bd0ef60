/* What moves: the queue of spans, the time line made of them, and the pins.
 *
 * In: orders, as link.c takes them off the line.  Out: pulses, light, outputs; where things stand. */
#ifndef TROCHIA_MOTION_H
#define TROCHIA_MOTION_H

#include <avr/io.h>

#include "shared/protocol.h"

void motion_setup(void);

/* Goes on with the time line; to be called at least every few hundred microseconds. */
void motion_work(void);

/* Of that only the time line, with less of the stack: it stops nothing. */
void motion_fill(void);

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

/* All of a status but `expected`; it speaks of the instant at which the last frame ended (line_io.S). */
void motion_tell(trochia_status *status);

#endif
