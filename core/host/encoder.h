/* An encoder edge by edge: edges out of place, edges that are missed, one channel in place of two, the index pulse, and
 * speed by the time between edges.
 *
 * Edge n stands at n + jitter g counts, g drawn anew each time that the motion comes to it (two even spreads added, of
 * unit variance, so that edges never change places).  A missed edge is passed but not counted.  A single channel tells
 * no direction: an edge counts the way that the amplifier drives.  At an index pulse, every `turn` edges, the counter
 * ought to have gained as many counts as edges passed since the first one. */
#ifndef TROCHIA_ENCODER_H
#define TROCHIA_ENCODER_H

#include <stdint.h>

typedef struct {
    double jitter;    /* standard deviation of an edge's place [counts], at most 0.2 */
    double missed;    /* part of the edges that are not counted */
    double clock;     /* of the time between edges [Hz]; 0: speed is not measured by it */
    int64_t turn;     /* edges between index pulses; 0: there are none */
    uint32_t single;  /* 1: one channel */
    uint32_t watched; /* 1: edges are looked at one by one; else the position is cut to whole counts, no more */
} trochia_encoder;

typedef struct {
    uint64_t random;      /* seed, then what follows from it */
    int64_t place, told;  /* edges passed, and counts */
    int64_t step;         /* time steps so far */
    int64_t missed;       /* edges that were not counted */
    int64_t first, off;   /* told - place at the first index pulse, and by how much it was another at the last */
    int64_t pulses;       /* index pulses so far */
    int64_t marked;       /* counts when speed was last measured */
    double up, down;      /* the next edge on either side [counts] */
    double last, mark;    /* time of the last edge counted, and of the one at which speed was last measured [s] */
    double speed;         /* as last measured */
    int32_t way;          /* that the amplifier drives: 1 or -1 */
    uint32_t begun, seen; /* 1: it has begun; 1: an edge has been counted before */
} trochia_encoder_state;

/* Looks at a time step h [s] in which the position went from one place to another [counts], under a command. */
void trochia_encoder_watch(const trochia_encoder *encoder, trochia_encoder_state *s, double from, double to, double h,
                           double command);

/* The speed by time [counts/s] at the end of the last step: counts since it was last asked for over the time between
 * their edges; while none comes, no more than one count in the time since the last. */
double trochia_encoder_speed(trochia_encoder_state *s, double h);

#endif
