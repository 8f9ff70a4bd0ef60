/* Curves: points of them, and the segments they become. */
#include <math.h>
#include <string.h>

#include "host/path_curve.h"

void trochia_curve_at(const trochia_curve *curve, uint32_t n, double s, uint32_t orders, double *out) {
    if (curve->kind == TROCHIA_LINE) {
        for (uint32_t i = 0; i < n; i++) {
            out[i] = s < 0.5 * curve->length ? curve->x0[i] + curve->t0[i] * s
                                             : curve->x1[i] - curve->t0[i] * (curve->length - s);
            if (orders > 1)
                out[n + i] = curve->t0[i];
        }
        return;
    }
    if (curve->kind == TROCHIA_CUBIC) {
        trochia_segment cubic = {.kind = TROCHIA_CUBIC};
        trochia_segment_at(&cubic, curve->c, n, s, orders, out);
        return;
    }
    double pool[7 + 18];
    trochia_segment segment = {.kind = TROCHIA_ARC_SEGMENT, .first = curve->first, .second = curve->second};
    memcpy(pool, curve->c, 6 * sizeof *pool);
    for (uint32_t i = 0; i < n; i++) {
        int in_plane = i == curve->first || i == curve->second;
        pool[6 + i] = in_plane ? 0.0 : curve->x0[i];
        pool[6 + n + i] = in_plane ? 0.0 : curve->t0[i];
    }
    pool[6 + 2 * n] = curve->c[6];
    trochia_segment_at(&segment, pool, n, s, orders, out);
}

void trochia_shift_cubic(uint32_t n, const double *c, double u, double *out) {
    for (uint32_t i = 0; i < n; i++) {
        double c1 = c[n + i], c2 = c[2 * n + i], c3 = c[3 * n + i];
        out[i] = c[i] + u * (c1 + u * (c2 + u * c3));
        out[n + i] = c1 + u * (2.0 * c2 + u * 3.0 * c3);
        out[2 * n + i] = c2 + 3.0 * c3 * u;
        out[3 * n + i] = c3;
    }
}

void trochia_emit_cubic(trochia_reader *r, const double *c, double length, double speed, uint32_t move) {
    trochia_append(r, length, speed, move, TROCHIA_CUBIC);
    memcpy(r->out->pool + r->out->pool_count, c, 4 * r->frame.n * sizeof *c);
    r->out->pool_count += 4 * r->frame.n;
}

trochia_segment *trochia_append(trochia_reader *r, double length, double speed, uint32_t move, uint8_t kind) {
    trochia_segment *segment = &r->out->segments[r->out->segment_count++];
    *segment = (trochia_segment){
        .length = length, .speed_limit = speed, .data = r->out->pool_count, .move = move, .kind = kind};
    return segment;
}

/* What the joints have left of a curve; nothing at all where both blends meet. */
void trochia_emit_curve(trochia_reader *r, const trochia_curve *curve, double cut, double length) {
    uint32_t n = r->frame.n;
    if (trochia_is_rounding(length, curve->length))
        return;
    if (curve->kind == TROCHIA_CUBIC) {
        double c[36];
        trochia_shift_cubic(n, curve->c, cut, c);
        trochia_emit_cubic(r, c, length, curve->speed, curve->move);
        return;
    }
    trochia_segment *segment = trochia_append(r, length, curve->speed, curve->move, curve->kind);
    double *c = r->out->pool + r->out->pool_count;
    if (curve->kind == TROCHIA_LINE) {
        for (uint32_t i = 0; i < n; i++) {
            c[i] = curve->x0[i] + curve->t0[i] * cut;
            c[n + i] = curve->t0[i];
        }
        r->out->pool_count += 2 * n;
        return;
    }
    const double *arc = curve->c;
    segment->first = curve->first;
    segment->second = curve->second;
    memcpy(c, arc, 6 * sizeof *c);
    c[2] += arc[5] * cut;
    c[3] += cut * (arc[4] + arc[6] * cut);
    c[4] += 2.0 * arc[6] * cut;
    for (uint32_t i = 0; i < n; i++) {
        int in_plane = i == curve->first || i == curve->second;
        c[6 + i] = in_plane ? 0.0 : curve->x0[i] + curve->t0[i] * cut;
        c[6 + n + i] = in_plane ? 0.0 : curve->t0[i];
    }
    c[6 + 2 * n] = arc[6];
    r->out->pool_count += 7 + 2 * n;
}
