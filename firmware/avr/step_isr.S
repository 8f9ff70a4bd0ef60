/* The step interrupt of one motor: trochia_segment_step and trochia_segment_bend of core/shared/segment.h in
 * hand-written instructions, with the pulse.  A new segment, intervals longer than a turn of the timer, and a change of
 * direction go the long way, through C.
 *
 * Compare match A of timer 1, which runs freely, is the time of the next step.  It is armed from its own value, so a
 * late interrupt makes the next step no later; a compare value that has gone by when it is set would wait for a whole
 * turn, so such a step is made at once.
 *
 *   step_run    the trochia_segment_run that is executed
 *   step_next   the next one, laid ready by the main program; step_ready says that it is, 1, and is taken back to 0
 *   step_pulse  mask of the step pin in port D; 0 in a pause
 *   GPIOR0      bit 0: the next step takes the long way
 *   step_load() the segment is done and no other is ready;   step_whole()  the long way of a step
 *               both return whether the compare value they leave has gone by
 */
#include <avr/io.h>

#define INTERVAL step_run
#define FRACTION step_run + 4
#define PHASE step_run + 5
#define STRIDE step_run + 6
#define FLAGS step_run + 7
#define LEFT step_run + 8
#define INTERVAL_LOW step_run + 10
#define ADD step_run + 12
#define ADD2 step_run + 16
#define ADD_LOW step_run + 20
#define ADD2_LOW step_run + 22

#define LONG_WAY _SFR_IO_ADDR(GPIOR0), 0
#define MATCH _SFR_IO_ADDR(TIFR1), OCF1A

    .macro restore
    pop r26
    pop r25
    pop r24
    out _SFR_IO_ADDR(SREG), r24
    pop r24
    .endm

    /* \to += \from, with carry unless \with is add */
    .macro sum to, from, with=adc
    lds r24, \to
    lds r25, \from
    \with r24, r25
    sts \to, r24
    .endm

    .text
    .global TIMER1_COMPA_vect
TIMER1_COMPA_vect:
    sbic LONG_WAY
    rjmp whole
    push r24
    in r24, _SFR_IO_ADDR(SREG)
    push r24
    push r25
    push r26
again:
    lds r24, step_pulse
    out _SFR_IO_ADDR(PIND), r24 /* up */
    sum FRACTION, INTERVAL, add
    lds r24, OCR1AL
    lds r25, INTERVAL + 1
    adc r24, r25
    lds r25, OCR1AH
    lds r26, INTERVAL + 2
    adc r25, r26
    sts OCR1AH, r25
    sts OCR1AL, r24
    lds r26, step_pulse
    out _SFR_IO_ADDR(PIND), r26 /* down */
    lds r26, PHASE
    dec r26
    sts PHASE, r26
    breq bend
check: /* r25:r24 is the compare value */
    lds r26, TCNT1L
    sub r24, r26
    lds r26, TCNT1H
    sbc r25, r26
    brmi late
    restore
    reti

late:
    sbi MATCH /* clears it: the step is made now, but no pulse comes closer than 64 cycles to the one before */
    .rept 9
    rjmp .+0
    .endr
    sbis LONG_WAY
    rjmp again
    restore
    rjmp whole

bend:
    lds r24, LEFT
    lds r25, LEFT + 1
    or r24, r25
    brne 0f
    rjmp next /* it was the last stride: nothing to bend */
0:
    sum INTERVAL_LOW, ADD_LOW, add
    sum INTERVAL_LOW + 1, ADD_LOW + 1
    sum INTERVAL, ADD
    sum INTERVAL + 1, ADD + 1
    sum INTERVAL + 2, ADD + 2
    sum INTERVAL + 3, ADD + 3
    tst r24 /* longer than a turn of the timer */
    breq 1f
    sbi LONG_WAY
1:  sum ADD_LOW, ADD2_LOW, add
    sum ADD_LOW + 1, ADD2_LOW + 1
    sum ADD, ADD2
    sum ADD + 1, ADD2 + 1
    sum ADD + 2, ADD2 + 2
    sum ADD + 3, ADD2 + 3
    lds r24, LEFT
    lds r25, LEFT + 1
    lds r26, STRIDE
    sub r24, r26
    sbci r25, 0
    brcc 2f
    add r26, r24 /* fewer are left: those */
    clr r24
    clr r25
2:  sts LEFT, r24
    sts LEFT + 1, r25
    sts PHASE, r26
    lds r24, OCR1AL
    lds r25, OCR1AH
    rjmp check

    /* calls a C function with everything saved that it may change; goes on with the next step where it says so */
    .macro long_way function
    push r0
    in r0, _SFR_IO_ADDR(SREG)
    push r0
    push r1
    .irp register, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 30, 31
    push r\register
    .endr
    clr r1
    call \function
    bst r24, 0 /* the pops leave the T flag alone */
    sbrc r24, 0
    sbi MATCH
    .irp register, 31, 30, 27, 26, 25, 24, 23, 22, 21, 20, 19, 18
    pop r\register
    .endr
    pop r1
    brts 4f
    pop r0
    out _SFR_IO_ADDR(SREG), r0
    pop r0
    reti
4:  pop r0
    out _SFR_IO_ADDR(SREG), r0
    pop r0
    rjmp TIMER1_COMPA_vect
    .endm

next:
    lds r24, step_ready
    tst r24
    brne 0f
    rjmp load
0:  lds r24, FLAGS
    lds r25, step_next + 7
    cpse r24, r25
    sbi LONG_WAY /* another direction: first the step that is armed */
    .irp offset, 0, 1, 2, 3, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23
    lds r24, step_next + \offset
    sts step_run + \offset, r24
    .endr
    lds r24, INTERVAL + 3
    cpi r24, 0
    breq 1f
    sbi LONG_WAY
1:  clr r24
    sts step_ready, r24
    lds r24, OCR1AL
    lds r25, OCR1AH
    rjmp check
load:
    restore
    long_way step_load
whole:
    long_way step_whole
