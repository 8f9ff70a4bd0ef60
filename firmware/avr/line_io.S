/* The line's interrupts, and the clock's, as short as can be, because a step may be due.
 *
 * A byte has come: into the line's ring of 128.  As soon as its place is taken a step may come first, or the next byte.
 * A zero ends a frame: what the time is then is noted, because a status speaks of that instant. */
#include <avr/io.h>
#include "board.h"

#ifndef USART_RX_vect
#define USART_RX_vect USART0_RX_vect
#define USART_TX_vect USART0_TX_vect
#endif

    .text
    .global USART_RX_vect
USART_RX_vect:
    push r30
    in r30, _SFR_IO_ADDR(SREG)
    push r30
    push r24
    lds r24, UDR0
    lds r30, received_head
    push r30
    inc r30
    andi r30, 127
    sts received_head, r30
    tst r24
    breq ends
back:
    pop r30
    sei
    push r31
    clr r31
    subi r30, lo8(-(received))
    sbci r31, hi8(-(received))
    st Z, r24
    pop r31
out:
    pop r24
    pop r30
    out _SFR_IO_ADDR(SREG), r30
    pop r30
    reti
ends:
    .irp byte, 0, 1
    lds r30, TCNT1L + \byte
    sts noted_at + \byte, r30
    lds r30, slice_since + \byte
    sts noted_since + \byte, r30
    .endr
    lds r30, slice_done
    sts noted_slice, r30
    rjmp back

    /* The last byte is out: the next, with a short pause before it, so that steps and bytes that come have their time;
     * or none. */
    .global USART_TX_vect
USART_TX_vect:
    push r30
    in r30, _SFR_IO_ADDR(SREG)
    push r30
    sei
    push r24
    lds r30, send_next
    lds r24, send_end
    cp r30, r24
    breq sent
    inc r30
    sts send_next, r30
    push r31
    clr r31
    subi r30, lo8(-(sending - 1))
    sbci r31, hi8(-(sending - 1))
    ld r24, Z
    sts UDR0, r24
    pop r31
    rjmp out
sent:
    lds r24, UCSR0B
    andi r24, ~(1 << TXCIE0)
    sts UCSR0B, r24
    rjmp out

    /* Timer 1 has gone round. */
    .global TIMER1_OVF_vect
TIMER1_OVF_vect:
    push r30
    in r30, _SFR_IO_ADDR(SREG)
    push r30
    push r24
    lds r24, overflows
    lds r30, overflows + 1
    subi r24, -1
    sbci r30, -1
    sts overflows, r24
    sts overflows + 1, r30
    rjmp out
