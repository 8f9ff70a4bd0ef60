/* What else the simulated chip is asked for: a missed compare value, PWM, an analogue input.  See
 * test_simulated_chip.py. */
#include <avr/io.h>

volatile uint16_t voltage;

/* B0 is up from when compare value 500 is written, the counter past 1000, until it matches. */
static void missed(void) {
    OCR1A = 60000;
    TCNT1 = 1000;
    TCCR1B = 1 << WGM12 | 1 << CS10;
    PORTB = 1;
    OCR1A = 500;
    TIFR1 = 1 << OCF1A;
    while (!(TIFR1 & 1 << OCF1A))
        ;
    PORTB = 0;
    TCCR1B = 0;
}

/* Fast PWM of timer 2 on its channel A: a quarter, then three quarters; channel B drives no pin. */
static void pwm(void) {
    OCR2A = 64;
    OCR2B = 10;
    TCCR2A = 1 << COM2A1 | 1 << WGM21 | 1 << WGM20;
    TCCR2B = 1 << CS20;
    OCR2A = 192;
}

static void measure(void) {
    ADMUX = 1 << REFS0 | 3;
    ADCSRA = 1 << ADEN | 1 << ADSC | 7;
    while (ADCSRA & 1 << ADSC)
        ;
    voltage = ADC;
}

int main(void) {
    DDRB = 0xff;
    missed();
    pwm();
    for (;;)
        measure();
}
