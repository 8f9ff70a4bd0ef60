#include "host/encoder.h"

#include <math.h>

/* An even number in 0 to 1 (splitmix64: Steele, Lea and Flood 2014). */
static double even(trochia_encoder_state *s) {
    s->random += UINT64_C(0x9E3779B97F4A7C15);
    uint64_t z = s->random;
    z = (z ^ (z >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94D049BB133111EB);
    return (double)((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
}

static double displaced(const trochia_encoder *e, trochia_encoder_state *s, int64_t edge) {
    /* the sum of two even spreads of width 1 has variance 1/6 */
    return (double)edge + (e->jitter > 0.0 ? e->jitter * 2.449489742783178 * (even(s) + even(s) - 1.0) : 0.0);
}

static void begin(const trochia_encoder *e, trochia_encoder_state *s, double at) {
    s->place = s->told = s->marked = (int64_t)floor(at);
    s->up = displaced(e, s, s->place + 1);
    s->down = displaced(e, s, s->place);
    s->way = s->way == 0 ? 1 : s->way;
    s->begun = 1;
}

static void index_pulse(const trochia_encoder *e, trochia_encoder_state *s, int64_t edge) {
    if (e->turn <= 0 || edge % e->turn != 0)
        return;
    const int64_t lost = s->told - s->place;
    if (s->pulses == 0)
        s->first = lost;
    s->off = lost - s->first;
    s->pulses++;
}

/* Passes one edge, at a time [s]. */
static void pass(const trochia_encoder *e, trochia_encoder_state *s, int way, double time) {
    const int64_t edge = way > 0 ? s->place + 1 : s->place;
    s->place += way;
    /* the way back leads over the same edge where it stood: standing on an edge does not make counts */
    if (way > 0) {
        s->down = s->up;
        s->up = displaced(e, s, edge + 1);
    } else {
        s->up = s->down;
        s->down = displaced(e, s, edge - 1);
    }
    if (e->missed > 0.0 && even(s) < e->missed)
        s->missed++;
    else {
        s->told += e->single ? s->way : way;
        s->last = e->clock > 0.0 ? floor(time * e->clock) / e->clock : time;
        if (!s->seen) {
            s->mark = s->last;
            s->marked = s->told;
            s->seen = 1;
        }
    }
    index_pulse(e, s, edge);
}

/* A loop that runs away passes more edges than are worth a look: it is brought along without. */
static const double MOST = 1e4, COUNTABLE = 9e18;

static void bring_along(const trochia_encoder *e, trochia_encoder_state *s, double to) {
    const int64_t off = s->told - s->place;
    begin(e, s, to);
    s->told += off;
}

void trochia_encoder_watch(const trochia_encoder *e, trochia_encoder_state *s, double from, double to, double h,
                           double command) {
    if (!s->begun)
        begin(e, s, from);
    if (command != 0.0)
        s->way = command > 0.0 ? 1 : -1;
    if (!(fabs(to) < COUNTABLE)) /* the plant shows the position itself there */
        return;
    if (fabs(to - from) > MOST)
        bring_along(e, s, to);
    const double per = to != from ? 1.0 / (to - from) : 0.0;
    while (to >= s->up || to < s->down) {
        const int way = to >= s->up ? 1 : -1;
        const double part = ((way > 0 ? s->up : s->down) - from) * per;
        pass(e, s, way, h * ((double)s->step + (part > 0.0 ? part < 1.0 ? part : 1.0 : 0.0)));
    }
    s->step++;
}

double trochia_encoder_speed(trochia_encoder_state *s, double h) {
    const double gap = s->last - s->mark, since = h * (double)s->step - s->mark;
    if (s->told != s->marked && gap > 0.0) {
        s->speed = (double)(s->told - s->marked) / gap;
        s->marked = s->told;
        s->mark = s->last;
    } else if (since * fabs(s->speed) > 1.0)
        s->speed = (s->speed > 0.0 ? 1.0 : -1.0) / since;
    return s->speed;
}
