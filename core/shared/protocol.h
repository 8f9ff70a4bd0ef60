/* What host and chip say to each other.  This file is the schema: its hash is compiled into both sides and exchanged
 * at hello.  All figures are little endian; structs are laid out so that no compiler pads them.
 *
 * A frame is: sequence number, type, payload, CRC-16 (inverted); byte-stuffed (frame.h), ended by a zero.  Orders that
 * must come in order and once (types below TROCHIA_LOOSE) are numbered; the chip takes the one it expects, and tells
 * which that is in every frame it sends.  The others are idempotent: lost ones are sent again.
 *
 * Legend: tick = of the chip's clock; stream time = ticks of planned motion since BEGIN; rate = stream time a tick,
 * 2^-15; slice = 2^14 ticks, in which the rate is constant. */
#ifndef TROCHIA_PROTOCOL_H
#define TROCHIA_PROTOCOL_H

#include <stdint.h>

#include "shared/segment.h"

enum trochia_sizes {
    TROCHIA_MOTORS = 6,
    TROCHIA_PAYLOAD = 132, /* greatest: a span with six motors */
    TROCHIA_SLICE = 16384,
    TROCHIA_FULL_RATE = 32768
};

enum trochia_frame_type {
    TROCHIA_SPAN = 1,    /* trochia_span, a trochia_part for each motor it moves, trochia_pixels */
    TROCHIA_BEGIN = 2,   /* trochia_begin: an empty queue, stream time 0; only at rest */
    TROCHIA_GO = 3,      /* run through what is held */
    TROCHIA_CUT = 4,     /* trochia_cut: a span ends earlier, those after it are dropped */
    TROCHIA_SWITCH = 5,  /* trochia_put: drives, light, outputs */
    TROCHIA_WATCH = 6,   /* trochia_look: brake at inputs */
    TROCHIA_BRAKE = 7,   /* slow the rate to 0 and drop what is left */
    TROCHIA_LOOSE = 64,  /* from here on: not numbered */
    TROCHIA_HELLO = 64,  /* trochia_hello; numbers begin at 0 again */
    TROCHIA_ASK = 65,    /* asks for a status */
    TROCHIA_HALT = 66,   /* stop at once: no steps, no light, drives off where the payload's byte is 1 */
    TROCHIA_ANSWER = 96, /* chip to host: trochia_answer to a hello */
    TROCHIA_STATUS = 97, /* trochia_status */
    TROCHIA_ACK = 98,    /* trochia_ack, to orders */
    TROCHIA_ROOM = 99    /* trochia_ack, unasked: there is room for a largest span again */
};

enum trochia_span_flag {
    TROCHIA_AT_REST = 1,     /* every motor is at rest where it ends */
    TROCHIA_SET_OUTPUTS = 2, /* `outputs` are put at its start */
    TROCHIA_PIXEL = 4        /* times how many trochia_pixels there are */
};

enum trochia_state {
    TROCHIA_IDLE = 0,    /* nothing held or moving */
    TROCHIA_LOADING = 1, /* between BEGIN and GO */
    TROCHIA_RUNNING = 2,
    TROCHIA_STOPPED = 3 /* it ended before what was held did; see cause */
};

enum trochia_cause {
    TROCHIA_NO_CAUSE = 0,
    TROCHIA_ORDERED = 1,  /* BRAKE or STOP */
    TROCHIA_LOW = 2,      /* the queue ran low and did not end at rest */
    TROCHIA_SILENCE = 3,  /* nothing was heard from the host */
    TROCHIA_CAUGHT = 4,   /* a watched input */
    TROCHIA_MISSED = 5,   /* a step could not be made in time */
    TROCHIA_LATE_CUT = 6, /* what was to be cut was on its way to the pins */
    TROCHIA_BAD_SPAN = 7, /* a span that cannot be held or is out of order */
    TROCHIA_ESTOP = 8     /* the emergency stop's input */
};

/* A stretch of time, and how each motor moves in it. */
typedef struct {
    uint32_t duration; /* stream time, 1 to 2^23 */
    uint16_t number;   /* one more than the span's before */
    uint16_t slew;     /* of the rate, 2^-15 a slice */
    uint8_t power;     /* of the beam at full rate, up to the first pixel */
    uint8_t flags;     /* trochia_span_flag */
    uint8_t motors;    /* a bit for each that makes steps */
    uint8_t outputs;
} trochia_span;

/* One motor's steps in a span: the first, then a tick segment of the others. */
typedef struct {
    uint32_t first;             /* from the span's start to the first step [2^-8 ticks] */
    trochia_tick_segment steps; /* count may be 0 */
} trochia_part;

/* The beam's power changes within a span. */
typedef struct {
    uint8_t after; /* the pixel before it, or the span's start [2^7 ticks of stream time] */
    uint8_t power; /* of the beam at full rate from then on */
} trochia_pixel;

typedef struct {
    uint8_t epoch;  /* told in status */
    uint8_t number; /* must be 0 */
} trochia_begin;

typedef struct {
    uint32_t duration; /* of the span from now on; 0: it is dropped as well */
    uint16_t number;   /* of the span; spans are counted on from here */
    uint8_t flags;     /* of the span from now on */
    uint8_t reserved;
} trochia_cut;

typedef struct {
    uint8_t enable;  /* drives: 0 off, 1 on, 255 as it is */
    uint8_t lit;     /* whether spans may light the beam; likewise */
    uint8_t mask;    /* of outputs to put */
    uint8_t outputs; /* their levels */
} trochia_put;

typedef struct {
    uint8_t mask;   /* inputs at which to brake; each is caught once */
    uint8_t levels; /* at this level */
} trochia_look;

typedef struct {
    uint32_t schema;  /* hash of this file */
    uint16_t silence; /* slices without a frame until it brakes */
    uint8_t turned;   /* motors whose direction is reversed */
    uint8_t estop;    /* inputs that stop at once when low, a bit each */
    uint8_t width;    /* of a pulse, beyond the least, in three ticks */
    uint8_t session;  /* another than before: numbers begin anew; the same: only an answer is asked for again */
    uint8_t reserved[2];
} trochia_hello;

/* The schema comes first in every version. */
typedef struct {
    uint32_t schema;
    uint32_t clock;  /* ticks a second */
    uint16_t room;   /* bytes of the queue */
    uint16_t free;   /* bytes of memory that were never used */
    uint8_t motors;  /* that it has */
    uint8_t inputs;  /* that it has */
    uint8_t outputs; /* that it has */
    uint8_t reset;   /* why it was reset last: the chip's own bits */
    uint8_t board[12];
    uint8_t session;  /* of the hello */
    uint8_t expected; /* sequence number of the next order; not 0 where the session's number was in use already */
    uint8_t payload;  /* greatest it takes */
    uint8_t reserved;
} trochia_answer;

typedef struct {
    uint8_t expected; /* sequence number of the next order */
    uint8_t epoch;
    uint16_t room; /* free bytes of the queue */
} trochia_ack;

typedef struct {
    uint8_t expected;
    uint8_t epoch;
    uint16_t room;
    uint32_t clock;                   /* chip's time when this was made */
    uint32_t executed;                /* stream time run through */
    uint32_t caught_at;               /* stream time at which a watched input took its level */
    int32_t position[TROCHIA_MOTORS]; /* steps made since reset: in motion those at the slice's start */
    uint16_t rate;
    uint16_t number; /* span under way */
    uint8_t state;
    uint8_t cause;
    uint8_t inputs;
    uint8_t outputs;
    uint8_t beam;
    uint8_t enabled;
    uint8_t caught; /* inputs that were caught, a bit each */
    uint8_t worst;  /* latest step so far [16 ticks] */
} trochia_status;

#endif
