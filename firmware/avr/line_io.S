/* The line's two interrupts, as short as can be, because a step may be due.
 *
 * A byte has come: into the line's ring of 128.  A zero ends a frame: what
 * the time is then is noted, because a status speaks of that instant. */
#include <avr/io.h>
#include "board.h"

#ifndef USART_RX_vect
#define USART_RX_vect USART0_RX_vect
#define USART_UDRE_vect USART0_UDRE_vect
#endif

    .text
    .global USART_RX_vect
USART_RX_vect:
    push r30
    in r30, _SFR_IO_ADDR(SREG)
    push r30
    push r31
    push r24
    lds r30, received_head
    lds r24, UDR0
    mov r31, r30
    inc r31
    andi r31, 127
    sts received_head, r31
    clr r31
    subi r30, lo8(-(received))
    sbci r31, hi8(-(received))
    st Z, r24
    tst r24
    breq ends
back:
    pop r24
    pop r31
    pop r30
    out _SFR_IO_ADDR(SREG), r30
    pop r30
    reti
ends:
    .irp byte, 0, 1
    lds r24, TCNT1L + \byte
    sts noted_at + \byte, r24
    lds r24, slice_since + \byte
    sts noted_since + \byte, r24
    .endr
    lds r24, slice_done
    sts noted_slice, r24
    rjmp back

    /* The next byte goes out; after the last it switches itself off. */
    .global USART_UDRE_vect
USART_UDRE_vect:
    push r30
    in r30, _SFR_IO_ADDR(SREG)
    push r30
    push r31
    push r24
    lds r30, send_next
    inc r30
    sts send_next, r30
    lds r31, send_end
    sub r31, r30
    brne 1f
    lds r24, UCSR0B
    andi r24, ~(1 << UDRIE0)
    sts UCSR0B, r24
1:  clr r31
    subi r30, lo8(-(sending - 1))
    sbci r31, hi8(-(sending - 1))
    ld r24, Z
    sts UDR0, r24
    rjmp back
