/* A program's moves into a path of continuous curvature, in one pass: while one move is read, the joint two moves back
 * is settled, and the move four back, which no joint still to come can touch, is written. */
#include <string.h>
#include <math.h>

#include "host/path_smooth.h"

/* What a joint that takes part of its curves gets of them. */
static void settle_taking(const trochia_frame *frame, const trochia_chain *chain, uint64_t i) {
    trochia_link *a = trochia_link_at(chain, i - 1), *b = trochia_link_at(chain, i);
    const trochia_turn *next = &trochia_link_at(chain, i + 1)->turn;
    trochia_turn *turn = &b->turn;
    double before = fmin(turn->wish, a->curve.length - a->turn.after);
    double after =
        next->wish > 0.0 ? trochia_share(turn->wish, next->wish, b->curve.length) : fmin(turn->wish, b->curve.length);
    turn->before = turn->after = fmin(before, after);
    if (turn->kind == TROCHIA_TURN_ARC)
        trochia_bridge_settle(frame, &a->curve, &b->curve, turn);
    if (turn->kind == TROCHIA_TURN_ARC && !trochia_bridge_worth(frame, &a->curve, &b->curve, turn)) {
        turn->before = turn->after = 0.0;
        turn->kind = TROCHIA_TURN_STOP;
    }
}

/* Settles the joint at the start of link i; links up to i + 2 are classified, or past the program's end. */
static void settle(const trochia_frame *frame, const trochia_chain *chain, uint64_t i) {
    trochia_turn *turn = &trochia_link_at(chain, i)->turn;
    if (turn->kind == TROCHIA_TURN_CORNER)
        trochia_turn_settle(chain, frame->n, i);
    else if (trochia_takes(turn))
        settle_taking(frame, chain, i);
}

/* Where the feed changes at the joint, the middle cubic is cut there, so that each side keeps its own. */
static void emit_bridge(trochia_reader *r, const trochia_curve *a, const trochia_curve *b, const trochia_turn *turn) {
    trochia_bridge bridge;
    uint32_t n = r->frame.n;
    trochia_bridge_make(&r->frame, a, b, turn, &bridge);
    double k = bridge.length, u = 0.5 * k;
    double *c = bridge.c[1], rest[36];
    trochia_emit_cubic(r, bridge.c[0], k, a->speed, a->move);
    trochia_shift_cubic(n, c, u, rest);
    if (a->speed == b->speed)
        trochia_emit_cubic(r, c, k, b->speed, b->move);
    else {
        trochia_emit_cubic(r, c, u, a->speed, a->move);
        trochia_emit_cubic(r, rest, k - u, b->speed, b->move);
    }
    trochia_emit_cubic(r, bridge.c[2], k, b->speed, b->move);
}

static void emit(trochia_reader *r, const trochia_chain *chain, uint64_t j) {
    trochia_link *link = trochia_link_at(chain, j), *next = trochia_link_at(chain, j + 1);
    const trochia_turn *turn = &next->turn;
    if (link->curve.kind == TROCHIA_LINE)
        trochia_emit_bent(r, link, turn);
    else
        trochia_emit_curve(r, &link->curve, link->turn.after, link->curve.length - link->turn.after - turn->before);
    if (turn->kind == TROCHIA_TURN_STOP)
        r->out->segments[r->out->segment_count - 1].stop = 1;
    else if (turn->kind == TROCHIA_TURN_ARC)
        emit_bridge(r, &link->curve, &next->curve, turn);
    else if (turn->kind == TROCHIA_TURN_OVERLAP)
        trochia_emit_overlap(r, &link->curve, &next->curve, turn);
}

static void end_here(trochia_link *link) {
    memset(&link->turn, 0, sizeof link->turn);
    link->turn.kind = TROCHIA_TURN_STOP;
    link->bend.there = 0;
}

/* Takes in the curve read into the next link. */
static void take(trochia_reader *r, trochia_chain *chain) {
    uint64_t k = chain->count++;
    trochia_link *link = trochia_link_at(chain, k);
    end_here(link);
    if (k)
        trochia_turn_classify(&r->frame, &trochia_link_at(chain, k - 1)->curve, &link->curve, &link->turn);
    if (k > 1)
        trochia_overlap_yield(&trochia_link_at(chain, k - 1)->turn, &link->turn);
    if (k > 2)
        settle(&r->frame, chain, k - 2);
    if (k > 3)
        emit(r, chain, k - 4);
}

static void finish(trochia_reader *r, const trochia_chain *chain) {
    uint64_t count = chain->count;
    end_here(trochia_link_at(chain, count));
    end_here(trochia_link_at(chain, count + 1));
    for (uint64_t i = count > 2 ? count - 2 : 1; i < count; i++)
        settle(&r->frame, chain, i);
    for (uint64_t j = count > 4 ? count - 4 : 0; j < count; j++)
        emit(r, chain, j);
}

int32_t trochia_path_smooth(const trochia_path_input *input, trochia_path_output *output) {
    trochia_reader reader = {.in = input, .out = output};
    trochia_link ring[8];
    trochia_chain chain = {.ring = ring, .count = 0};
    trochia_start_reader(&reader);
    for (uint64_t row = 0; row < input->count;) {
        uint64_t first = row;
        trochia_curve *curve = &trochia_link_at(&chain, chain.count)->curve;
        int32_t wrong = trochia_read_merged(&reader, &row, curve);
        if (wrong) {
            output->failed_move = first;
            return wrong;
        }
        if (curve->length > 0.0)
            take(&reader, &chain);
    }
    finish(&reader, &chain);
    return 0;
}
