/* Sleeps with interrupts off: nothing but a reset wakes it. */
#include <avr/interrupt.h>
#include <avr/io.h>

int main(void) {
    cli();
    SMCR = 1 << SE;
    __asm__ volatile("sleep");
    return 0;
}
