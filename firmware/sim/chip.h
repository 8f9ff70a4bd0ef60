/* A simulated AVR chip whose clock the caller owns: libsimavr's core, with serial port and timers replaced by models
 * of our own, because those of libsimavr 1.6 differ from the chip where it matters for step pulses.
 *
 * Legend: cycle = processor cycles since reset; edge = a pin's change of level, stamped with the cycle at which the
 * instruction that made it began. */
#ifndef TROCHIA_SIM_CHIP_H
#define TROCHIA_SIM_CHIP_H

#include <stdbool.h>
#include <stdint.h>

#include <simavr/avr_ioport.h>
#include <simavr/avr_timer.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>

enum { TIMERS = 6, MATCHES = 3, FIFO = 2 };

/* What happened, as the caller gets it. */
typedef struct {
    uint64_t cycle;
    uint8_t kind; /* EVENT_... */
    uint8_t unit; /* port letter, serial port's or timer's digit */
    uint8_t line; /* pin of the port, channel of the timer */
    uint8_t reserved;
    uint32_t value;
} event;

enum event_kind {
    EVENT_PIN = 1,  /* an output's level */
    EVENT_BYTE = 2, /* a byte has left the serial port, with its stop bit */
    EVENT_PWM = 3,  /* a timer's channel drives its pin: value is its compare value, and its top in the upper half */
    EVENT_LOST = 4  /* a received byte was lost: the receiver held two already (value 0) or was off (value 1) */
};

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

/* Adds to what the caller gets. */
void record(uint64_t cycle, uint8_t kind, uint8_t unit, uint8_t line, uint32_t value);

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
