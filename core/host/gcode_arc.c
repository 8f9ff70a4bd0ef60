/* Centre and turns of a plain arc.  The rules and the arithmetic, operation for operation, are those of the
 * interpreter's arc module: both give the same bits. */
#include "host/gcode.h"

#include <math.h>

enum { OFFSET_SLOT = 9, RADIUS_SLOT = 12 };

static const uint8_t FIRST[3] = {0, 1, 2}, SECOND[3] = {1, 2, 0}, NORMAL[3] = {2, 0, 1};

static int centre_form(const trochia_modal *modal, const trochia_plain_line *line, trochia_move *row) {
    const unsigned first = FIRST[modal->plane], second = SECOND[modal->plane];
    const unsigned ways[2] = {first, second};
    for (unsigned k = 0; k < 2; k++) {
        const unsigned slot = OFFSET_SLOT + ways[k];
        if (line->seen >> slot & 1) {
            row->centre[k] = modal->centre_absolute ? line->word[slot] : modal->position[ways[k]] + line->word[slot];
        } else if (modal->centre_absolute) {
            return 0;
        } else {
            row->centre[k] = modal->position[ways[k]];
        }
    }
    const double from_x = modal->position[first] - row->centre[0], from_y = modal->position[second] - row->centre[1];
    const double to_x = row->target[first] - row->centre[0], to_y = row->target[second] - row->centre[1];
    const double start = sqrt(from_x * from_x + from_y * from_y), end = sqrt(to_x * to_x + to_y * to_y);
    const double difference = fabs(start - end), greater = start > end ? start : end;
    return start >= modal->least_radius && end >= modal->least_radius && difference <= modal->spiral_most &&
           (difference <= modal->spiral || difference <= modal->spiral_share * greater);
}

/* Of the two circles of radius |R| through both ends, R > 0 takes the arc of at most half a turn.  A chord within 1e-12
 * of the diameter counts as the diameter. */
static int radius_form(const trochia_modal *modal, const trochia_plain_line *line, uint8_t motion, trochia_move *row) {
    const unsigned first = FIRST[modal->plane], second = SECOND[modal->plane];
    const double x = modal->position[first], y = modal->position[second];
    const double along_x = row->target[first] - x, along_y = row->target[second] - y;
    const double half = sqrt(along_x * along_x + along_y * along_y) / 2.0, radius = fabs(line->word[RADIUS_SLOT]);
    if (half == 0.0 || radius == 0.0 || half - radius > modal->least_radius) {
        return 0;
    }
    const double height = half / radius > 1.0 - 1e-12 ? 0.0 : sqrt(radius * radius - half * half);
    const int right = (motion == 2) == (line->word[RADIUS_SLOT] > 0.0);
    const double share = (right ? height : -height) / (2.0 * half);
    row->centre[0] = (x + row->target[first]) / 2.0 + share * along_y;
    row->centre[1] = (y + row->target[second]) / 2.0 - share * along_x;
    return 1;
}

int32_t trochia_gcode_arc(const trochia_modal *modal, const trochia_plain_line *line, uint8_t motion,
                          trochia_move *row) {
    const unsigned first = FIRST[modal->plane], second = SECOND[modal->plane];
    const uint32_t in_plane = 1U << first | 1U << second, offsets = line->seen >> OFFSET_SLOT & 7U;
    const int by_radius = line->seen >> RADIUS_SLOT & 1;
    row->kind = TROCHIA_ARC;
    row->turns = motion == 2 ? -1 : 1;
    if (by_radius) {
        return offsets == 0 && (line->seen & in_plane) != 0 && radius_form(modal, line, motion, row);
    }
    return (offsets & in_plane) != 0 && (offsets & 1U << NORMAL[modal->plane]) == 0 && centre_form(modal, line, row);
}
