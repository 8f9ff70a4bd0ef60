/* Runs an image: `chip IMAGE.elf MCU HZ`, obeying requests on standard input and answering on standard output.
 *
 * The requests (their form: requests.h):
 *
 *   R cycle(64)                    go on until the cycle; answer: status, then what happened as `event`s
 *   B cycle(64) bytes              bytes to the serial port 0, their line idle until the cycle
 *   P port(8) pin(8) level(8)      an input's level
 *   A channel(8) pad(8) mV(16)     an analogue input's voltage
 *   M address(16) count(16)        answer: bytes of data memory
 *   W address(16) bytes            sets data memory
 *   I                              answer: for each interrupt vector how often it was taken, and the cycles from
 *                                  entry to the end of its reti, all in all and at worst, without what nested in it
 *   Q                              ends
 *
 * libsimavr 1.6 takes interrupts in no time; the chip needs 4 cycles, and 4 more to wake. */
#include "chip.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <simavr/avr_adc.h>
#include <simavr/avr_extint.h>
#include <simavr/avr_ioport.h>
#include <simavr/sim_core.h>
#include <simavr/sim_elf.h>

enum {
    ENTRY = 4,
    WAKE = 4,
    RETI = 4,
    PORTS = 12,
    VECTORS = 64,
    EXTERNAL = EXTINT_COUNT,
    SUPPLY = 5000 /* mV */
};

typedef struct {
    uint64_t taken, cycles, worst;
} vector_cost;

typedef struct {
    uint8_t vector;
    uint64_t since, nested; /* cycle of entry; cycles of others inside */
} running;

typedef struct {
    uint8_t port, pin, level;
    bool ours; /* the level is being set from outside */
} pin_watch;

static avr_t *chip;
static serial serial0;
static clock_unit clocks[TIMERS];
static pin_watch pins[PORTS][8];
static status now;
static vector_cost costs[VECTORS];
static running stack[VECTORS];
static int depth;

static void pin_changed(avr_irq_t *irq, uint32_t value, void *param) {
    (void)irq;
    pin_watch *pin = param;
    uint8_t level = value & 1;
    if (level == pin->level)
        return;
    pin->level = level;
    if (!pin->ours)
        record(chip->cycle, EVENT_PIN, pin->port, pin->pin, level);
}

static void watch_pins(void) {
    for (int p = 0; p < PORTS; p++) {
        for (int i = 0; i < 8; i++) {
            avr_irq_t *irq = avr_io_getirq(chip, AVR_IOCTL_IOPORT_GETIRQ('A' + p), i);
            if (!irq)
                continue;
            pins[p][i] = (pin_watch){.port = (uint8_t)('A' + p), .pin = (uint8_t)i};
            avr_irq_register_notify(irq, pin_changed, &pins[p][i]);
        }
    }
}

static void take_units(void) {
    int taken = 0;
    for (avr_io_t *io = chip->io_port; io; io = io->next) {
        if (!strcmp(io->kind, "uart") && ((avr_uart_t *)io)->name == '0')
            serial_take(&serial0, chip, (avr_uart_t *)io);
        if (!strcmp(io->kind, "timer") && taken < TIMERS)
            clock_take(&clocks[taken++], chip, (avr_timer_t *)io);
        if (!strcmp(io->kind, "port"))
            ports_take(chip, (avr_ioport_t *)io);
    }
}

/* A reti begins. */
static void interrupt_ends(avr_irq_t *irq, uint32_t value, void *param) {
    (void)irq, (void)value, (void)param;
    if (!depth || chip->interrupts.running_ptr >= depth)
        return;
    const running *done = &stack[--depth];
    uint64_t whole = chip->cycle + RETI - done->since, own = whole - done->nested;
    vector_cost *cost = &costs[done->vector];
    cost->taken++;
    cost->cycles += own;
    cost->worst = own > cost->worst ? own : cost->worst;
    if (depth)
        stack[depth - 1].nested += whole;
}

/* Takes a pending interrupt and charges what it costs. */
static void service(bool woke) {
    uint8_t enabled = chip->sreg[S_I];
    uint64_t since = chip->cycle;
    avr_service_interrupts(chip);
    if (!enabled || chip->sreg[S_I])
        return;
    chip->cycle += ENTRY + (woke ? WAKE : 0);
    now.interrupts++;
    if (depth < VECTORS)
        stack[depth++] = (running){.vector = (uint8_t)(chip->pc / chip->vector_size % VECTORS), .since = since};
    avr_flashaddr_t pc = chip->pc;
    avr_cycle_timer_process(chip);
    chip->pc = pc;
}

static avr_cycle_count_t stop_here(avr_t *avr, avr_cycle_count_t when, void *param) {
    (void)avr, (void)when, (void)param;
    return 0;
}

static void go_on(uint64_t until) {
    if (until > chip->cycle)
        avr_cycle_timer_register(chip, until - chip->cycle, stop_here, NULL);
    while (chip->cycle < until && (chip->state == cpu_Running || chip->state == cpu_Sleeping)) {
        avr_flashaddr_t pc = chip->pc;
        bool slept = chip->state == cpu_Sleeping;
        if (!slept)
            pc = avr_run_one(chip);
        avr_cycle_count_t wait = avr_cycle_timer_process(chip);
        chip->pc = pc;
        if (chip->state == cpu_Sleeping) {
            if (!chip->sreg[S_I]) {
                chip->state = cpu_Done;
                break;
            }
            wait = wait ? wait : 1;
            chip->cycle += wait;
            now.asleep += wait;
        }
        if (chip->interrupt_state)
            service(slept);
    }
    avr_cycle_timer_cancel(chip, stop_here, NULL);
}

static void answer_run(const uint8_t *request) {
    uint64_t until;
    memcpy(&until, request, sizeof until);
    go_on(until);
    now.cycle = chip->cycle;
    now.state = chip->state == cpu_Running    ? RUNS
                : chip->state == cpu_Sleeping ? SLEEPS
                : chip->state == cpu_Done     ? STOPPED
                                              : CRASHED;
    now.unread = serial_left(&serial0);
    answer_status(now);
}

static void set_pin(uint8_t port, uint8_t pin, uint8_t level) {
    avr_irq_t *irq = avr_io_getirq(chip, AVR_IOCTL_IOPORT_GETIRQ(port), pin);
    if (!irq)
        return;
    pin_watch *watch = &pins[port - 'A'][pin];
    watch->ours = true;
    avr_raise_irq(irq, level);
    watch->ours = false;
}

static void set_analogue(uint8_t channel, uint16_t millivolts) {
    avr_irq_t *irq = avr_io_getirq(chip, AVR_IOCTL_ADC_GETIRQ, ADC_IRQ_ADC0 + channel);
    if (irq)
        avr_raise_irq(irq, millivolts);
}

/* Returns whether to go on. */
static bool obey(uint8_t letter, const uint8_t *request, uint32_t size) {
    uint64_t cycle = 0;
    uint16_t words[2] = {0, 0};
    memcpy(&cycle, request, size < sizeof cycle ? size : sizeof cycle);
    memcpy(words, request, size < sizeof words ? size : sizeof words);
    switch (letter) {
    case 'R':
        answer_run(request);
        return true;
    case 'M':
        answer(chip->data + words[0], words[0] + words[1] > chip->ramend + 1 ? 0 : words[1]);
        return true;
    case 'I':
        answer(costs, sizeof costs);
        return true;
    case 'B':
        serial_feed(&serial0, request + 8, size - 8, cycle);
        break;
    case 'P':
        set_pin(request[0], request[1], request[2]);
        break;
    case 'A':
        set_analogue(request[0], words[1]);
        break;
    case 'W':
        if (words[0] + size - 2 <= chip->ramend + 1u)
            memcpy(chip->data + words[0], request + 2, size - 2);
        break;
    default:
        return false;
    }
    answer(NULL, 0);
    return true;
}

/* libsimavr's messages go where they do not disturb the answers. */
static void log_to_stderr(avr_t *avr, const int level, const char *format, va_list arguments) {
    if (!avr || avr->log >= level)
        vfprintf(stderr, format, arguments);
}

int main(int count, char **arguments) {
    elf_firmware_t image;
    memset(&image, 0, sizeof image);
    avr_global_logger_set(log_to_stderr);
    if (count != 4 || elf_read_firmware(arguments[1], &image)) {
        fprintf(stderr, "usage: chip IMAGE.elf MCU HZ\n");
        return 2;
    }
    chip = avr_make_mcu_by_name(arguments[2]);
    if (!chip) {
        fprintf(stderr, "no chip is called %s\n", arguments[2]);
        return 2;
    }
    avr_init(chip);
    chip->log = LOG_ERROR;
    image.frequency = (uint32_t)strtoul(arguments[3], NULL, 10);
    avr_load_firmware(chip, &image);
    chip->vcc = chip->avcc = chip->aref = SUPPLY;
    watch_pins();
    take_units();
    for (uint8_t i = 0; i < EXTERNAL; i++) /* nobody uses them, and they would look at their pins cycle for cycle */
        avr_extint_set_strict_lvl_trig(chip, i, 0);
    avr_irq_register_notify(avr_get_interrupt_irq(chip, AVR_INT_ANY) + AVR_INT_IRQ_RUNNING, interrupt_ends, NULL);
    obey_requests(obey);
    return 0;
}
