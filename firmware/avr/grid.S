/* Slots of the grid in hand-written instructions: trochia_row_place, trochia_row_clear and trochia_slots_pack of
 * core/shared/pulses.h, and the steps that slots hold. */
#include <avr/io.h>

/* of trochia_row */
#define REAL 0
#define INTERVAL 4
#define UNTIL 12
#define BASE 14
#define FREE 15
#define STOP 16
#define PIN 17

    .text
    .global row_place /* (r25:r24 row, r22 most), returns r24 */
row_place:
    .irp register, 16, 17, 28, 29, 22
    push r\register
    .endr
    movw r30, r24
    ldd r18, Z + REAL
    ldd r19, Z + REAL + 1
    ldd r20, Z + REAL + 2
    ldd r21, Z + INTERVAL
    ldd r23, Z + INTERVAL + 1
    ldd r24, Z + INTERVAL + 2
    ldd r25, Z + UNTIL
    ldd r28, Z + UNTIL + 1
    ldd r29, Z + BASE
    ldd r16, Z + FREE
    ldd r17, Z + STOP
    ldd r0, Z + PIN
    ldi r27, hi8(step_ring)
1:  mov r26, r19 /* the slot: bits 15 to 22 */
    lsl r26
    mov r26, r20
    rol r26
    cp r26, r16
    brsh 2f
    mov r26, r16
2:  cp r26, r17
    brsh 3f
    mov r16, r26
    inc r16
    add r26, r29
    ld r1, X
    or r1, r0
    st X, r1
    add r18, r21
    adc r19, r23
    adc r20, r24
    dec r22
    breq 3f
    cp r19, r25
    cpc r20, r28
    brlo 1b
3:  std Z + FREE, r16
    std Z + REAL, r18
    std Z + REAL + 1, r19
    std Z + REAL + 2, r20
    clr r1
    pop r24
    sub r24, r22
    .irp register, 29, 28, 17, 16
    pop r\register
    .endr
    ret

    .global row_clear /* (r24 place, r22 count), at least count bytes, at most seven more */
row_clear:
    mov r26, r24
    ldi r27, hi8(step_ring)
    add r24, r22
    brcs 2f
    cpi r24, 249
    brsh 2f
1:  .rept 8
    st X+, r1
    .endr
    subi r22, 8
    brcs 3f
    brne 1b
    ret
2:  .rept 4 /* round the ring's end */
    st X, r1
    inc r26
    .endr
    subi r22, 4
    brcs 3f
    brne 2b
3:  ret

    .global slots_count /* (r24 place, r22 bytes above 0, r21:r20 counts of pins 1 to 7) */
slots_count:
    push r20
    push r21
    mov r26, r24
    ldi r27, hi8(step_ring)
    .irp register, 18, 19, 20, 21, 23, 24, 25
    clr r\register
    .endr
1:  ld r0, X
    inc r26
    sbrc r0, 0
    rjmp 2f
    .macro counted pin, register
    sbrc r0, \pin
    inc \register
    .endm
    counted 1, r18
    counted 2, r19
    counted 3, r20
    counted 4, r21
    counted 5, r23
    counted 6, r24
    counted 7, r25
2:  dec r22
    brne 1b
    pop r31
    pop r30
    .irp register, 18, 19, 20, 21, 23, 24, 25
    st Z+, r\register
    .endr
    ret

    .global slots_pack /* (r24 to, r22 from, r20 slots), returns r24: trochia_slots_pack */
slots_pack:
    mov r26, r22
    mov r30, r24
    ldi r27, hi8(step_ring)
    ldi r31, hi8(step_ring)
1:  ld r0, X
    inc r26
    tst r0
    breq 3f
2:  st Z, r0
    inc r30
    dec r20
    brne 1b
    sub r30, r24
    mov r24, r30
    ret
3:  ldi r18, 1
4:  subi r18, -2 /* one more; the last slot has pulses */
    dec r20
    ld r0, X
    inc r26
    tst r0
    breq 4b
    st Z, r18
    inc r30
    rjmp 2b
