/* What the limits of one piece leave at a speed, and ramps along that.
 *
 * With t_i, k_i the greatest |q'|, |q''| of row i in the piece, a(v) = min_i (A_i(t_i v) - k_i v^2) / t_i is kept by
 * every point of it, for A_i never rises.  Between the knots of all rows each term is concave in v, and so is their
 * least: there a(v) lies above the straight line between any two of its values.  A phase of constant jerk from a0 to a1
 * has a^2 linear in v; at the middle that is above the line's square by a part of d^2, d = (a0 - a1) / (a0 + a1), and
 * nowhere by more: both ends divided by sqrt(1 + d^2) keep it below. */
#include "host/plan_torque_span.h"

#include <math.h>
#include <stddef.h>

#include "host/limits.h"

static const double LOOSE = 1e30;
static const double DROP = 0.9; /* acceleration falls to this part in a phase: 0.15 % of it is given away */
static const double NEAR = 0.95;

void trochia_torque_begin(const trochia_torque_task *task, trochia_torque_span *span) {
    span->task = task;
    span->loose = *task->limits;
    for (uint32_t i = 0; i < span->loose.rows; i++)
        span->loose.acceleration[i] = LOOSE;
    if (span->loose.path_acceleration < INFINITY)
        span->loose.path_acceleration = LOOSE;
    span->bounds = trochia_bounds_of(&span->loose);
    span->shape.arc = NULL;
}

/* A row's acceleration limit at its speed; the last row is the cap on the vector. */
static double limit_at(const trochia_torque_span *span, uint32_t row, double speed) {
    const trochia_limits *limits = span->task->limits;
    if (row == limits->rows)
        return limits->path_acceleration;
    const trochia_fall *fall = &span->task->falls[row];
    if (fall->count == 0)
        return limits->acceleration[row];
    uint32_t k = 0;
    while (k < fall->count && fall->speed[k] < speed)
        k++;
    if (k == 0 || k == fall->count)
        return fall->acceleration[k ? k - 1 : 0];
    double share = (speed - fall->speed[k - 1]) / (fall->speed[k] - fall->speed[k - 1]);
    return fall->acceleration[k - 1] + share * (fall->acceleration[k] - fall->acceleration[k - 1]);
}

/* Greatest acceleration at speed v; below 0: v is above the ceiling. */
static double left(const trochia_torque_span *span, double v) {
    double least = INFINITY;
    for (uint32_t i = 0; i < span->rows; i++) {
        double t = span->along[i], rest = limit_at(span, i, t * v) - span->bend[i] * v * v;
        if (rest < least * t || (t == 0.0 && rest < 0.0))
            least = t > 0.0 ? rest / t : -INFINITY;
    }
    return least;
}

static void load_line(const trochia_segment *segment, trochia_torque_span *span) {
    const trochia_limits *limits = span->task->limits;
    const double *direction = span->task->pool + segment->data + limits->axes;
    for (uint32_t i = 0; i < limits->rows; i++) {
        span->along[i] = fabs(trochia_dot_row(limits, i, direction));
        span->bend[i] = 0.0;
    }
    span->along[limits->rows] = trochia_norm(direction, limits->linear);
    span->bend[limits->rows] = 0.0;
}

static void load_curve(trochia_torque_span *span) {
    const trochia_span *shape = &span->shape;
    for (uint32_t i = 0; i < shape->rows; i++) {
        double t = fmax(fabs(shape->t[0][i]), fabs(shape->t[1][i]));
        double k = fmax(fabs(shape->k[0][i]), fabs(shape->k[1][i]));
        if (shape->even) /* a parabola: bend is the same at both ends, and nothing sags */
            k = fabs(shape->k[0][i]);
        else {
            t += shape->sag_a[i] / 5.0;
            k += shape->sag_w[i];
        }
        span->along[i] = LOOSE * t;
        span->bend[i] = LOOSE * k;
    }
    if (shape->capped) {
        double t = fmax(trochia_norm(shape->along[0], 3), trochia_norm(shape->along[1], 3)) + shape->cap_a / 5.0;
        double k = fmax(trochia_norm(shape->bend[0], 3), trochia_norm(shape->bend[1], 3)) + shape->cap_w;
        span->along[shape->rows] = LOOSE * t;
        span->bend[shape->rows] = LOOSE * k;
    }
}

void trochia_torque_load(const trochia_torque_piece *piece, trochia_torque_span *span) {
    const trochia_segment *segment = &span->task->segments[piece->segment];
    const trochia_limits *limits = span->task->limits;
    trochia_span_load(segment, span->task->pool, &span->bounds, piece->part, piece->parts, &span->shape);
    span->length = segment->length / piece->parts;
    span->rows = limits->rows + (limits->path_acceleration < INFINITY ? 1 : 0);
    if (span->shape.straight)
        load_line(segment, span);
    else
        load_curve(span);
    double feed = segment->speed_limit;
    span->slowed = feed < INFINITY && span->shape.feed < feed * feed * (1.0 - 1e-9);
    double low = 0.0, high = sqrt(span->shape.inside);
    if (left(span, high) < 0.0) {
        for (int i = 0; i < 60; i++) {
            double middle = 0.5 * (low + high);
            if (left(span, middle) < 0.0)
                high = middle;
            else
                low = middle;
        }
        high = low;
    }
    span->ceiling = high;
}

/* The speed where the phase that begins at v ends: no farther than the next knot, nor than a falls by a tenth. */
static double bin_end(const trochia_torque_span *span, double v, double a, double most) {
    double end = most;
    for (uint32_t i = 0; i < span->task->limits->rows; i++) {
        const trochia_fall *fall = &span->task->falls[i];
        for (uint32_t k = 0; k < fall->count && span->along[i] > 0.0; k++) {
            double knot = fall->speed[k] / span->along[i];
            if (knot > v * (1.0 + 1e-9) && knot < end)
                end = knot;
        }
    }
    if (left(span, end) >= DROP * a)
        return end;
    double low = v, high = end;
    for (int i = 0; i < 40; i++) {
        double middle = 0.5 * (low + high), rest = left(span, middle);
        if (rest >= DROP * a)
            low = middle;
        else
            high = middle;
        if (rest >= DROP * a && rest <= NEAR * a)
            break;
    }
    return low > v ? low : end;
}

/* When the phase has gone `way` from its start: Newton's steps from its end, where they fall from one side. */
static double time_at(const trochia_phase *phase, double way) {
    double t = phase->duration;
    for (int i = 0; i < 60; i++) {
        double gone = t * (phase->v + t * (0.5 * phase->a + t * phase->j / 6.0));
        double speed = phase->v + t * (phase->a + 0.5 * t * phase->j);
        double next = t - (gone - way) / speed;
        if (!(next < t) || !(next > 0.0))
            break;
        t = next;
    }
    return t;
}

uint32_t trochia_torque_climb(const trochia_torque_span *span, double v, double most, double way, trochia_phase *out,
                              trochia_phase *end) {
    double s = 0.0, t = 0.0, top = fmin(most, span->ceiling);
    uint32_t made = 0;
    while (made < TROCHIA_TORQUE_BINS && v < top && s < way) {
        double a0 = left(span, v);
        if (!(a0 > 0.0))
            break;
        double next = bin_end(span, v, a0, span->ceiling), a1 = fmax(left(span, next), 0.0);
        double d = (a0 - a1) / (a0 + a1), scale = sqrt((1.0 - d) * (1.0 + d));
        a0 *= scale;
        a1 *= scale;
        if (!(a0 > 0.0))
            break;
        double whole = 2.0 * (next - v) / (a0 + a1);
        trochia_phase phase = {.t = t, .s = s, .v = v, .a = a0, .j = (a1 - a0) / whole, .duration = whole};
        if (next > top) { /* the root that does not take a difference of equals */
            phase.duration = 2.0 * (top - v) / (a0 + sqrt(fmax(a0 * a0 + 2.0 * phase.j * (top - v), 0.0)));
            next = top;
        }
        double gone = phase.duration * (v + phase.duration * (0.5 * a0 + phase.duration * phase.j / 6.0));
        if (s + gone > way) {
            phase.duration = time_at(&phase, way - s);
            next = fmin(next, v + phase.duration * (a0 + 0.5 * phase.duration * phase.j));
            gone = way - s;
        }
        if (!(phase.duration > 0.0) || !(next > v))
            break;
        if (out)
            out[made] = phase;
        made++;
        t += phase.duration;
        s += gone;
        v = next;
    }
    end->t = t;
    end->s = s;
    end->v = v;
    return made;
}

/* A ramp down into v1: the climb from v1, backwards in time, that begins at (t, s). */
static uint32_t descend(const trochia_torque_span *span, double v1, double top, double t, double s,
                        trochia_phase *out) {
    trochia_phase end;
    uint32_t made = trochia_torque_climb(span, v1, top, span->length, out, &end);
    for (uint32_t k = 0; 2 * k < made; k++) {
        trochia_phase other = out[made - 1 - k];
        out[made - 1 - k] = out[k];
        out[k] = other;
    }
    for (uint32_t k = 0; k < made; k++) {
        trochia_phase *p = &out[k];
        double d = p->duration, gone = d * (p->v + d * (0.5 * p->a + d * p->j / 6.0));
        p->v += d * (p->a + 0.5 * d * p->j);
        p->a = -(p->a + d * p->j);
        p->t = t;
        p->s = s;
        t += d;
        s += gone;
    }
    return made;
}

/* The highest speed for which there is room to rise to it and to fall again. */
static double peak_of(const trochia_torque_span *span, double v0, double v1) {
    double low = fmax(v0, v1), high = span->ceiling;
    trochia_phase up, down;
    for (int i = 0; i < 60 && high > low * (1.0 + 1e-12); i++) {
        double middle = i ? 0.5 * (low + high) : high;
        trochia_torque_climb(span, v0, middle, INFINITY, NULL, &up);
        trochia_torque_climb(span, v1, middle, INFINITY, NULL, &down);
        if (up.s + down.s > span->length || up.v < middle || down.v < middle)
            high = middle;
        else if (i == 0)
            return middle;
        else
            low = middle;
    }
    return low;
}

uint32_t trochia_torque_through(const trochia_torque_span *span, double v0, double v1, trochia_phase *out) {
    trochia_phase end, last;
    if (v1 > v0) {
        uint32_t made = trochia_torque_climb(span, v0, span->ceiling, span->length, out, &end);
        if (made && end.v <= v1 * (1.0 + 1e-12) && end.s >= span->length * (1.0 - 1e-12))
            return made;
    } else if (v0 > v1) {
        trochia_torque_climb(span, v1, span->ceiling, span->length, NULL, &end);
        if (end.v <= v0 * (1.0 + 1e-12) && end.s >= span->length * (1.0 - 1e-12))
            return descend(span, v1, INFINITY, 0.0, 0.0, out);
    }
    double top = peak_of(span, v0, v1);
    uint32_t made = trochia_torque_climb(span, v0, top, INFINITY, out, &end);
    trochia_torque_climb(span, v1, top, INFINITY, NULL, &last);
    double stay = span->length - end.s - last.s;
    if (top > 0.0 && stay > TROCHIA_STAY * span->length) {
        trochia_phase even = {.t = end.t, .s = end.s, .v = top, .duration = stay / top};
        out[made++] = even;
        end.t += even.duration;
        end.s += stay;
    }
    return made + descend(span, v1, top, end.t, end.s, out + made);
}
