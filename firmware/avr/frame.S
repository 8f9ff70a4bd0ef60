/* A frame's bytes taken from the line's ring, unstuffed and summed up in hand-written instructions, 42 cycles each:
 * trochia_frame_take of core/shared/frame.h. */
#include "frames.h"

/* of trochia_frame_in */
#define CRC 0
#define LENGTH 2
#define BLOCK 3
#define FULL 4
#define BAD 5
#define BYTES 6
#define WHOLE 0xf0b8

    .text
    .global frame_run /* (r25:r24 in, r22 most), returns r24.  T: the block does not stand for a zero */
frame_run:
    push r28
    push r29
    movw r28, r24
    lds r23, received_head
    lds r25, received_tail
    mov r24, r23
    sub r24, r25
    andi r24, RECEIVE - 1
    cp r22, r24
    brsh 1f
    mov r23, r25
    add r23, r22
    andi r23, RECEIVE - 1
1:  mov r22, r25 /* from r22 to r23 */
    ldd r18, Y + CRC
    ldd r19, Y + CRC + 1
    ldd r20, Y + LENGTH
    ldd r21, Y + BLOCK
    ldd r24, Y + FULL
    clt
    cpse r24, r1
    set
    movw r26, r28
    adiw r26, BYTES
    add r26, r20
    adc r27, r1
next:
    cp r22, r23
    brne 4f
    rjmp nothing
4:  ldi r30, lo8(received)
    ldi r31, hi8(received)
    add r30, r22
    adc r31, r1
    ld r24, Z
    inc r22
    andi r22, RECEIVE - 1
    tst r24
    breq ends
    tst r21
    breq begins
    dec r21
keep:
    cpi r20, LARGEST + 4
    brsh bad
    st X+, r24
    inc r20
    eor r24, r18
    mov r25, r24
    swap r25
    andi r25, 0xf0
    eor r24, r25
    mov r18, r24
    swap r18
    andi r18, 0x0f
    mov r25, r18
    lsr r25
    eor r18, r19
    mov r19, r24
    eor r19, r25
    lsl r24
    lsl r24
    lsl r24
    eor r18, r24
    rjmp next
begins: /* a block; the one before it stood for a zero, unless it was full */
    mov r21, r24
    dec r21
    brts 3f
    inc r24
    brne 2f
    set
2:  clr r24
    rjmp keep
3:  inc r24
    breq next
    clt
    rjmp next
bad:
    ldi r25, 1
    std Y + BAD, r25
    rjmp next
ends:
    ldd r25, Y + BAD
    mov r24, r20
    or r24, r21
    or r24, r25
    breq next /* zeros between frames */
    or r25, r21
    brne broken
    cpi r20, 4
    brlo broken
    ldi r24, hi8(WHOLE)
    cpi r18, lo8(WHOLE)
    cpc r19, r24
    brne broken
    subi r20, 2
    ldi r24, 1
    rjmp out
broken:
    ldi r24, 2
    rjmp out
nothing:
    ldi r24, 0
out:
    std Y + CRC, r18
    std Y + CRC + 1, r19
    std Y + LENGTH, r20
    std Y + BLOCK, r21
    ldi r25, 0
    bld r25, 0
    std Y + FULL, r25
    sts received_tail, r22
    pop r29
    pop r28
    ret
