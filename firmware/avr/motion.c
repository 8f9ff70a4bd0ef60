#include "motion_parts.h"

#include <string.h>

enum {
    LEAD = 1600,                              /* ticks from GO to the first slice */
    ROOM = TROCHIA_CHUNK + TROCHIA_SPARE + 24 /* bytes of the ring: where there are fewer the line has its turn */
};

uint8_t step_ring[256 + 3 * BEAMS] __attribute__((section(".ring,\"aw\",@nobits;")));
volatile uint8_t step_head, step_on;
trochia_timeline line;

_Static_assert(__builtin_offsetof(trochia_motor, run.phase) == 9, "rows.S relies on it");
_Static_assert(__builtin_offsetof(trochia_motor, run.add2_low) == 26, "rows.S relies on it");
_Static_assert(__builtin_offsetof(trochia_motor, on) == 33, "rows.S relies on it");
_Static_assert(__builtin_offsetof(trochia_row, extra) == 19, "rows.S relies on it");
slice_begin slices[SLICES];
uint16_t silence_most;
uint8_t state, cause, epoch, enabled, underway, end_put;
uint32_t caught_at;
static uint16_t next_number;
static uint8_t outputs_put; /* when all that is in the ring has happened */
static uint32_t span_duration;
static uint8_t slice_seen;
uint16_t silent_slices; /* since the host was heard last */

void motion_setup(void) {
    for (uint8_t i = 0; i < BOARD_MOTORS; i++)
        line.motors[i].pin = board_pins[i];
    trochia_timeline_begin(&line);
    GPIOR1 = 1;
    isr_count = 0;
    TCCR1B = 1 << CS10;
    TIMSK1 = 1 << TOIE1;
}

volatile uint16_t overflows; /* line_io.S */

uint32_t motion_clock(void) {
    uint16_t low, high;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        low = TCNT1;
        high = overflows;
        if (TIFR1 & 1 << TOV1 && low < 32768u)
            high++;
    }
    return (uint32_t)high << 16 | low;
}

static void interrupt_off(void) {
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        TIMSK1 &= (uint8_t)~(1 << OCIE1A | 1 << OCIE1B);
    }
}

static void finish(uint8_t to, uint8_t why) {
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        span_power = 0;
        beam_put();
    }
    underway = 0;
    state = to;
    if (!cause)
        cause = why;
    queue_clear();
}

void motion_stop(uint8_t why) {
    uint32_t at = executed_now();
    int32_t position[BOARD_MOTORS];
    interrupt_off();
    span_power = 0;
    board_beam(0);
    for (uint8_t i = 0; i < BOARD_MOTORS; i++)
        position[i] = line.motors[i].position;
    take_back(position);
    for (uint8_t i = 0; i < BOARD_MOTORS; i++)
        line.motors[i].position = position[i];
    line.stream = at;
    isr_tail = (uint8_t)(isr_tail + 3) & (uint8_t)~3; /* an entry's place, also from within a grid */
    line.head = step_head = isr_tail;
    line.backwards = directions;
    line.loaded = 0;
    line.length = 0;
    GPIOR0 = 0;
    outputs_put = outputs;
    step_on = 0;
    isr_count = 0;
    if (state == TROCHIA_RUNNING || state == TROCHIA_LOADING || why != TROCHIA_ORDERED) {
        cause = cause && state == TROCHIA_STOPPED ? cause : why;
        state = TROCHIA_STOPPED;
    }
    underway = 0;
    queue_clear();
}

void motion_brake(uint8_t why) {
    if (state == TROCHIA_LOADING) {
        finish(TROCHIA_STOPPED, why);
        return;
    }
    if (state != TROCHIA_RUNNING || line.brake)
        return;
    line.brake = 1;
    cause = why;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        beam_put();
    }
}

void motion_begin(const trochia_begin *order) {
    if (underway)
        return;
    epoch = order->epoch;
    queue_clear();
    trochia_timeline_begin(&line);
    span_power = 0;
    beam_begin();
    next_number = 0;
    cause = TROCHIA_NO_CAUSE;
    state = TROCHIA_LOADING;
    caught = 0;
}

void motion_span(const uint8_t *payload, uint8_t size) {
    trochia_span span;
    if (state != TROCHIA_LOADING && state != TROCHIA_RUNNING)
        return;
    if (caught || line.brake)
        return; /* sent before the host knew */
    memcpy(&span, payload, sizeof span);
    if (size < sizeof span || size != queue_size(&span) || span.number != next_number || !queue_put(payload, size)) {
        motion_brake(TROCHIA_BAD_SPAN);
        return;
    }
    next_number++;
    line.hand += trochia_hand(span.slew, span.duration);
    line.rest = span.flags & TROCHIA_AT_REST;
}

/* The span under way ends earlier; returns whether that is still to come. */
static uint8_t cut_loaded(uint32_t duration) {
    uint32_t less = span_duration - duration;
    if (duration >= span_duration || line.left <= less || line.left - less <= line.length)
        return 0;
    line.left -= less;
    span_duration = duration;
    return 1;
}

void motion_cut(const trochia_cut *order) {
    uint8_t found;
    if (state != TROCHIA_RUNNING && state != TROCHIA_LOADING)
        return;
    queue_cut(order->number, order->duration, &found);
    next_number = (uint16_t)(order->number + (order->duration != 0));
    line.rest = order->flags & TROCHIA_AT_REST;
    if (!found) {
        if (order->duration)
            found = line.loaded && line.number == order->number && cut_loaded(order->duration);
        else
            found = line.loaded && (uint16_t)(line.number + 1) == order->number;
    }
    line.hand = queue_hand();
    if (!found)
        motion_brake(TROCHIA_LATE_CUT);
}

void motion_switch(const trochia_put *order) {
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        if (order->lit != 255)
            span_lit = order->lit;
        outputs = (uint8_t)((outputs & ~order->mask) | (order->outputs & order->mask));
        outputs_put = outputs;
        board_outputs(outputs);
        beam_put();
    }
    if (order->enable != 255) {
        enabled = order->enable != 0;
        board_enable(enabled);
        if (!enabled && underway)
            motion_stop(TROCHIA_ORDERED);
    }
}

void motion_watch(const trochia_look *order) {
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        watched = *order;
        caught = caught_new = 0;
        watch_look();
    }
}

void motion_greet(const trochia_hello *hello) {
    motion_brake(TROCHIA_ORDERED);
    silence_most = hello->silence;
    estop_inputs = hello->estop;
    GPIOR1 = (uint8_t)(hello->width + 1);
}

/* Apart, so that what it needs is on the stack for that time only; likewise take_up. */
uint8_t __attribute__((noinline)) steps_made(uint16_t limit) {
    return trochia_timeline_steps(&line, limit);
}

static void next_pixel(void) {
    trochia_pixel pixel;
    if (line.pixels) {
        queue_get((uint8_t *)&pixel, sizeof pixel);
        trochia_timeline_pixel(&line, &pixel);
    }
}

/* Takes the next span up; returns whether there was one. */
static uint8_t __attribute__((noinline)) take_up(void) {
    trochia_span span;
    trochia_part part;
    uint32_t start = line.loaded ? line.left : 0;
    uint8_t back = line.backwards;
    if (!queue_next((uint8_t *)&span, sizeof span))
        return 0;
    trochia_timeline_load(&line, &span);
    span_duration = span.duration;
    for (uint8_t i = 0; i < BOARD_MOTORS; i++) {
        if (!(span.motors & 1 << i))
            continue;
        queue_get((uint8_t *)&part, sizeof part);
        trochia_timeline_part(&line, i, &part, start);
        if (part.steps.flags & TROCHIA_SEGMENT_BACKWARDS)
            back = (uint8_t)(back | 1 << i);
        else
            back = (uint8_t)(back & ~(1 << i));
    }
    uint8_t four[4] = {(uint8_t)(back ^ line.backwards), 0, span.outputs, 0};
    if (span.flags & TROCHIA_SET_OUTPUTS && span.outputs != outputs_put) {
        outputs_put = span.outputs;
        four[1] = TROCHIA_SET_OUTPUTS;
    }
    if (four[0] | four[1])
        trochia_timeline_act(&line, (uint16_t)start, four);
    line.backwards = back;
    return 1;
}

static void note_slice(void) {
    slice_begin *begin = &slices[line.marked & (SLICES - 1)];
    begin->stream = line.stream;
    for (uint8_t i = 0; i < BOARD_MOTORS; i++)
        begin->steps[i] = (uint16_t)line.motors[i].position;
    begin->rate = line.rate;
}

static void kick(void) {
    uint16_t at;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        at = (uint16_t)(TCNT1 + LEAD);
        isr_pins = 0;
        isr_count = 1;
        isr_at_low = (uint8_t)at;
        isr_at_high = (uint8_t)(at >> 8);
        slice_since = at;
        OCR1A = at;
        TIFR1 = 1 << OCF1A;
        step_on = 1;
        TIMSK1 |= 1 << OCIE1A;
    }
    beam_kick(at);
}

void motion_go(void) {
    if (state != TROCHIA_LOADING)
        return;
    state = TROCHIA_RUNNING;
    underway = 2; /* the interrupt is still to be started */
    end_put = ended = 0;
    silent_slices = 0;
    slice_done = slice_seen = line.marked;
    note_slice();
    slices[(line.marked - 1) & (SLICES - 1)].rate = line.rate;
    ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
        beam_put();
    }
}

static void fill(void) {
    do {
        if (line.length == 0 && (uint8_t)(line.marked - slice_done) >= TROCHIA_AHEAD)
            return;
        uint8_t head = line.head, dense = line.dense, told = trochia_timeline_fill(&line);
        slices[(told == TROCHIA_SLICED ? line.marked - 1 : line.marked) & (SLICES - 1)].rate = line.rate;
        if (told == TROCHIA_SLICED) {
            note_slice();
            beam_since = (uint16_t)(beam_since + TROCHIA_SLICE);
            continue;
        }
        if (told == TROCHIA_LIT) {
            next_pixel();
            continue;
        }
        if (told == TROCHIA_CROWDED || (told == TROCHIA_FULL && line.head == head && line.dense == dense))
            return; /* where a dense chunk turned out empty there is more to come */
        if (told == TROCHIA_FULL)
            continue;
        if (told == TROCHIA_NEED && trochia_timeline_space(&line) >= 20 && take_up())
            continue;
        if (trochia_timeline_space(&line) < 20)
            return;
        if (!cause && (told == TROCHIA_ENDED || !line.rest))
            cause = TROCHIA_LOW;
        trochia_timeline_end(&line);
        end_put = 1;
    } while (!end_put && trochia_timeline_space(&line) >= ROOM);
}

void motion_fill(void) {
    if (underway && !end_put)
        fill();
}

void motion_work(void) {
    if (estop_seen) {
        estop_seen = 0;
        motion_stop(TROCHIA_ESTOP);
        enabled = 0;
    }
    if (caught_new) {
        caught_new = 0;
        caught_at = stream_at(caught_slice, caught_after);
        motion_brake(TROCHIA_CAUGHT);
    }
    if (!underway)
        return;
    uint8_t now = slice_done;
    silent_slices = (uint16_t)(silent_slices + (uint8_t)(now - slice_seen));
    slice_seen = now;
    if (silence_most && silent_slices > silence_most)
        motion_brake(TROCHIA_SILENCE);
    motion_fill();
    if (line.crowded) {
        motion_stop(TROCHIA_MISSED);
        return;
    }
    if (underway == 2) {
        underway = 1;
        kick();
    } else if (!step_on) {
        if (ended)
            finish(cause ? TROCHIA_STOPPED : TROCHIA_IDLE, TROCHIA_NO_CAUSE);
        else
            motion_stop(TROCHIA_MISSED);
    }
}

uint16_t motion_room(void) {
    return queue_free();
}
uint8_t motion_epoch(void) {
    return epoch;
}
