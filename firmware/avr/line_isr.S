/* The interrupt that makes pulses: entries of the ring (core/shared/pulses.h), each at its tick.
 *
 * Compare match A of timer 1, which runs freely.  It is armed from its own value, so a late interrupt makes the next
 * step no later; a compare value that has gone by when it is set would wait for a whole turn, so such an entry is
 * served at once.  Where the ring is empty it switches itself off.  What it needs is in registers of its own
 * (registers.h).  Entries that are no pulses go to C, line_act(), unless a slice ends or the beam has to go out.
 *
 * The beam's power changes at its own ticks, by compare match B, from a ring behind the other (act.c). */
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
#define TAIL r11
#define KEPT r12 /* and r13: the pointer Z of whatever was interrupted */
#define NOW_LOW r14
#define NOW_HIGH r15
#define ACTS _SFR_IO_ADDR(GPIOR0), 0
#define GRID _SFR_IO_ADDR(GPIOR0), 1
#define MAY_SHINE _SFR_IO_ADDR(GPIOR0), 2
#define MATCH _SFR_IO_ADDR(TIFR1), OCF1A
#define SLOT 128
#define AFTER 45   /* ticks from here to the next match, so that pulses are 64 apart */
#define SOON 21
#define TOO_LATE 4 /* times 256 ticks */
#define FULLY 3    /* TROCHIA_FULLY */
#define BEAMS 16   /* as in motion_parts.h */
#define GONE 0xf0  /* times 256 ticks ahead: that is ticks ago */

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

    /* the pulse's width: as many times three cycles, and one */
    .macro last with
    in \with, _SFR_IO_ADDR(GPIOR1)
9:  dec \with
    brne 9b
    .endm

    /* armed for its tick; or for some ticks from now, where that is later */
    .macro arm ticks, other
    lds r30, TCNT1L
    lds r31, TCNT1H
    adiw r30, \ticks
    cp r30, AT_LOW
    cpc r31, AT_HIGH
    brpl \other
    sts OCR1AH, AT_HIGH
    sts OCR1AL, AT_LOW
    .endm

    .macro return
    movw r30, KEPT
    out _SFR_IO_ADDR(SREG), STATUS
    reti
    .endm

    /* a power above 0 if it may shine; spends r31 and, where that may not be, the power */
    .macro beam power
    sbis MAY_SHINE
    clr \power
#ifdef BEAM_MODE
    clr r31
    cpse \power, r31
    ldi r31, BEAM_ON
    sts BEAM_DUTY, \power
    sts BEAM_MODE, r31
    ldi r31, 255 /* a period begins: the duty counts from here on */
    sts BEAM_COUNT, r31
#else
    sbrc \power, 7
    sbi _SFR_IO_ADDR(BEAM_PORT), BEAM_PIN
    sbrs \power, 7
    cbi _SFR_IO_ADDR(BEAM_PORT), BEAM_PIN
#endif
    .endm

    .text
    .global TIMER1_COMPA_vect
TIMER1_COMPA_vect:
    in STATUS, _SFR_IO_ADDR(SREG)
    movw KEPT, r30
    sbic GRID
    rjmp grid
    raise
    dec COUNT
    breq reload
    add FRACTION, ADD
    adc AT_LOW, LOW
    adc AT_HIGH, HIGH
    arm AFTER, late
armed:
    nop
    last r30
    lower
    return
late:
    sts OCR1AH, r31
    sts OCR1AL, r30
    sub r30, AT_LOW
    sbc r31, AT_HIGH
    cpi r31, TOO_LATE
    brlo armed
    rjmp dry

reload:
    sbic ACTS
    rjmp act
load:
    nop
    last r30
acted:
    mov r30, TAIL
    ldi r31, hi8(step_ring)
    lds NOW_LOW, step_head
    cp NOW_LOW, TAIL
    breq dry
    ld NOW_LOW, Z+
    ld NOW_HIGH, Z+
    add AT_LOW, NOW_LOW
    adc AT_HIGH, NOW_HIGH
    lower
    ld PINS, Z+
    ld COUNT, Z+
    dec COUNT
    breq one
    brmi special
    inc COUNT
    ldi r31, hi8(step_ring) /* the ring goes round between entries' halves, too */
    ld LOW, Z+
    ld HIGH, Z+
    ld ADD, Z+
    ld FRACTION, Z+
    mov TAIL, r30
    rjmp loaded
special:
    clr COUNT
    sbrc PINS, 7
    rjmp slots
    sbi ACTS /* it stays in the ring until it is done */
    clr PINS
    inc COUNT
    rjmp loaded
slots:
    sbi GRID
    mov COUNT, PINS
    ldi r31, 0x7f
    and COUNT, r31
    mov TAIL, r30
    rjmp loaded
one:
    inc COUNT
    mov TAIL, r30
loaded:
    arm SOON, late_load
    return
late_load:
    sbic ACTS /* no pulse, and its tick has gone by: at once */
    rjmp act
    sts OCR1AH, r31
    sts OCR1AL, r30
    sub r30, AT_LOW
    sbc r31, AT_HIGH
    cpi r31, TOO_LATE
    brsh missed
    return
dry:
    lower
missed: /* what is in the ring stays there and counts as not made; motion_work() sees to the rest */
    lds r30, TIMSK1
    andi r30, ~(1 << OCIE1A | 1 << OCIE1B)
    sts TIMSK1, r30
    clr r30
    sts step_on, r30
    return

grid:
    mov r30, TAIL
    ldi r31, hi8(step_ring)
    ld PINS, Z
    raise
    inc TAIL
    dec COUNT
    breq grid_ends
    inc r30
    ld NOW_LOW, Z
    ldi r30, SLOT
    clr r31
    sbrc NOW_LOW, 0
    rjmp gap
next:
    add AT_LOW, r30
    adc AT_HIGH, r31
    arm AFTER, grid_late
    last r30
    lower
    return
grid_late:
    rjmp late
gap: /* slots without pulses */
    inc TAIL
    dec COUNT
    lsr NOW_LOW
    lsr NOW_LOW
    clr NOW_HIGH
    ror NOW_HIGH
    add AT_LOW, NOW_HIGH
    adc AT_HIGH, NOW_LOW
    rjmp next
grid_ends:
    cbi GRID
    ldi r31, 3 /* to the next multiple of four */
    add TAIL, r31
    ldi r31, ~3
    and TAIL, r31
    rjmp load

act:
    cbi ACTS
    mov r30, TAIL
    subi r30, -2
    ldi r31, hi8(step_ring)
    ld NOW_LOW, Z
    mov r31, NOW_LOW
    cpi r31, FULLY
    breq fully
    tst NOW_LOW
    brne whole
    sts slice_since, AT_LOW /* a mark */
    sts slice_since + 1, AT_HIGH
    lds r30, slice_done
    inc r30
    sts slice_done, r30
done:
    ldi r30, 8
    add TAIL, r30
    rjmp acted
fully: /* the rate is full, or no longer: then the beam goes out */
    subi r30, -2
    ldi r31, hi8(step_ring)
    ld NOW_LOW, Z
    tst NOW_LOW
    brne whole
    cbi MAY_SHINE
    beam NOW_LOW
    rjmp done
whole:
    movw r30, KEPT
    push r0
    push r1
    .irp register, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 30, 31
    push r\register
    .endr
    clr r1
    call line_act
    .irp register, 31, 30, 27, 26, 25, 24, 23, 22, 21, 20, 19, 18
    pop r\register
    .endr
    pop r1
    pop r0
    movw KEPT, r30
    rjmp load

    .global TIMER1_COMPB_vect
TIMER1_COMPB_vect: /* never within the other, so it uses its registers */
    in STATUS, _SFR_IO_ADDR(SREG)
    movw KEPT, r30
shine:
    in r30, _SFR_IO_ADDR(GPIOR2)
    ldi r31, hi8(step_ring + 256)
    ldd NOW_LOW, Z + 2 * BEAMS
    sts span_power, NOW_LOW
    beam NOW_LOW
    inc r30
    andi r30, BEAMS - 1
    out _SFR_IO_ADDR(GPIOR2), r30
    lds NOW_LOW, beam_head
    cp NOW_LOW, r30
    breq none
    ldi r31, hi8(step_ring + 256)
    ld NOW_LOW, Z
    ldd NOW_HIGH, Z + BEAMS
    sts OCR1BH, NOW_HIGH
    sts OCR1BL, NOW_LOW
    lds r30, TCNT1L
    lds r31, TCNT1H
    sub NOW_LOW, r30
    sbc NOW_HIGH, r31
    mov r30, NOW_HIGH
    cpi r30, GONE
    brsh gone
shone:
    return
gone: /* its tick has gone by: now */
    ldi r30, 1 << OCF1B
    out _SFR_IO_ADDR(TIFR1), r30
    rjmp shine
none:
    lds r30, TIMSK1
    andi r30, ~(1 << OCIE1B)
    sts TIMSK1, r30
    rjmp shone
