/* Arduino Mega 2560 (ATmega2560) with step/direction drivers.  X, Y, Z, limits, beam and coolant are wired as is
 * common on this board; only the drives' enable is not, because its usual pin is the one the bootloader blinks.
 *
 *   step X Y Z A B C       D24 D25 D26 D27 D28 D29     enable (low: on)    D38
 *   direction X Y Z A B C  D30 D31 D32 D33 D34 D35     beam                D7, PWM
 *   inputs 0 … 7           D10 D11 D12 A8 A9 A10 A11 A15, with pull-ups
 *   outputs 0 … 3          D8 D9 D6 D5
 *
 * An entry's pin bits are those of port A. */
#ifndef TROCHIA_BOARD_H
#define TROCHIA_BOARD_H

#define BOARD_MOTORS 6
#define BOARD_INPUTS 8
#define BOARD_OUTPUTS 4
#define BOARD_QUEUE 1536
#define BOARD_STEPS PINA
#define BEAM_DUTY OCR4BL
#define BEAM_MODE TCCR4A
#define BEAM_COUNT TCNT4L
#define BEAM_ON (1 << COM4B1 | 1 << WGM40)

#ifndef __ASSEMBLER__
#include <avr/io.h>

#define USART_RX_vect USART0_RX_vect /* it has four serial ports; this one is on the USB */
#define USART_TX_vect USART0_TX_vect

static const char board_name[12] = "mega-stepdir";
static const uint8_t board_pins[BOARD_MOTORS] = {1 << 2, 1 << 3, 1 << 4, 1 << 5, 1 << 6, 1 << 7};
static const uint8_t board_bits[BOARD_MOTORS] = {2, 3, 4, 5, 6, 7}; /* the same, counted */

static inline void board_setup(void) {
    PORTD = 1 << 7; /* drives off */
    DDRD = 1 << 7;
    DDRA = 0xfc;
    DDRC = 0xfc;
    PORTB = 1 << 4 | 1 << 5 | 1 << 6; /* pull-ups */
    PORTK = 1 << 0 | 1 << 1 | 1 << 2 | 1 << 3 | 1 << 7;
    DDRH = 1 << 3 | 1 << 4 | 1 << 5 | 1 << 6;
    PORTE = 1 << 0;
    DDRE = 1 << 3;
    PCMSK0 = 1 << 4 | 1 << 5 | 1 << 6;
    PCMSK2 = 1 << 0 | 1 << 1 | 1 << 2 | 1 << 3 | 1 << 7;
    PCICR = 1 << PCIE0 | 1 << PCIE2;
    TCCR4B = 1 << WGM42 | 1 << CS40;
}

static inline void board_enable(uint8_t on) {
    if (on)
        PORTD &= (uint8_t)~(1 << 7);
    else
        PORTD |= 1 << 7;
}

/* Motors whose direction changes; the first one's is the highest pin. */
static inline void board_turn(uint8_t motors) {
    uint8_t pins = 0;
    for (uint8_t i = 0; i < BOARD_MOTORS; i++) {
        pins = (uint8_t)(pins >> 1 | (motors & 1 << 5) << 2);
        motors = (uint8_t)(motors << 1);
    }
    PINC = pins;
}

static inline uint8_t board_inputs(void) {
    uint8_t b = PINB, k = PINK;
    return (uint8_t)((b >> 4 & 7) | (k & 15) << 3 | (k & 1 << 7));
}

static inline void board_outputs(uint8_t levels) {
    PORTH = (uint8_t)((PORTH & ~(1 << 3 | 1 << 5 | 1 << 6)) | (levels & 3) << 5 | (levels & 4) << 1);
    if (levels & 8)
        PORTE |= 1 << 3;
    else
        PORTE &= (uint8_t)~(1 << 3);
}

/* The beam's power, 0 … 255, by fast PWM of timer 4 on D7; a period begins with it, so that it is there at once. */
static inline void board_beam(uint8_t power) {
    if (power) {
        OCR4B = power;
        TCCR4A = BEAM_ON;
        TCNT4 = 255;
    } else {
        TCCR4A = 0; /* the pin is the port's again, and that is low */
    }
}

static inline uint8_t board_beam_power(void) {
    return TCCR4A ? OCR4BL : 0;
}
#endif

#endif
