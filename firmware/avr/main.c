/* An image for a board: nothing moves and no drive is on at reset; then line and motion take turns. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/wdt.h>

#include "board.h"
#include "link.h"
#include "motion.h"
#include "registers.h"

/* Paints the memory that has no use yet, so that the deepest stack can be told. */
void paint(void) __attribute__((naked, used, section(".init3")));
void paint(void) {
    __asm__ volatile(
        "ldi r30, lo8(_end)\n ldi r31, hi8(_end)\n ldi r24, 0xa5\n"
        "1: st Z+, r24\n cpi r30, lo8(%0)\n ldi r25, hi8(%0)\n cpc r31, r25\n brlo 1b\n" ::"i"(RAMEND + 1));
}

int main(void) {
    uint8_t reset_flags = MCUSR;
    MCUSR = 0;
    wdt_enable(WDTO_250MS);
    board_setup();
    motion_setup();
    link_setup(reset_flags);
    sei();
    for (;;) {
        wdt_reset();
        link_work();
        motion_work();
    }
}
