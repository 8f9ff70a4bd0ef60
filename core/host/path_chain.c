/* Joints of lines with continuous curvature: every joint adds its own share of x'' to the programmed path.
 *
 * The programmed path p(s), s its length, has p'' = sum of m_i delta(s - s_i).  Replacing each delta by a kernel phi_i
 * of area 1 and mean 0 gives a path x with x - p = sum of m_i psi_i(s - s_i), psi_i'' = phi_i - delta: outside a
 * kernel's support nothing changes, and kernels may overlap.  With phi_i >= 0, psi_i >= 0 is convex on each side of
 * s_i, so |x - p| <= sum of |m_i| psi_i, which is greatest at a joint.  Kept <= P there, it is the bound both ways:
 * x(s) and p(s) are that near.  Kernels are even between knots, so that the curve is made of cubics.
 *
 * Corner: a triangle of legs d, psi(0) = d / 6; d = 6 P / |m|, at most the shorter line.
 *
 * Chain: hats H_j over the lines beside joint j, areas A_j: parts of H_i and of both its neighbours, or, where there is
 * no neighbour or no room for one, (1 - w) H_i / A_i + w H_j / A_j, j on the shorter line's far side and
 * w = (h1 - h0) / (h1 + h0 + h2), which brings the mean to 0.  All knots are joints: one cubic a line, and on even
 * chords of a circle x'' is that of the circle. */
#include <math.h>
#include <stddef.h>

#include "host/path_smooth.h"

static const double UNEVEN = 4.0; /* lines beside a chain's joint differ by no more than this ratio */

static int passes(const trochia_turn *turn) {
    return turn->kind == TROCHIA_TURN_NONE || turn->kind == TROCHIA_TURN_CORNER || turn->kind == TROCHIA_TURN_CHAIN;
}

/* Adds a piece of m psi to a line: value, slope and bend at its start, bend at its end. */
static void add(trochia_link *link, uint32_t n, const double *m, double value, double slope, double y0, double y1) {
    trochia_bend *bend = &link->bend;
    if (!bend->there)
        for (uint32_t i = 0; i < n; i++)
            bend->e0[i] = bend->d0[i] = bend->y0[i] = bend->y1[i] = 0.0;
    bend->there = 1;
    for (uint32_t i = 0; i < n; i++) {
        bend->e0[i] += m[i] * value;
        bend->d0[i] += m[i] * slope;
        bend->y0[i] += m[i] * y0;
        bend->y1[i] += m[i] * y1;
    }
}

/* The hats of a joint with lines h0 before and h1 after, and h2 beyond the shorter; returns the greatest psi here, and
 * at the joint leant on. */
static double hats(trochia_turn *turn, double h0, double h1, double h2, double *there) {
    double longer = fmax(h0, h1), shorter = fmin(h0, h1);
    double moved = turn->lean ? (longer - shorter) / (longer + shorter + h2) : 0.0;
    turn->own = (1.0 - moved) * 2.0 / (h0 + h1);
    turn->lent = turn->lean ? moved * 2.0 / (shorter + h2) : 0.0;
    *there = turn->lent * h2 * h2 / 6.0;
    return turn->own * longer * longer / 6.0;
}

static void put_chain(const trochia_chain *chain, uint32_t n, uint64_t i, double h0, double h1, double h2) {
    trochia_link *before = trochia_link_at(chain, i - 1), *after = trochia_link_at(chain, i);
    const trochia_turn *turn = &after->turn;
    const double *m = turn->jump;
    double own = turn->own, lent = turn->lent;
    if (turn->lean < 0) {
        add(trochia_link_at(chain, i - 2), n, m, 0.0, 0.0, 0.0, lent);
        add(before, n, m, lent * h2 * h2 / 6.0, lent * h2 / 2.0, lent, own);
        add(after, n, m, own * h1 * h1 / 6.0, -own * h1 / 2.0, own, 0.0);
        return;
    }
    add(before, n, m, 0.0, 0.0, 0.0, own);
    add(after, n, m, own * h0 * h0 / 6.0, own * h0 / 2.0 - 1.0, own, lent);
    if (turn->lean > 0)
        add(trochia_link_at(chain, i + 1), n, m, lent * h2 * h2 / 6.0, -lent * h2 / 2.0, lent, 0.0);
}

/* Returns 1 when the joint's hats fit inside what is left of P here and at the joint they lean on. */
static int settle_chain(const trochia_chain *chain, uint32_t n, uint64_t i) {
    trochia_turn *turn = &trochia_link_at(chain, i)->turn, *other = NULL;
    const trochia_link *beyond = NULL;
    double h0 = trochia_link_at(chain, i - 1)->curve.length, h1 = trochia_link_at(chain, i)->curve.length, h2 = 0.0;
    double there;
    if (fmax(h0, h1) > UNEVEN * fmin(h0, h1) || trochia_takes(&trochia_link_at(chain, i - 1)->turn) ||
        trochia_takes(&trochia_link_at(chain, i + 1)->turn))
        return 0;
    turn->lean = fabs(h1 - h0) <= 1e-12 * (h0 + h1) ? 0 : h1 > h0 ? -1 : 1;
    if (turn->lean < 0) {
        if (i < 2 || trochia_takes(&trochia_link_at(chain, i - 2)->turn))
            return 0;
        other = &trochia_link_at(chain, i - 1)->turn;
        beyond = trochia_link_at(chain, i - 2);
    } else if (turn->lean > 0) {
        if (i + 2 > chain->count || trochia_takes(&trochia_link_at(chain, i + 2)->turn))
            return 0;
        other = &trochia_link_at(chain, i + 1)->turn;
        beyond = trochia_link_at(chain, i + 1);
    }
    if (beyond && (!passes(other) || beyond->curve.kind != TROCHIA_LINE))
        return 0;
    if (beyond)
        h2 = beyond->curve.length;
    double here = turn->size * hats(turn, h0, h1, h2, &there);
    if (turn->used + here > turn->tolerance || (other && other->used + turn->size * there > other->tolerance))
        return 0;
    turn->kind = TROCHIA_TURN_CHAIN;
    turn->used += here;
    if (other)
        other->used += turn->size * there;
    put_chain(chain, n, i, h0, h1, h2);
    return 1;
}

/* Hats on this joint and both beside it, as an exchange between neighbours: with bends m_j = kappa A_j (a circle's) and
 * (w A) dc = C - h^2 / 6 given across each line h between hats whose means lie dc apart, every mean is 0, and all that
 * a joint gives it gets back.  So any chords of a circle bend as the circle does where C, here the longest line's, is
 * the same all along.  Returns 1 when that fits inside what is left of P at the three joints. */
static int settle_spread(const trochia_chain *chain, uint32_t n, uint64_t i) {
    if (i < 2 || i + 2 > chain->count || trochia_takes(&trochia_link_at(chain, i - 2)->turn) ||
        trochia_takes(&trochia_link_at(chain, i + 2)->turn))
        return 0;
    trochia_turn *last = &trochia_link_at(chain, i - 1)->turn, *turn = &trochia_link_at(chain, i)->turn;
    trochia_turn *next = &trochia_link_at(chain, i + 1)->turn;
    double h[4], longest = 0.0, shortest = INFINITY;
    for (uint64_t k = 0; k < 4; k++) {
        const trochia_curve *line = &trochia_link_at(chain, i - 2 + k)->curve;
        if (line->kind != TROCHIA_LINE)
            return 0;
        h[k] = line->length;
        longest = fmax(longest, h[k]);
        shortest = fmin(shortest, h[k]);
    }
    if (!passes(last) || !passes(next) || longest > UNEVEN * shortest || longest - shortest <= 1e-12 * longest)
        return 0;
    double area = 0.5 * (h[1] + h[2]), whole = longest * longest;
    double left = 0.5 * (whole - h[1] * h[1]) / (h[0] + h[1] + h[2]) / area;
    double right = 0.5 * (whole - h[2] * h[2]) / (h[1] + h[2] + h[3]) / area;
    double own = (1.0 - left - right) / area, l = 2.0 * left / (h[0] + h[1]), r = 2.0 * right / (h[2] + h[3]);
    double here = own * h[1] * h[1] / 6.0 + left * (2.0 * h[1] + h[0]) / 3.0;
    double there[2] = {l * h[0] * h[0] / 6.0, r * h[3] * h[3] / 6.0};
    if (own < 0.0 || turn->used + turn->size * here > turn->tolerance ||
        last->used + turn->size * there[0] > last->tolerance || next->used + turn->size * there[1] > next->tolerance)
        return 0;
    turn->kind = TROCHIA_TURN_CHAIN;
    turn->used += turn->size * here;
    last->used += turn->size * there[0];
    next->used += turn->size * there[1];
    const double *m = turn->jump;
    add(trochia_link_at(chain, i - 2), n, m, 0.0, 0.0, 0.0, l);
    add(trochia_link_at(chain, i - 1), n, m, there[0], 0.5 * l * h[0], l, own);
    add(trochia_link_at(chain, i), n, m, here, left + 0.5 * own * h[1] - 1.0, own, r);
    add(trochia_link_at(chain, i + 1), n, m, there[1], -0.5 * r * h[3], r, 0.0);
    return 1;
}

void trochia_turn_settle(const trochia_chain *chain, uint32_t n, uint64_t i) {
    trochia_turn *turn = &trochia_link_at(chain, i)->turn;
    if (settle_spread(chain, n, i) || settle_chain(chain, n, i))
        return;
    const trochia_turn *last = &trochia_link_at(chain, i - 1)->turn, *next = &trochia_link_at(chain, i + 1)->turn;
    double h0 = trochia_link_at(chain, i - 1)->curve.length, h1 = trochia_link_at(chain, i)->curve.length;
    double wish = fmin(turn->wish, 6.0 * fmax(turn->tolerance - turn->used, 0.0) / turn->size);
    double before = trochia_takes(last) ? h0 - last->after : last->kind == TROCHIA_TURN_STOP ? REST_SHARE * h0 : h0;
    double after = trochia_takes(next)               ? trochia_share(wish, next->wish, h1)
                   : next->kind == TROCHIA_TURN_STOP ? REST_SHARE * h1
                                                     : h1;
    turn->before = turn->after = fmin(wish, fmin(before, after));
    turn->used += turn->size * turn->after / 6.0;
    turn->lean = 0;
    if (!(turn->after > 0.0))
        turn->kind = TROCHIA_TURN_STOP;
}

/* The line's polynomial about s = from, with its share of chains and corners; the middle says which corners reach here,
 * whatever rounding does to the knots. */
static void expand(const trochia_link *link, const double *first_jump, const double *last_jump, uint32_t n, double from,
                   double first, double last, double *c) {
    const trochia_curve *line = &link->curve;
    const trochia_bend *bend = &link->bend;
    double h = line->length;
    for (uint32_t i = 0; i < n; i++) {
        c[i] = line->x0[i] + line->t0[i] * from;
        c[n + i] = line->t0[i];
        c[2 * n + i] = c[3 * n + i] = 0.0;
        if (bend->there) {
            double third = (bend->y1[i] - bend->y0[i]) / h;
            c[i] += bend->e0[i] + from * (bend->d0[i] + from * (0.5 * bend->y0[i] + from * third / 6.0));
            c[n + i] += bend->d0[i] + from * (bend->y0[i] + 0.5 * from * third);
            c[2 * n + i] += 0.5 * (bend->y0[i] + third * from);
            c[3 * n + i] += third / 6.0;
        }
        if (first_jump) {
            double m = first_jump[i], u = 1.0 - from / first;
            c[i] += m * first / 6.0 * u * u * u;
            c[n + i] -= m * 0.5 * u * u;
            c[2 * n + i] += m * 0.5 * u / first;
            c[3 * n + i] -= m / (6.0 * first * first);
        }
        if (last_jump) {
            double m = last_jump[i], u = (from - (h - last)) / last;
            c[i] += m * last / 6.0 * u * u * u;
            c[n + i] += m * 0.5 * u * u;
            c[2 * n + i] += m * 0.5 * u / last;
            c[3 * n + i] += m / (6.0 * last * last);
        }
    }
}

void trochia_emit_bent(trochia_reader *r, const trochia_link *link, const trochia_turn *next) {
    const trochia_turn *turn = &link->turn;
    const trochia_curve *line = &link->curve;
    double h = line->length, c[36];
    double start = trochia_takes(turn) ? turn->after : 0.0, end = trochia_takes(next) ? h - next->before : h;
    double first = turn->kind == TROCHIA_TURN_CORNER ? turn->after : start;
    double last = next->kind == TROCHIA_TURN_CORNER ? h - next->before : end;
    double knots[4] = {start, fmin(first, last), fmax(first, last), end};
    for (int k = 0; k < 3; k++) {
        double from = knots[k], to = knots[k + 1], middle = 0.5 * (from + to);
        if (trochia_is_rounding(to - from, h))
            continue;
        int begins = turn->kind == TROCHIA_TURN_CORNER && middle < first;
        int ends = next->kind == TROCHIA_TURN_CORNER && middle > last;
        if (begins || ends || link->bend.there) {
            expand(link, begins ? turn->jump : NULL, ends ? next->jump : NULL, r->frame.n, from, first, h - last, c);
            trochia_emit_cubic(r, c, to - from, line->speed, line->move);
        } else
            trochia_emit_curve(r, line, from, to - from);
    }
}
