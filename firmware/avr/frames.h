/* Bytes that have come, and the frame they make. */
#ifndef TROCHIA_FRAMES_H
#define TROCHIA_FRAMES_H

#include "board.h"

#define RECEIVE 128 /* bytes of the line's ring */
#if BOARD_MOTORS > 4
#define LARGEST (12 + 20 * BOARD_MOTORS) /* payload: a span of all motors */
#else
#define LARGEST (12 + 20 * 4) /* with room for pixels where there are few motors */
#endif

#ifndef __ASSEMBLER__
#define TROCHIA_FRAME_KNOWN
enum { TROCHIA_FRAME = LARGEST + 4 };
#include "shared/frame.h"

extern volatile uint8_t received[RECEIVE], received_head; /* line_io.S */
extern uint8_t received_tail;

/* trochia_frame_take for at most so many of the bytes that have come, up to the first event; returns that (frame.S). */
uint8_t frame_run(trochia_frame_in *in, uint8_t most);
#endif

#endif
