/* An interrupt whose cycles are counted by hand, and what libsimavr 1.6 gets wrong: see test_simulated_chip.py. */
#include <avr/interrupt.h>
#include <avr/io.h>

/* B1 rises 4 cycles of entry and 3 of the vector's jump after the flag; 2 + 2 + 4 cycles later the program goes on. */
ISR(TIMER1_COMPA_vect, ISR_NAKED) {
    __asm__ volatile("sbi %0, 1\n\tcbi %0, 1\n\treti" ::"I"(_SFR_IO_ADDR(PORTB)));
}

/* Wakes the sleeper. */
ISR(TIMER1_COMPB_vect, ISR_NAKED) {
    __asm__ volatile("sbi %0, 2\n\tcbi %0, 2\n\treti" ::"I"(_SFR_IO_ADDR(PORTB)));
}

static void interrupted(void) {
    OCR1A = 40;
    TIMSK1 = 1 << OCIE1A;
    sei();
    __asm__ volatile("sbi %0, 0\n\t"
                     "sts %1, %2\n\t" /* the timer starts */
                     ".rept 100\n\tnop\n\t.endr\n\t"
                     "cbi %0, 0" ::"I"(_SFR_IO_ADDR(PORTB)),
                     "n"(_SFR_MEM_ADDR(TCCR1B)), "r"((uint8_t)(1 << CS10)));
    cli();
    TIMSK1 = 0;
}

/* Flags of one timer are cleared one at a time: C0 tells of A, C1 of B, before and after A is cleared. */
static void flags(void) {
    TCCR1B = 0;
    TCNT1 = 0;
    OCR1A = 10;
    OCR1B = 20;
    TIFR1 = 0xff;
    TCCR1B = 1 << CS10;
    for (uint8_t i = 0; i < 40; i++)
        __asm__ volatile("nop");
    PORTC = TIFR1 >> OCF1A & 3;
    TIFR1 = 1 << OCF1A;
    PORTC = (uint8_t)(4 | (TIFR1 >> OCF1A & 3));
    PORTC = 0;
}

/* A stopped timer keeps its count: C0 rises with its overflow, 100 counts of 8 cycles after the start. */
static void preloaded(void) {
    TCCR0B = 0;
    TCNT0 = 156;
    TIFR0 = 0xff;
    PORTC = 8;
    TCCR0B = 1 << CS01;
    while (!(TIFR0 & 1 << TOV0))
        ;
    PORTC = 0;
    TCCR0B = 0;
}

/* In CTC mode compare value 0 matches on every count. */
static void zero(void) {
    TCCR2A = 1 << WGM21;
    OCR2A = 0;
    TIFR2 = 0xff;
    TCCR2B = 1 << CS20;
    __asm__ volatile("nop\n\tnop\n\tnop\n\tnop");
    PORTC = TIFR2 & 1 << OCF2A ? 16 : 32;
    PORTC = 0;
    TCCR2B = 0;
}

static void asleep(void) {
    TCCR1B = 0;
    TCNT1 = 0;
    OCR1B = 1000;
    TIFR1 = 0xff;
    TIMSK1 = 1 << OCIE1B;
    SMCR = 1 << SE; /* idle */
    sei();
    __asm__ volatile("sbi %0, 0\n\tsts %1, %2\n\tsleep\n\tcbi %0, 0" ::"I"(_SFR_IO_ADDR(PORTB)),
                     "n"(_SFR_MEM_ADDR(TCCR1B)), "r"((uint8_t)(1 << CS10)));
    cli();
    TIMSK1 = 0;
}

/* Sends three bytes without a pause, then leaves what comes unread for a while and sends it back. */
static void talk(void) {
    UBRR0 = 16; /* 115,200 baud with U2X: 17 * 8 cycles a bit */
    UCSR0A = 1 << U2X0;
    UCSR0B = 1 << RXEN0 | 1 << TXEN0;
    for (uint8_t byte = 'a'; byte <= 'c'; byte++) {
        while (!(UCSR0A & 1 << UDRE0))
            ;
        UDR0 = byte;
    }
    for (uint16_t i = 0; i < 10000; i++)
        __asm__ volatile("nop");
    while (UCSR0A & 1 << RXC0) {
        uint8_t byte = UDR0;
        while (!(UCSR0A & 1 << UDRE0))
            ;
        UDR0 = byte;
    }
}

int main(void) {
    DDRB = DDRC = 0xff;
    interrupted();
    flags();
    preloaded();
    zero();
    asleep();
    talk();
    for (;;)
        ;
}
