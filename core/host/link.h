/* The host's end of the link: frames, by the same code as the chip's, and the schema both were compiled with. */
#ifndef TROCHIA_HOST_LINK_H
#define TROCHIA_HOST_LINK_H

#include <stdint.h>

#include "shared/frame.h"

/* First four bytes of the SHA-256 of protocol.h. */
uint32_t trochia_schema(void);

/* Writes a frame as it goes over the line (TROCHIA_FRAMED bytes at most), and returns its length; 0 for a payload above
 * TROCHIA_PAYLOAD. */
int32_t trochia_frame_make(uint8_t number, uint8_t type, const uint8_t *payload, int32_t size, uint8_t *line);

void trochia_frame_start(trochia_frame_in *in);

/* Takes bytes up to the next frame's end; returns a trochia_frame_event and how many it took.  A frame is to be read
 * from `in` before the next call, which begins with trochia_frame_start. */
int32_t trochia_frame_feed(trochia_frame_in *in, const uint8_t *bytes, int32_t count, int32_t *taken);

#endif
