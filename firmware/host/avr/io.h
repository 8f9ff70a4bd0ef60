/* Registers of an ATmega328P that the firmware's C uses, as variables; chip.c does what the hardware does with them. */
#ifndef TROCHIA_HOST_AVR_IO_H
#define TROCHIA_HOST_AVR_IO_H

#include <stdint.h>

extern volatile uint8_t PINB, PINC, PIND, PORTB, PORTC, PORTD, DDRB, DDRC, DDRD;
extern volatile uint8_t PCMSK0, PCMSK1, PCICR, TCCR1B, TCCR2A, TCCR2B, OCR2A, TIMSK1, TIFR1;
extern volatile uint8_t UCSR0A, UCSR0B, UDR0, GPIOR0, GPIOR1, GPIOR2, TCNT2;
extern volatile uint16_t TCNT1, OCR1A, OCR1B, UBRR0;

enum { PCIE0 = 0, PCIE1 = 1, CS10 = 0, CS20 = 0, COM2A1 = 7, WGM20 = 0, WGM21 = 1 };
enum { TOIE1 = 0, OCIE1A = 1, OCIE1B = 2, TOV1 = 0, OCF1A = 1, OCF1B = 2 };
enum { U2X0 = 1, TXC0 = 6, RXCIE0 = 7, TXCIE0 = 6, RXEN0 = 4, TXEN0 = 3 };

#define RAMEND 0 /* nothing is painted here */

#endif
