/* The interrupt that makes pulses: entries of the ring (core/shared/timeline.h), each at its tick.
 *
 * Compare match A of timer 1, which runs freely.  It is armed from its own value, so a late interrupt makes the next
 * step no later; a compare value that has gone by when it is set would wait for a whole turn, so such an entry is
 * served at once.  Where the ring is empty it switches itself off.  What it needs is in registers of its own
 * (registers.h); entries that are no pulses go to C, line_act(). */
#include <avr/io.h>
#include "board.h"

#define PINS r2
#define FRACTION r3
#define ADD r4
#define LOW r5
#define HIGH r6
#define COUNT r7
#define AT_LOW r8
#define AT_HIGH r9
#define STATUS r10
#define NOW_LOW r11
#define NOW_HIGH r12
#define TAIL r13
#define ACTS _SFR_IO_ADDR(GPIOR0), 0
#define MATCH _SFR_IO_ADDR(TIFR1), OCF1A

#ifdef BOARD_COILS /* a pulse is a call, and over when it returns */
    .macro raise
    tst PINS
    breq 1f
    call coils_enter
1:
    .endm
    .macro lower
    .endm
#else
    .macro raise
    out _SFR_IO_ADDR(BOARD_STEPS), PINS
#ifdef BOARD_FOURTH
    sbrc PINS, BOARD_FOURTH
    sbi _SFR_IO_ADDR(PINB), 4
#endif
    .endm
    .macro lower
    raise
    .endm
#endif

    .macro wait cycles
    .rept \cycles / 2
    rjmp .+0
    .endr
    .endm

    .text
    .global TIMER1_COMPA_vect
TIMER1_COMPA_vect:
    in STATUS, _SFR_IO_ADDR(SREG)
again:
    raise
    dec COUNT
    breq reload
    add FRACTION, ADD
    adc AT_LOW, LOW
    adc AT_HIGH, HIGH
    sts OCR1AH, AT_HIGH
    sts OCR1AL, AT_LOW
    wait 12
    lower
    lds NOW_LOW, TCNT1L
    lds NOW_HIGH, TCNT1H
    cp AT_LOW, NOW_LOW
    cpc AT_HIGH, NOW_HIGH
    brmi late
    out _SFR_IO_ADDR(SREG), STATUS
    reti
late:
    sbi MATCH /* clears it: it is served now, but no pulse comes closer than 64 cycles to the one before */
    wait 24
    rjmp again

reload:
    sbic ACTS
    rjmp act
load:
    push r30
    push r31
    mov r30, TAIL
    ldi r31, hi8(step_ring)
    lds NOW_LOW, step_head
    cp NOW_LOW, TAIL
    breq dry
    ld NOW_LOW, Z+
    ld NOW_HIGH, Z+
    add AT_LOW, NOW_LOW
    adc AT_HIGH, NOW_HIGH
    sts OCR1AH, AT_HIGH
    sts OCR1AL, AT_LOW
    lower
    ld PINS, Z+
    ld COUNT, Z+
    dec COUNT
    breq one
    brmi special
    inc COUNT
    ld LOW, Z+
    ld HIGH, Z+
    ld ADD, Z+
    ld FRACTION, Z+
    mov TAIL, r30
    rjmp loaded
special: /* it stays in the ring until it is done */
    sbi ACTS
    clr COUNT
    clr PINS
one:
    inc COUNT
    sbis ACTS
    mov TAIL, r30
loaded:
    pop r31
    pop r30
    lds NOW_LOW, TCNT1L
    lds NOW_HIGH, TCNT1H
    cp AT_LOW, NOW_LOW
    cpc AT_HIGH, NOW_HIGH
    brmi overdue
    out _SFR_IO_ADDR(SREG), STATUS
    reti
overdue:
    sbi MATCH
    rjmp again
dry:
    wait 8
    lower
    clr PINS
    lds r30, TIMSK1
    andi r30, ~(1 << OCIE1A)
    sts TIMSK1, r30
    clr r30
    sts step_on, r30
    pop r31
    pop r30
    out _SFR_IO_ADDR(SREG), STATUS
    reti

act:
    push r0
    push r1
    .irp register, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 30, 31
    push r\register
    .endr
    clr r1
    cbi ACTS
    call line_act
    .irp register, 31, 30, 27, 26, 25, 24, 23, 22, 21, 20, 19, 18
    pop r\register
    .endr
    pop r1
    pop r0
    rjmp load
