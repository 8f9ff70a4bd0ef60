/* A simulated AVR chip whose clock the caller owns: libsimavr's core, with serial port and timers replaced by models
 * of our own, because those of libsimavr 1.6 differ from the chip where it matters for step pulses.
 *
 * Legend: cycle = processor cycles since reset; edge = a pin's change of level, stamped with the cycle at which the
 * instruction that made it began. */
#ifndef TROCHIA_SIM_CHIP_H
#define TROCHIA_SIM_CHIP_H

#include "requests.h"

#include <simavr/avr_ioport.h>
#include <simavr/avr_timer.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>

enum { TIMERS = 6, MATCHES = 3, FIFO = 2 };

typedef struct {
    uint8_t *bytes;
    uint64_t *not_before;
    uint32_t head, tail, room;
} byte_queue;

typedef struct {
    avr_t *avr;
    avr_uart_t *port;
    uint8_t fifo[FIFO], held;
    uint64_t shifting_until; /* the transmitter's shift register is busy until then */
    uint8_t shifting, waiting;
    bool waits, sends;
    byte_queue coming;
    bool arriving;
    uint64_t arrives;
} serial;

typedef struct {
    avr_t *avr;
    avr_timer_t *timer;
    uint64_t since; /* cycle at which the count was `from` */
    uint32_t from, top, most;
    uint32_t divider; /* cycles a count; 0: stopped */
    uint32_t match[MATCHES];
    bool pwm, wraps_at_top;
} clock_unit;

/* Replaces libsimavr's model of a serial port. */
void serial_take(serial *unit, avr_t *avr, avr_uart_t *port);

/* Bytes for the chip, none of which begins before a cycle. */
void serial_feed(serial *unit, const uint8_t *bytes, uint32_t count, uint64_t not_before);

/* Bytes that have not arrived yet. */
uint32_t serial_left(const serial *unit);

/* Mends how libsimavr writes to a port's pin register. */
void ports_take(avr_t *avr, avr_ioport_t *port);

/* Replaces libsimavr's model of a timer. */
void clock_take(clock_unit *unit, avr_t *avr, avr_timer_t *timer);

#endif
