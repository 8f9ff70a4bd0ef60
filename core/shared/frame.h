/* Framing: bytes of a line in, whole frames out; and the other way round.
 *
 * Consistent-overhead byte stuffing takes every zero out of a frame, so that a zero always ends one and a receiver is
 * in step again after the next zero, whatever was lost.  CRC-16 with polynomial x^16 + x^12 + x^5 + 1, lowest bit
 * first, from 0xffff, sent inverted: over a frame with its CRC it is TROCHIA_CRC_WHOLE, and a zero more or less is
 * seen. */
#ifndef TROCHIA_FRAME_H
#define TROCHIA_FRAME_H

#include <stdint.h>

#include "shared/protocol.h"

#ifndef TROCHIA_FRAME_KNOWN /* a chip with fewer motors gets no longer ones than it can hold */
enum trochia_frame_sizes {
    TROCHIA_FRAME = TROCHIA_PAYLOAD + 4, /* with number, type and CRC */
    TROCHIA_FRAMED = TROCHIA_FRAME + 2   /* with stuffing and the zero */
};
#endif

enum trochia_crc_figures { TROCHIA_CRC_WHOLE = 0xf0b8 };

enum trochia_frame_event { TROCHIA_NOTHING = 0, TROCHIA_WHOLE = 1, TROCHIA_BROKEN = 2 };

/* A frame being received; at TROCHIA_WHOLE bytes[0] is its number, bytes[1] its type, bytes[2 … length - 1] the rest.
 */
typedef struct {
    uint16_t crc;
    uint8_t length; /* bytes so far, CRC included until it is whole */
    uint8_t block;  /* bytes left of the present block */
    uint8_t full;   /* the block does not stand for a zero */
    uint8_t bad;
    uint8_t bytes[TROCHIA_FRAME];
} trochia_frame_in;

static inline uint16_t trochia_crc(uint16_t crc, uint8_t byte) {
    byte = (uint8_t)(byte ^ (uint8_t)crc);
    byte = (uint8_t)(byte ^ (uint8_t)(byte << 4));
    return (uint16_t)((uint16_t)((uint16_t)byte << 8 | crc >> 8) ^ (uint8_t)(byte >> 4) ^ (uint16_t)byte << 3);
}

static inline void trochia_frame_reset(trochia_frame_in *in) {
    in->crc = 0xffff;
    in->length = in->block = in->bad = 0;
    in->full = 1;
}

static inline void trochia_frame_keep(trochia_frame_in *in, uint8_t byte) {
    if (in->length >= TROCHIA_FRAME) {
        in->bad = 1;
        return;
    }
    in->bytes[in->length++] = byte;
    in->crc = trochia_crc(in->crc, byte);
}

/* Takes a byte from the line; returns a trochia_frame_event.  After WHOLE or BROKEN call trochia_frame_reset. */
static inline uint8_t trochia_frame_take(trochia_frame_in *in, uint8_t byte) {
    if (byte == 0) {
        if (in->length == 0 && in->block == 0 && !in->bad)
            return TROCHIA_NOTHING; /* zeros between frames */
        if (in->bad || in->block || in->length < 4 || in->crc != TROCHIA_CRC_WHOLE)
            return TROCHIA_BROKEN;
        in->length = (uint8_t)(in->length - 2);
        return TROCHIA_WHOLE;
    }
    if (in->block == 0) {
        if (!in->full)
            trochia_frame_keep(in, 0);
        in->block = (uint8_t)(byte - 1);
        in->full = byte == 255;
    } else {
        trochia_frame_keep(in, byte);
        in->block--;
    }
    return TROCHIA_NOTHING;
}

/* A frame being sent: bytes are stuffed as they come. */
typedef struct {
    uint8_t *bytes; /* room for TROCHIA_FRAMED */
    uint16_t crc;
    uint8_t length, code; /* code: where the present block's length goes */
} trochia_frame_out;

static inline void trochia_frame_stuff(trochia_frame_out *out, uint8_t byte) {
    if (byte) {
        out->bytes[out->length++] = byte;
        return;
    }
    out->bytes[out->code] = (uint8_t)(out->length - out->code);
    out->code = out->length++;
}

static inline void trochia_frame_put(trochia_frame_out *out, uint8_t byte) {
    out->crc = trochia_crc(out->crc, byte);
    trochia_frame_stuff(out, byte);
}

static inline void trochia_frame_begin(trochia_frame_out *out, uint8_t *bytes, uint8_t number, uint8_t type) {
    out->bytes = bytes;
    out->crc = 0xffff;
    out->code = 0;
    out->length = 1;
    trochia_frame_put(out, number);
    trochia_frame_put(out, type);
}

/* Ends a frame and returns its length on the line. */
static inline uint8_t trochia_frame_end(trochia_frame_out *out) {
    uint16_t crc = (uint16_t)~out->crc;
    trochia_frame_stuff(out, (uint8_t)crc);
    trochia_frame_stuff(out, (uint8_t)(crc >> 8));
    out->bytes[out->code] = (uint8_t)(out->length - out->code);
    out->bytes[out->length++] = 0;
    return out->length;
}

#endif
