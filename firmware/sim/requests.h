/* How a caller speaks with a chip, simulated (sim/main.c) or compiled for this computer (host/main.c).
 *
 * A request is a letter, the length of what follows (32 bits) and that; the answer's length (32 bits) and the answer.
 * Little-endian throughout. */
#ifndef TROCHIA_SIM_REQUESTS_H
#define TROCHIA_SIM_REQUESTS_H

#include <stdbool.h>
#include <stdint.h>

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

enum { RUNS = 1, SLEEPS = 2, STOPPED = 3 /* for ever: sleeps without interrupts */, CRASHED = 4 };

/* What answers a run, before the events. */
typedef struct {
    uint64_t cycle;
    uint64_t asleep;     /* cycles spent asleep */
    uint32_t state;      /* RUNS, ... */
    uint32_t interrupts; /* taken */
    uint32_t unread;     /* bytes that have not arrived yet */
    uint32_t events;     /* filled in by the answer */
} status;

/* Adds to what the caller gets with the next status. */
void record(uint64_t cycle, uint8_t kind, uint8_t unit, uint8_t line, uint32_t value);

void answer(const void *bytes, uint32_t size);

/* Answers with the status and with all that was recorded since the last. */
void answer_status(status now);

/* Obeys requests from standard input until there are no more, or one that `obey` does not know (it returns whether to
 * go on).  The eight bytes behind a request are there to be read. */
void obey_requests(bool (*obey)(uint8_t letter, const uint8_t *request, uint32_t size));

#endif
