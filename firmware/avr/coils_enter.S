/* From the step interrupt into C: everything is saved that C may change, but the status register, which the interrupt
 * keeps itself. */
    .text
    .global coils_enter
coils_enter: /* motors in r2, from bit 1 on */
    push r0
    push r1
    .irp register, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 30, 31
    push r\register
    .endr
    clr r1
    mov r24, r2
    lsr r24
    call coils_step
    .irp register, 31, 30, 27, 26, 25, 24, 23, 22, 21, 20, 19, 18
    pop r\register
    .endr
    pop r1
    pop r0
    ret
