/* Program coordinates into machine coordinates, F words into rates. */
#include "host/placement.h"

#include <string.h>

static const uint8_t IS_ROTARY[TROCHIA_AXES] = {0, 0, 0, 1, 1, 1, 0, 0, 0};
static const uint8_t FIRST[3] = {0, 1, 2}, SECOND[3] = {1, 2, 0};

static void turn(const trochia_placement *placement, double *x, double *y) {
    const double old_x = *x, old_y = *y;
    *x = placement->cosine * old_x - placement->sine * old_y;
    *y = placement->sine * old_x + placement->cosine * old_y;
}

static void place_target(const trochia_placement *placement, double *target) {
    for (unsigned k = 0; k < TROCHIA_AXES; k++) {
        target[k] += placement->shift[k];
    }
    if (placement->sine != 0.0 || placement->cosine != 1.0) {
        turn(placement, &target[0], &target[1]);
    }
    for (unsigned k = 0; k < TROCHIA_AXES; k++) {
        target[k] += placement->origin[k];
        target[k] *= IS_ROTARY[k] ? 1.0 : placement->scale;
    }
}

static void place_centre(const trochia_placement *placement, double *centre) {
    const unsigned first = FIRST[placement->plane], second = SECOND[placement->plane];
    centre[0] += placement->shift[first];
    centre[1] += placement->shift[second];
    if (placement->plane == TROCHIA_XY && (placement->sine != 0.0 || placement->cosine != 1.0)) {
        turn(placement, &centre[0], &centre[1]);
    }
    centre[0] = (centre[0] + placement->origin[first]) * placement->scale;
    centre[1] = (centre[1] + placement->origin[second]) * placement->scale;
}

/* 1 where the row is a straight move of rotary axes alone, whose feed is in degrees. */
static int turns_only(const trochia_placement *placement, const trochia_move *move) {
    int linear = move->kind == TROCHIA_ARC, rotary = 0;
    for (unsigned k = 0; k < TROCHIA_AXES; k++) {
        const int moved = move->target[k] != placement->position[k];
        linear |= moved & !IS_ROTARY[k];
        rotary |= moved & IS_ROTARY[k];
    }
    return rotary && !linear;
}

static double rate_of(const trochia_placement *placement, const trochia_move *move) {
    if (move->kind == TROCHIA_RAPID) {
        return 0.0;
    }
    if (placement->law == TROCHIA_INVERSE) {
        return move->rate / 60.0;
    }
    const double rate = turns_only(placement, move) ? move->rate : move->rate * placement->feed_scale;
    return placement->law == TROCHIA_PER_REV ? rate : rate / 60.0;
}

static void place_move(trochia_placement *placement, trochia_move *move) {
    place_target(placement, move->target);
    if (move->kind == TROCHIA_ARC) {
        place_centre(placement, move->centre);
    }
    move->rate = rate_of(placement, move);
    memcpy(placement->position, move->target, sizeof placement->position);
    memcpy(move->tolerance, placement->tolerance, sizeof move->tolerance);
    move->plane = placement->plane;
    move->law = placement->law;
    move->path_mode = placement->path_mode;
}

uint64_t trochia_place(const trochia_move *rows, uint64_t count, trochia_placement *placement, trochia_move *out) {
    uint64_t made = 0;
    for (uint64_t k = 0; k < count; k++) {
        if (rows[k].kind == TROCHIA_FEED_ROW) {
            placement->feed = rows[k].rate;
            placement->feed_scale = placement->scale;
        } else if (rows[k].kind == TROCHIA_SPEED_ROW) {
            placement->speed = rows[k].rate;
            placement->new_speed = 1;
        } else if (rows[k].kind != TROCHIA_COMMENT_ROW) {
            memmove(&out[made], &rows[k], sizeof *out);
            if (placement->fills) {
                out[made].power = placement->lit ? (float)placement->speed : 0.0F;
            }
            place_move(placement, &out[made++]);
        }
    }
    return made;
}
