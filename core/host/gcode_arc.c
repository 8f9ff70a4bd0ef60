/* Centre and turns of a plain arc.  The rules and the arithmetic, operation for operation, are those of the
 * interpreter's arc module: both give the same bits. */
#include "host/gcode.h"

#include <math.h>

enum { OFFSET_SLOT = 9, RADIUS_SLOT = 12 };

static const uint8_t FIRST[3] = {0, 1, 2}, SECOND[3] = {1, 2, 0}, NORMAL[3] = {2, 0, 1};

static double distance(double x, double y) {
    return sqrt(x * x + y * y);
}

static int centre_form(const trochia_modal *modal, const trochia_plain_line *line, trochia_move *row) {
    const unsigned axes[2] = {FIRST[modal->plane], SECOND[modal->plane]};
    for (unsigned k = 0; k < 2; k++) {
        const unsigned slot = OFFSET_SLOT + axes[k];
        const int given = line->seen >> slot & 1;
        if (modal->centre_absolute && !given) {
            return 0;
        }
        const double word = given ? line->word[slot] : 0.0;
        row->centre[k] = modal->centre_absolute ? word : modal->position[axes[k]] + word;
    }
    const double start = distance(modal->position[axes[0]] - row->centre[0], modal->position[axes[1]] - row->centre[1]);
    const double end = distance(row->target[axes[0]] - row->centre[0], row->target[axes[1]] - row->centre[1]);
    const double difference = fabs(start - end), greater = start > end ? start : end;
    return start >= modal->least_radius && end >= modal->least_radius && difference <= modal->spiral_most &&
           (difference <= modal->spiral || difference / greater <= modal->spiral_share);
}

/* Of the two circles of radius |R| through both ends, R > 0 takes the arc of at most half a turn.  A chord within 1e-12
 * of the diameter counts as the diameter. */
static int radius_form(const trochia_modal *modal, const trochia_plain_line *line, uint8_t motion, trochia_move *row) {
    const unsigned first = FIRST[modal->plane], second = SECOND[modal->plane];
    const double x = modal->position[first], y = modal->position[second], radius = line->word[RADIUS_SLOT];
    const double across = row->target[first] - x, up = row->target[second] - y, chord = distance(across, up);
    const double half = chord / 2.0, size = fabs(radius);
    if (chord == 0.0 || size == 0.0 || half - size > modal->least_radius) {
        return 0;
    }
    const double away = half > size * (1.0 - 1e-12) ? 0.0 : sqrt(size * size - half * half);
    const double left = away / chord * ((motion == 3) == (radius > 0.0) ? 1.0 : -1.0);
    row->centre[0] = (x + row->target[first]) / 2.0 - up * left;
    row->centre[1] = (y + row->target[second]) / 2.0 + across * left;
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
