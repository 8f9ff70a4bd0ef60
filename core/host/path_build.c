/* A program's moves into segments, in one pass with three curves in hand: how much of a curve the joint at its end may
 * take depends on what the joint at its start wants of it. */
#include <math.h>
#include <string.h>

#include "host/path_curve.h"

/* Where the feed changes at the joint the blend is cut there, so that each side keeps its own. */
static void emit_blend(trochia_reader *r, const trochia_curve *a, const trochia_curve *b, double before,
                       const trochia_blend *blend) {
    uint32_t n = r->frame.n;
    if (a->speed == b->speed || before == 0.0 || before == blend->length) {
        trochia_emit_cubic(r, blend->c, blend->length, before == 0.0 ? b->speed : a->speed, b->move);
        return;
    }
    double rest[36];
    const double *c = blend->c;
    trochia_shift_cubic(n, c, before, rest);
    trochia_emit_cubic(r, c, before, a->speed, a->move);
    trochia_emit_cubic(r, rest, blend->length - before, b->speed, b->move);
}

/* Settles the joint from `a` to `b`, given what is wanted of `b` at its other end; emits `a` and the blend. */
static void settle(trochia_reader *r, const trochia_curve *a, trochia_curve *b, double cut, double wanted_of_b,
                   int b_rests, trochia_joint *joint) {
    trochia_blend blend = {.length = 0.0};
    if (joint->before > 0.0 || joint->after > 0.0) {
        double before = fmin(joint->before, a->rested ? REST_SHARE * a->length : a->length - cut);
        double after =
            fmin(joint->after, b_rests ? REST_SHARE * b->length : trochia_share(joint->after, wanted_of_b, b->length));
        if (joint->before > 0.0 && joint->after > 0.0)
            before = after = fmin(before, after);
        joint->before = before;
        joint->after = after;
        trochia_joint_blend(&r->frame, a, b, joint, &blend);
    }
    trochia_emit_curve(r, a, cut, a->length - cut - joint->before);
    b->rested = (uint8_t)(joint->stop != 0);
    if (joint->stop)
        r->out->segments[r->out->segment_count - 1].stop = 1;
    else if (blend.length > 0.0)
        emit_blend(r, a, b, joint->before, &blend);
}

int32_t trochia_path_build(const trochia_path_input *input, trochia_path_output *output) {
    if (input->continuity > 1)
        return trochia_path_smooth(input, output);
    trochia_reader reader = {.in = input, .out = output};
    trochia_curve curves[3];
    trochia_curve *a = NULL, *b = NULL, *c = &curves[0]; /* the last two curves, and where the next is read to */
    trochia_joint ab = {0.0, 0.0, 0};
    double cut = 0.0; /* taken of a at its start */

    trochia_start_reader(&reader);
    for (uint64_t row = 0; row < input->count; row = trochia_next_row(&reader, row)) {
        int32_t wrong = trochia_read_curve(&reader, row, c);
        if (wrong) {
            output->failed_move = row;
            return wrong;
        }
        if (c->length == 0.0)
            continue;
        trochia_joint bc = {0.0, 0.0, 0};
        c->rested = b == NULL;
        if (b)
            bc = trochia_joint_wanted(&reader.frame, b, c);
        if (a) {
            settle(&reader, a, b, cut, bc.before, bc.stop, &ab);
            cut = ab.after;
        }
        trochia_curve *next = a ? a : &curves[b ? 2 : 1];
        a = b;
        b = c;
        c = next;
        ab = bc;
    }
    if (a) {
        settle(&reader, a, b, cut, 0.0, 1, &ab);
        cut = ab.after;
    }
    if (b)
        trochia_emit_curve(&reader, b, cut, b->length - cut);
    if (output->segment_count)
        output->segments[output->segment_count - 1].stop = 1;
    return 0;
}
