/* A timer as the chip has it: a counter, its compare matches and its overflow.
 *
 * A match sets its flag one count after the counter stands on the compare value, also on value 0.  A counter that is
 * stopped keeps what was written to it.  In CTC mode a compare value written below the count is missed: the counter
 * runs to its end.  A flag is cleared by writing a one to it, the others stay. */
#include "chip.h"

#include <string.h>

static uint32_t read16(const avr_t *avr, avr_io_addr_t low, avr_io_addr_t high) {
    return avr->data[low] | (high ? (uint32_t)avr->data[high] << 8 : 0);
}

static uint32_t cycles_to_wrap(const clock_unit *unit, uint32_t count) {
    return (unit->wraps_at_top && count <= unit->top ? unit->top : unit->most) - count + 1;
}

static avr_cycle_count_t pass(avr_t *avr, avr_cycle_count_t when, void *param);

/* Moves the reference point to now; counts that are passed raise their flags. */
static void advance(clock_unit *unit) {
    if (!unit->divider)
        return;
    uint64_t counts = (unit->avr->cycle - unit->since) / unit->divider;
    while (counts) {
        uint32_t wrap = cycles_to_wrap(unit, unit->from), run = counts < wrap ? (uint32_t)counts : wrap;
        for (int i = 0; i < MATCHES; i++) {
            if (unit->timer->comp[i].r_ocr && unit->match[i] - unit->from < run)
                avr_raise_interrupt(unit->avr, &unit->timer->comp[i].interrupt);
        }
        if (run == wrap && (unit->from + run == unit->most + 1 || unit->pwm))
            avr_raise_interrupt(unit->avr, &unit->timer->overflow);
        unit->from = run == wrap ? 0 : unit->from + run;
        unit->since += (uint64_t)run * unit->divider;
        counts -= run;
    }
}

/* Asks to be called at the next count that raises a flag. */
static void schedule(clock_unit *unit) {
    avr_cycle_timer_cancel(unit->avr, pass, unit);
    if (!unit->divider)
        return;
    uint32_t next = cycles_to_wrap(unit, unit->from);
    for (int i = 0; i < MATCHES; i++) {
        uint32_t ahead = unit->match[i] - unit->from + 1;
        if (unit->timer->comp[i].r_ocr && ahead && ahead < next)
            next = ahead;
    }
    uint64_t due = unit->since + (uint64_t)next * unit->divider;
    avr_cycle_timer_register(unit->avr, due - unit->avr->cycle, pass, unit);
}

static avr_cycle_count_t pass(avr_t *avr, avr_cycle_count_t when, void *param) {
    (void)avr;
    (void)when;
    clock_unit *unit = param;
    advance(unit);
    schedule(unit);
    return 0;
}

static void report_pwm(const clock_unit *unit, int channel) {
    if (unit->pwm && avr_regbit_get(unit->avr, unit->timer->comp[channel].com))
        record(unit->avr->cycle, EVENT_PWM, (uint8_t)unit->timer->name, (uint8_t)channel,
               unit->match[channel] | unit->top << 16);
}

/* Mode, top and divider as the registers have them. */
static void configure(clock_unit *unit) {
    avr_timer_t *timer = unit->timer;
    avr_timer_wgm_t mode = timer->wgm_op[avr_regbit_get_array(unit->avr, timer->wgm, 4)];
    uint8_t select = avr_regbit_get_array(unit->avr, timer->cs, 4);
    uint32_t divider = select && timer->cs_div[select] < 32 ? 1u << timer->cs_div[select] : 0;
    bool fixed = mode.kind == avr_timer_wgm_normal || mode.size;
    unit->most = timer->r_tcnth ? 0xffff : 0xff;
    unit->top =
        fixed ? (1u << mode.size) - 1
              : (mode.top == avr_timer_wgm_reg_icr ? read16(unit->avr, timer->r_icr, timer->r_icrh) : unit->match[0]);
    unit->wraps_at_top = true;
    unit->pwm = mode.kind == avr_timer_wgm_pwm || mode.kind == avr_timer_wgm_fast_pwm;
    if (!unit->divider)
        unit->since = unit->avr->cycle;
    unit->divider = divider;
}

static void write_mode(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    clock_unit *unit = param;
    advance(unit);
    avr->data[address] = value;
    configure(unit);
    schedule(unit);
    for (int i = 0; i < MATCHES; i++)
        report_pwm(unit, i);
}

static void write_match(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    clock_unit *unit = param;
    advance(unit);
    avr->data[address] = value;
    for (int i = 0; i < MATCHES; i++) {
        const avr_timer_comp_t *match = &unit->timer->comp[i];
        if (match->r_ocr == address) {
            unit->match[i] = read16(avr, match->r_ocr, match->r_ocrh);
            configure(unit);
            report_pwm(unit, i);
        }
    }
    schedule(unit);
}

static void write_count(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    clock_unit *unit = param;
    avr->data[address] = value;
    unit->from = read16(avr, unit->timer->r_tcnt, unit->timer->r_tcnth);
    unit->since = avr->cycle;
    schedule(unit);
}

static uint8_t read_count(avr_t *avr, avr_io_addr_t address, void *param) {
    clock_unit *unit = param;
    advance(unit);
    schedule(unit);
    avr->data[unit->timer->r_tcnt] = (uint8_t)unit->from;
    if (unit->timer->r_tcnth)
        avr->data[unit->timer->r_tcnth] = (uint8_t)(unit->from >> 8);
    return avr->data[address];
}

static void write_flags(avr_t *avr, avr_io_addr_t address, uint8_t value, void *param) {
    (void)param;
    for (int i = 0; i < avr->interrupts.vector_count; i++) {
        avr_int_vector_t *vector = avr->interrupts.vector[i];
        if (vector->raised.reg == address && value >> vector->raised.bit & 1) {
            avr_clear_interrupt(avr, vector);
            avr_regbit_clear(avr, vector->raised);
        }
    }
}

static void on_write(avr_t *avr, avr_io_addr_t address, avr_io_write_t handler, void *param) {
    if (address) {
        avr->io[AVR_DATA_TO_IO(address)].w.c = handler;
        avr->io[AVR_DATA_TO_IO(address)].w.param = param;
    }
}

void clock_take(clock_unit *unit, avr_t *avr, avr_timer_t *timer) {
    memset(unit, 0, sizeof *unit);
    unit->avr = avr;
    unit->timer = timer;
    configure(unit);
    on_write(avr, timer->wgm[0].reg, write_mode, unit);
    on_write(avr, timer->cs[0].reg, write_mode, unit);
    on_write(avr, timer->r_tcnt, write_count, unit);
    on_write(avr, timer->overflow.raised.reg, write_flags, unit);
    for (int i = 0; i < MATCHES; i++)
        on_write(avr, timer->comp[i].r_ocr, write_match, unit);
    avr->io[AVR_DATA_TO_IO(timer->r_tcnt)].r.c = read_count;
    avr->io[AVR_DATA_TO_IO(timer->r_tcnt)].r.param = unit;
}
