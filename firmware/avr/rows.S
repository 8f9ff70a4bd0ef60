/* A motor's steps into slots in hand-written instructions, 27 cycles each, 120 more where the interval changes: most of
 * trochia_timeline_row of core/shared/pulses.h, and trochia_segment_bend. */
#include <avr/io.h>

/* of trochia_row */
#define REAL 0
#define INTERVAL 4
#define BOUND 8
#define UNTIL 12
#define BASE 14
#define FREE 15
#define STOP 16
#define PIN 17
#define LAST 18
#define EXTRA 19

/* of trochia_motor */
#define M_DUE 0
#define M_INTERVAL 4
#define M_PHASE 9
#define M_STRIDE 10
#define M_FLAGS 11
#define M_LEFT 12
#define M_INTERVAL_LOW 14
#define M_ADD 16
#define M_ADD2 20
#define M_ADD_LOW 24
#define M_ADD2_LOW 26
#define M_POSITION 28

    /* Y + \to += Y + \from, with carry unless \with is add; leaves the sum's byte in r26 */
    .macro sum to, from, with=adc
    ldd r26, Y + \to
    ldd r27, Y + \from
    \with r26, r27
    std Y + \to, r26
    .endm

    .text
    /* phase r0 as it is now; what was made of it goes to the position */
    .macro note_phase
    ldd r26, Y + M_PHASE
    std Y + M_PHASE, r0
    sub r26, r0
    clr r27
    ldd r1, Y + M_FLAGS
    ldd r21, Y + M_POSITION
    ldd r22, Y + M_POSITION + 1
    ldd r23, Y + M_POSITION + 2
    ldd r0, Y + M_POSITION + 3
    sbrs r1, 0
    rjmp 8f
    sub r21, r26
    sbc r22, r27
    sbc r23, r27
    sbc r0, r27
    rjmp 9f
8:  add r21, r26
    adc r22, r27
    adc r23, r27
    adc r0, r27
9:  std Y + M_POSITION, r21
    std Y + M_POSITION + 1, r22
    std Y + M_POSITION + 2, r23
    std Y + M_POSITION + 3, r0
    .endm

    /* Steps from r20:r19:r18 on [2^-8 ticks], r0 of them, r23:r22:r21 apart, each into its slot or the next that is free,
     * up to r25:r24 [ticks]; to \stops where no slot is left, to \ends where all are made.  r16 base, r17 free, r30 stop,
     * r31 pin, r27 the ring's page. */
    .macro steps stops, ends
1:  mov r26, r19
    lsl r26
    mov r26, r20
    rol r26
    cp r26, r17
    brsh 2f
    mov r26, r17
2:  cp r26, r30
    brsh \stops
    mov r17, r26
    inc r17
    add r26, r16
    ld r1, X
    or r1, r31
    st X, r1
    add r18, r21
    adc r19, r22
    adc r20, r23
    dec r0
    breq \ends
    cp r19, r24
    cpc r20, r25
    brlo 1b
    .endm

full_ends:
    clz
full_leaves: /* with Z for all */
    std Y + M_DUE, r18
    std Y + M_DUE + 1, r19
    std Y + M_DUE + 2, r20
full_out:
    pop r31
    pop r30
    std Z + FREE, r17
    push r30
    push r31
full_returns:
    pop r23
    pop r22
    ldi r24, 0
    brne 1f
    ldi r24, 1
1:  clr r1
    .irp register, 29, 28, 17, 16
    pop r\register
    .endr
    ret

    .global row_full /* (r25:r24 motor that is on, r23:r22 row); returns 0 where C is to go on: last step, long intervals */
row_full:
    .irp register, 16, 17, 28, 29, 22, 23
    push r\register
    .endr
    movw r28, r24
    movw r30, r22
    ldd r0, Y + M_DUE + 3
    tst r0
    brne full_returns /* Z is clear, too */
    ldd r24, Z + UNTIL
    ldd r25, Z + UNTIL + 1
    ldd r16, Z + BASE
    ldd r17, Z + FREE
    ldd r26, Z + STOP
    ldd r27, Z + PIN
    movw r30, r26 /* stop r30, pin r31 */
    ldd r18, Y + M_DUE
    ldd r19, Y + M_DUE + 1
    ldd r20, Y + M_DUE + 2
stride:
    cp r19, r24
    cpc r20, r25
    brsh full_done
    ldd r0, Y + M_PHASE
    tst r0
    breq full_ends
    ldd r1, Y + M_INTERVAL + 3
    tst r1
    brne full_ends
    ldd r21, Y + M_INTERVAL
    ldd r22, Y + M_INTERVAL + 1
    ldd r23, Y + M_INTERVAL + 2
    cpi r23, 0x40
    brsh full_ends
    ldi r27, hi8(step_ring)
    steps full_stops, bend
    note_phase
full_done:
    sez
    rjmp full_leaves
full_stops:
    note_phase
    rjmp full_ends
bend:
    note_phase
    rcall bend_y
    rjmp stride

    .global run_bend /* (r25:r24 run): trochia_segment_bend */
run_bend:
    push r28
    push r29
    movw r28, r24
    sbiw r28, M_INTERVAL
    rcall bend_y
    pop r29
    pop r28
    ret

bend_y: /* of the motor at Y; leaves r1 0 */
    sum M_INTERVAL_LOW, M_ADD_LOW, add
    sum M_INTERVAL_LOW + 1, M_ADD_LOW + 1
    sum M_INTERVAL, M_ADD
    sum M_INTERVAL + 1, M_ADD + 1
    sum M_INTERVAL + 2, M_ADD + 2
    sum M_INTERVAL + 3, M_ADD + 3
    sum M_ADD_LOW, M_ADD2_LOW, add
    sum M_ADD_LOW + 1, M_ADD2_LOW + 1
    sum M_ADD, M_ADD2
    sum M_ADD + 1, M_ADD2 + 1
    sum M_ADD + 2, M_ADD2 + 2
    sum M_ADD + 3, M_ADD2 + 3
    ldd r26, Y + M_LEFT
    ldd r27, Y + M_LEFT + 1
    ldd r0, Y + M_STRIDE
    clr r1
    sub r26, r0
    sbc r27, r1
    brcc 3f
    add r0, r26 /* fewer are left: those */
    clr r26
    clr r27
3:  std Y + M_LEFT, r26
    std Y + M_LEFT + 1, r27
    std Y + M_PHASE, r0
    ret

    /* v of three bytes [2^-8 ticks] += v times extra r25:r24 [2^-16]; r16 is 0; spends r26, r27, r30, r31 */
    .macro scale v0, v1, v2
    mul \v0, r24
    mov r26, r1
    mul \v0, r25
    add r26, r0
    mov r27, r1
    adc r27, r16
    mul \v1, r24
    add r26, r0
    adc r27, r1
    clr r30
    adc r30, r16
    mul \v1, r25
    add r27, r0
    adc r30, r1
    clr r31
    adc r31, r16
    mul \v2, r24
    add r27, r0
    adc r30, r1
    adc r31, r16
    mul \v2, r25
    add r30, r0
    adc r31, r1
    add \v0, r27
    adc \v1, r30
    adc \v2, r31
    .endm

    .global row_brisk /* as row_full, for rates between a half and one */
row_brisk:
    .irp register, 16, 17, 28, 29, 22, 23
    push r\register
    .endr
    movw r28, r24
    movw r30, r22
    ldd r17, Z + FREE
    clt
brisk:
    ldd r0, Y + M_DUE + 3
    tst r0
    brne 4f
    ldd r18, Y + M_DUE
    ldd r19, Y + M_DUE + 1
    ldd r20, Y + M_DUE + 2
    ldd r0, Z + BOUND
    cp r18, r0
    ldd r0, Z + BOUND + 1
    cpc r19, r0
    ldd r0, Z + BOUND + 2
    cpc r20, r0
    brsh 5f
    ldd r0, Y + M_PHASE
    tst r0
    breq 4f
    ldd r1, Y + M_INTERVAL + 3
    tst r1
    brne 4f
    ldd r21, Y + M_INTERVAL
    ldd r22, Y + M_INTERVAL + 1
    ldd r23, Y + M_INTERVAL + 2
    cpi r23, 0x40
    brlo 6f
4:  rjmp brisk_ends
5:  rjmp brisk_done
6:  ldd r24, Z + EXTRA
    ldd r25, Z + EXTRA + 1
    clr r16
    scale r18, r19, r20
    scale r21, r22, r23
    pop r31
    pop r30
    push r30
    push r31
    ldd r24, Z + UNTIL
    ldd r25, Z + UNTIL + 1
    ldd r0, Z + LAST
    tst r0
    brne 7f
    cp r19, r24
    cpc r20, r25
    brlo 7f
    rjmp brisk_done
7:  ldd r16, Z + BASE
    ldd r26, Z + STOP
    ldd r27, Z + PIN
    movw r30, r26
    ldd r0, Y + M_PHASE
    ldi r27, hi8(step_ring)
    steps 8f, 3f
    rjmp 3f
8:  set /* no slot is left */
3:  ldd r26, Y + M_PHASE
    std Y + M_PHASE, r0
    sub r26, r0
    clr r16
    ldd r18, Y + M_DUE
    ldd r19, Y + M_DUE + 1
    ldd r20, Y + M_DUE + 2
    ldd r21, Y + M_INTERVAL
    mul r26, r21
    add r18, r0
    adc r19, r1
    adc r20, r16
    ldd r21, Y + M_INTERVAL + 1
    mul r26, r21
    add r19, r0
    adc r20, r1
    ldd r21, Y + M_INTERVAL + 2
    mul r26, r21
    add r20, r0
    std Y + M_DUE, r18
    std Y + M_DUE + 1, r19
    std Y + M_DUE + 2, r20
    ldd r0, Y + M_PHASE
    add r0, r26 /* so that it comes out as it is now */
    std Y + M_PHASE, r0
    sub r0, r26
    mov r18, r0
    note_phase
    pop r31
    pop r30
    push r30
    push r31
    tst r18
    brne 9f
    rcall bend_y
9:  brts brisk_ends
    rjmp brisk
brisk_done:
    sez
    rjmp full_out
brisk_ends:
    clz
    rjmp full_out
