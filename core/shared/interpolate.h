/* The classic interpolators: a line or an arc in, at each tick the pulses of two axes out.  Integers only.
 *
 * Every figure is brought into one frame first.  A line starts at (0, 0) and goes to (p, q), p and q at least 0.  An
 * arc is cut at the axes; in its quadrant it runs counter-clockwise through x > 0, y >= 0 about the centre, so that x
 * only falls and y only rises, and each axis knows how many steps it still has to make: that is why every method ends
 * on the end point exactly.  When one axis is done the other goes straight on.
 *
 * Legend: N register size, R radius, F = x^2 + y^2 - R^2 the discriminant (which side of the circle), all in steps.
 * Coordinates and radii stay below 2^30. */
#ifndef TROCHIA_INTERPOLATE_H
#define TROCHIA_INTERPOLATE_H

#include <stdint.h>

enum trochia_method {
    TROCHIA_DDA = 0,        /* digital differential analyser: two registers overflow */
    TROCHIA_BRESENHAM = 1,  /* discriminant: of three neighbours the nearest */
    TROCHIA_POINT = 2,      /* discriminant: one axis at a time, back across the curve */
    TROCHIA_DIFFERENCE = 3, /* differences of coordinates sampled from the law of motion, as pulse rates */
    TROCHIA_OCTANT = 4      /* the function itself, along the faster axis */
};

/* A pulse byte: the parallel port's first four bits. */
enum trochia_pulse { TROCHIA_X_FORWARDS = 1, TROCHIA_Y_FORWARDS = 2, TROCHIA_X_CLOCK = 4, TROCHIA_Y_CLOCK = 8 };

/* Ticks from sample to sample of the coordinate-difference method, and fraction bits of its law. */
enum trochia_difference { TROCHIA_SAMPLE = 8, TROCHIA_FRACTION = 24 };

typedef struct {
    int64_t radius2;            /* R^2; 0 on a line */
    int64_t f;                  /* discriminant; a line's error */
    int64_t sum_x, sum_y, size; /* registers of overflow and their size N */
    int64_t law_x, law_y;       /* sampled position, in 2^-FRACTION steps */
    int32_t x, y;               /* where it stands, in the frame */
    int32_t rest_x, rest_y;     /* steps still to make, in this quadrant */
    int32_t end_x, end_y;       /* where the figure ends, in the frame */
    int32_t rate_x, rate_y;     /* steps in this sample */
    int32_t tick, ticks;        /* of a sample; a whole line's length in ticks is `size` */
    int32_t radius;             /* nearest to sqrt(radius2): where the circle meets the axes */
    uint8_t method, quadrant, clockwise, last;
    uint8_t directions, clock_x, clock_y; /* pulse bits of this quadrant */
    uint8_t shift;                        /* the law turns by 2^-shift a sample */
} trochia_interpolator;

/* Greatest r with r * r <= v. */
static inline uint32_t trochia_root(uint64_t v) {
    uint64_t root = 0, bit = 1;
    while (bit << 2 && bit << 2 <= v)
        bit <<= 2;
    for (; bit; bit >>= 2) {
        if (v >= root + bit) {
            v -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
    }
    return (uint32_t)root;
}

/* sqrt(v) to the nearest whole; 0 below 0. */
static inline int32_t trochia_nearest_root(int64_t v) {
    if (v <= 0)
        return 0;
    int64_t r = trochia_root((uint64_t)v);
    return (int32_t)(v - r * r > r ? r + 1 : r);
}

/* Arithmetic shift right, to the nearest. */
static inline int64_t trochia_shift(int64_t v, uint8_t bits) {
    int64_t half = (int64_t)1 << (bits - 1);
    return v >= 0 ? (v + half) >> bits : -((-v + half) >> bits);
}

/* Pulse bits of the frame's x and y steps in a quadrant. */
static inline void trochia_aim(trochia_interpolator *ip) {
    /* in the frame x falls and y rises; a quarter turn on, (dx, dy) is (-dy, dx); clockwise swaps the axes */
    int32_t xx = -1, xy = 0, yx = 0, yy = 1;
    for (uint8_t k = 0; k < ip->quadrant; k++) {
        int32_t was_x = xx, was_y = yx;
        xx = -xy, xy = was_x;
        yx = -yy, yy = was_y;
    }
    if (ip->clockwise) {
        int32_t was_x = xx, was_y = yx;
        xx = xy, xy = was_x;
        yx = yy, yy = was_y;
    }
    ip->clock_x = xx ? TROCHIA_X_CLOCK : TROCHIA_Y_CLOCK;
    ip->clock_y = yx ? TROCHIA_X_CLOCK : TROCHIA_Y_CLOCK;
    ip->directions = (uint8_t)((xx + yx > 0 ? TROCHIA_X_FORWARDS : 0) | (xy + yy > 0 ? TROCHIA_Y_FORWARDS : 0));
}

/* Registers at the start of a quadrant. */
static inline void trochia_quadrant_begin(trochia_interpolator *ip) {
    uint8_t ahead =
        ip->end_x >= 0 && ip->end_x <= ip->x && ip->end_y >= ip->y && (ip->end_x < ip->x || ip->end_y > ip->y);
    ip->last = ahead;
    ip->rest_x = ahead ? ip->x - ip->end_x : ip->x;
    ip->rest_y = ahead ? ip->end_y - ip->y : ip->radius - ip->y;
    ip->f = (int64_t)ip->x * ip->x + (int64_t)ip->y * ip->y - ip->radius2;
    ip->tick = ip->ticks = 0;
    if (ip->method == TROCHIA_DDA) {
        for (ip->size = 1; ip->size <= ip->radius; ip->size <<= 1)
            ;
        ip->sum_x = ip->sum_y = ip->size >> 1;
    }
    if (ip->method == TROCHIA_DIFFERENCE) {
        for (ip->shift = 3; ip->radius >> ip->shift >= TROCHIA_SAMPLE; ip->shift++)
            ;
        ip->law_x = (int64_t)ip->x << TROCHIA_FRACTION;
        ip->law_y = (int64_t)ip->y << TROCHIA_FRACTION;
    }
    trochia_aim(ip);
}

/* From (x0, y0) to (x1, y1), both from the centre; where they are one point, a whole turn. */
static inline void trochia_arc_begin(trochia_interpolator *ip, uint8_t method, uint8_t clockwise, int64_t radius2,
                                     int32_t x0, int32_t y0, int32_t x1, int32_t y1) {
    ip->method = method;
    ip->radius2 = radius2;
    ip->radius = trochia_nearest_root(radius2);
    ip->clockwise = clockwise;
    ip->quadrant = 0;
    ip->x = clockwise ? y0 : x0, ip->y = clockwise ? x0 : y0;
    ip->end_x = clockwise ? y1 : x1, ip->end_y = clockwise ? x1 : y1;
    while (!(ip->x > 0 && ip->y >= 0)) {
        int32_t x = ip->x, end_x = ip->end_x;
        ip->x = ip->y, ip->y = -x;
        ip->end_x = ip->end_y, ip->end_y = -end_x;
        ip->quadrant++;
    }
    trochia_quadrant_begin(ip);
}

static inline void trochia_line_begin(trochia_interpolator *ip, uint8_t method, int32_t x, int32_t y) {
    int32_t p = x < 0 ? -x : x, q = y < 0 ? -y : y, major = p > q ? p : q;
    ip->method = method;
    ip->radius2 = 0;
    ip->last = 1;
    ip->x = ip->y = 0;
    ip->end_x = ip->rest_x = p;
    ip->end_y = ip->rest_y = q;
    ip->sum_x = ip->sum_y = ip->law_x = 0;
    ip->tick = ip->ticks = 0;
    ip->f = method == TROCHIA_BRESENHAM ? -(int64_t)major : 0;
    ip->size = 1;
    if (method == TROCHIA_DDA) {
        while (ip->size <= major)
            ip->size <<= 1;
    } else if (method == TROCHIA_DIFFERENCE) {
        int64_t square = (int64_t)p * p + (int64_t)q * q, root = trochia_root((uint64_t)square);
        ip->size = root * root < square ? root + 1 : root;
    }
    ip->clock_x = TROCHIA_X_CLOCK;
    ip->clock_y = TROCHIA_Y_CLOCK;
    ip->directions = (uint8_t)((x > 0 ? TROCHIA_X_FORWARDS : 0) | (y > 0 ? TROCHIA_Y_FORWARDS : 0));
}

/* What a tick asks for in the frame: bit 0 a step of x, bit 1 of y. */
enum trochia_wish { TROCHIA_NONE = 0, TROCHIA_STEP_X = 1, TROCHIA_STEP_Y = 2, TROCHIA_STEP_BOTH = 3 };

/* Adds to both registers; an overflow is a step. */
static inline uint8_t trochia_overflow(trochia_interpolator *ip, int64_t add_x, int64_t add_y, int64_t size) {
    uint8_t wish = TROCHIA_NONE;
    ip->sum_x += add_x;
    ip->sum_y += add_y;
    if (ip->sum_x >= size)
        ip->sum_x -= size, wish |= TROCHIA_STEP_X;
    if (ip->sum_y >= size)
        ip->sum_y -= size, wish |= TROCHIA_STEP_Y;
    return wish;
}

/* Pulses of a sample, spread evenly over its ticks. */
static inline uint8_t trochia_spread(trochia_interpolator *ip) {
    ip->tick++;
    return trochia_overflow(ip, ip->rate_x, ip->rate_y, ip->ticks);
}

static inline int32_t trochia_within(int64_t v, int32_t most) {
    return v < 0 ? 0 : v > most ? most : (int32_t)v;
}

static inline uint8_t trochia_difference_line(trochia_interpolator *ip) {
    if (ip->tick == ip->ticks) { /* law_x counts the line's ticks */
        int64_t left = ip->size - ip->law_x;
        ip->ticks = left < TROCHIA_SAMPLE ? (int32_t)left : TROCHIA_SAMPLE;
        ip->law_x += ip->ticks;
        ip->rate_x = (int32_t)((2 * ip->end_x * ip->law_x + ip->size) / (2 * ip->size)) - ip->x;
        ip->rate_y = (int32_t)((2 * ip->end_y * ip->law_x + ip->size) / (2 * ip->size)) - ip->y;
        ip->tick = 0;
        ip->sum_x = ip->sum_y = ip->ticks >> 1;
    }
    return trochia_spread(ip);
}

static inline uint8_t trochia_difference_arc(trochia_interpolator *ip) {
    if (ip->tick == ip->ticks) { /* turn by 2^-shift: the second terms keep the radius to its fourth power */
        int64_t x = ip->law_x, y = ip->law_y;
        uint8_t twice = (uint8_t)(2 * ip->shift + 1);
        ip->law_x = x - trochia_shift(y, ip->shift) - trochia_shift(x, twice);
        ip->law_y = y + trochia_shift(x, ip->shift) - trochia_shift(y, twice);
        ip->ticks = TROCHIA_SAMPLE;
        ip->rate_x = trochia_within(ip->x - trochia_shift(ip->law_x, TROCHIA_FRACTION), TROCHIA_SAMPLE);
        ip->rate_y = trochia_within(trochia_shift(ip->law_y, TROCHIA_FRACTION) - ip->y, TROCHIA_SAMPLE);
        ip->tick = 0;
        ip->sum_x = ip->sum_y = ip->ticks >> 1;
    }
    return trochia_spread(ip);
}

static inline uint8_t trochia_line_tick(trochia_interpolator *ip) {
    int64_t p = ip->end_x, q = ip->end_y, fast = p >= q ? p : q, slow = p >= q ? q : p, done;
    uint8_t step = p >= q ? TROCHIA_STEP_X : TROCHIA_STEP_Y;
    switch (ip->method) {
    case TROCHIA_DDA:
        return trochia_overflow(ip, p, q, ip->size);
    case TROCHIA_BRESENHAM: /* f: twice the fast axis' share that the slow one is past the middle between two points */
        ip->f += 2 * slow;
        if (ip->f < 0)
            return step;
        ip->f -= 2 * fast;
        return TROCHIA_STEP_BOTH;
    case TROCHIA_POINT: /* f = p y - q x: above the line a step of x, below it one of y */
        step = ip->rest_x && (ip->f >= 0 || !ip->rest_y) ? TROCHIA_STEP_X : TROCHIA_STEP_Y;
        ip->f += step == TROCHIA_STEP_X ? -q : p;
        return step;
    case TROCHIA_DIFFERENCE:
        return trochia_difference_line(ip);
    default:
        done = p >= q ? ip->x : ip->y;
        return (2 * (done + 1) * slow + fast) / (2 * fast) > (p >= q ? ip->y : ip->x) ? TROCHIA_STEP_BOTH : step;
    }
}

static inline uint8_t trochia_octant_arc(const trochia_interpolator *ip) {
    int64_t x = ip->x, y = ip->y;
    if (x > y)
        return trochia_nearest_root(ip->radius2 - (y + 1) * (y + 1)) < x ? TROCHIA_STEP_BOTH : TROCHIA_STEP_Y;
    return trochia_nearest_root(ip->radius2 - (x - 1) * (x - 1)) > y ? TROCHIA_STEP_BOTH : TROCHIA_STEP_X;
}

/* The nearest of three: across (f falls by 2x - 1), along (rises by 2y + 1), or both. */
static inline uint8_t trochia_bresenham_arc(const trochia_interpolator *ip) {
    int64_t across = ip->f - 2 * (int64_t)ip->x + 1, along = ip->f + 2 * (int64_t)ip->y + 1;
    int64_t both = across + along - ip->f;
    if (both < 0)
        return along + both <= 0 ? TROCHIA_STEP_Y : TROCHIA_STEP_BOTH;
    return across + both > 0 ? TROCHIA_STEP_X : TROCHIA_STEP_BOTH;
}

static inline uint8_t trochia_arc_tick(trochia_interpolator *ip) {
    if (!ip->rest_x || !ip->rest_y)
        return ip->rest_x ? TROCHIA_STEP_X : TROCHIA_STEP_Y;
    switch (ip->method) {
    case TROCHIA_DDA: /* dx = -y dt, dy = x dt */
        return trochia_overflow(ip, ip->y, ip->x, ip->size);
    case TROCHIA_BRESENHAM:
        return trochia_bresenham_arc(ip);
    case TROCHIA_POINT:
        return ip->f >= 0 ? TROCHIA_STEP_X : TROCHIA_STEP_Y;
    case TROCHIA_DIFFERENCE:
        return trochia_difference_arc(ip);
    default:
        return trochia_octant_arc(ip);
    }
}

/* Whether there are steps still to make. */
static inline uint8_t trochia_moving(const trochia_interpolator *ip) {
    return ip->rest_x || ip->rest_y || !ip->last;
}

/* The next quadrant: a quarter turn of the frame, and the circle starts again on its x axis. */
static inline void trochia_quadrant_next(trochia_interpolator *ip) {
    int32_t end_x = ip->end_x;
    ip->end_x = ip->end_y, ip->end_y = -end_x;
    ip->x = ip->radius, ip->y = 0;
    ip->quadrant = (ip->quadrant + 1) & 3;
    trochia_quadrant_begin(ip);
}

/* One tick: returns its pulse byte (directions always, clocks where an axis steps). */
static inline uint8_t trochia_interpolate_tick(trochia_interpolator *ip) {
    if (ip->radius2 && !ip->rest_x && !ip->rest_y)
        trochia_quadrant_next(ip);
    uint8_t wish = ip->radius2 ? trochia_arc_tick(ip) : trochia_line_tick(ip);
    uint8_t pulse = ip->directions;
    if (wish & TROCHIA_STEP_X && ip->rest_x) {
        ip->f -= ip->radius2 ? 2 * (int64_t)ip->x - 1 : 0;
        ip->x += ip->radius2 ? -1 : 1;
        ip->rest_x--;
        pulse |= ip->clock_x;
    }
    if (wish & TROCHIA_STEP_Y && ip->rest_y) {
        ip->f += ip->radius2 ? 2 * (int64_t)ip->y + 1 : 0;
        ip->y++;
        ip->rest_y--;
        pulse |= ip->clock_y;
    }
    return pulse;
}

#endif
