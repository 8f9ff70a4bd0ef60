/* Interrupts are functions that chip.c calls. */
#ifndef TROCHIA_HOST_AVR_INTERRUPT_H
#define TROCHIA_HOST_AVR_INTERRUPT_H

#define ISR(vector, ...)                                                                                               \
    void vector(void);                                                                                                 \
    void vector(void) __VA_ARGS__
#define ISR_ALIASOF(vector) __attribute__((alias(#vector)))

#endif
