#include "host/contour.h"

#include <math.h>
#include <stdbool.h>

#define REACH 4.0 /* least search along the path, in distances of the point from where it should be */
#define NEWTON 6  /* the chord's foot is near; squares of an error of at most half a sample */
#define DIMS 9

typedef struct {
    double square; /* of the distance */
    double u;      /* place in the chord, 0 to 1 */
    int64_t chord;
} foot;

typedef struct {
    const double *path, *arc;
    int64_t points, dims, window;
} track;

static double square_distance(const double *a, const double *b, int64_t dims) {
    double sum = 0;
    for (int64_t k = 0; k < dims; k++) {
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    }
    return sum;
}

/* Nearest point of one chord. */
static foot on_chord(const track *t, int64_t chord, const double *point) {
    const double *from = t->path + chord * t->dims, *to = from + t->dims;
    double along = 0, length = 0, gap = 0;
    for (int64_t k = 0; k < t->dims; k++) {
        const double d = to[k] - from[k], w = point[k] - from[k];
        along += d * w;
        length += d * d;
        gap += w * w;
    }
    const double u = fmin(fmax(along / length, 0), 1);
    return (foot){.square = fmax(gap - u * (2 * along - u * length), 0), .u = u, .chord = chord};
}

/* Walk from row `at` in one direction; keep what is nearer than `best`. */
static foot walk(const track *t, int64_t at, int64_t step, const double *point, double reach, foot best) {
    int64_t idle = 0;
    for (int64_t chord = step > 0 ? at : at - 1; chord >= 0 && chord < t->points - 1; chord += step) {
        const double travelled = fabs(t->arc[step > 0 ? chord : chord + 1] - t->arc[at]);
        if (idle > 0 && (travelled > reach || idle > t->window)) {
            break;
        }
        const foot here = on_chord(t, chord, point);
        if (here.square < best.square) {
            best = here;
            idle = 0;
        } else {
            idle++;
        }
    }
    return best;
}

/* Hermite cubic over a chord, tangents by central differences of its neighbours: p = c0 + u(c1 + u(c2 + u c3)).  Where
 * the path ends a parabola goes on (from rest, that is constant acceleration). */
static void cubic_over(const track *t, int64_t chord, double c[4][DIMS]) {
    const int64_t dims = t->dims;
    const double *from = t->path + chord * dims, *to = from + dims;
    for (int64_t k = 0; k < dims; k++) {
        const double d = to[k] - from[k];
        const bool first = chord == 0, last = chord + 2 == t->points;
        double before = first ? d : from[k] - from[k - dims];
        double after = last ? d : to[k + dims] - to[k];
        before = first ? 2 * d - after : before;
        after = last ? 2 * d - before : after;
        const double m = 0.5 * (before + d), n = 0.5 * (d + after);
        c[0][k] = from[k];
        c[1][k] = m;
        c[2][k] = 3 * d - 2 * m - n;
        c[3][k] = m + n - 2 * d;
    }
}

/* Squared distance at u; its half's first and second derivative by u. */
static double measure(double c[4][DIMS], int64_t dims, const double *point, double u, double *slope, double *bend) {
    double square = 0, first = 0, second = 0;
    for (int64_t k = 0; k < dims; k++) {
        const double gap = c[0][k] + u * (c[1][k] + u * (c[2][k] + u * c[3][k])) - point[k];
        const double rate = c[1][k] + u * (2 * c[2][k] + u * 3 * c[3][k]);
        square += gap * gap;
        first += gap * rate;
        second += rate * rate + gap * (2 * c[2][k] + 6 * u * c[3][k]);
    }
    *slope = first;
    *bend = second;
    return square;
}

/* Squared distance from the cubic over the nearest chord. */
static double refined(const track *t, foot best, const double *point) {
    double c[4][DIMS], slope, bend, u = best.u;
    cubic_over(t, best.chord, c);
    double least = measure(c, t->dims, point, u, &slope, &bend);
    for (int i = 0; i < NEWTON && bend > 0; i++) {
        u = fmin(fmax(u - slope / bend, 0), 1);
        least = fmin(least, measure(c, t->dims, point, u, &slope, &bend));
    }
    return least;
}

void trochia_contour(const double *path, const double *arc, int64_t points, int64_t dims, const double *actual,
                     const int64_t *at, int64_t n, int64_t window, double *distance) {
    const track t = {.path = path, .arc = arc, .points = points, .dims = dims, .window = window};
    for (int64_t i = 0; i < n; i++) {
        const double *point = actual + i * dims;
        const double square = square_distance(point, path + at[i] * dims, dims);
        if (points < 2 || square == 0) {
            distance[i] = sqrt(square);
            continue;
        }
        const double reach = REACH * sqrt(square);
        /* a foot at either end of a chord, so that the refinement has one even where nothing is nearer */
        foot best = {
            .square = square, .u = at[i] < points - 1 ? 0 : 1, .chord = at[i] < points - 1 ? at[i] : at[i] - 1};
        best = walk(&t, at[i], 1, point, reach, best);
        best = walk(&t, at[i], -1, point, reach, best);
        distance[i] = sqrt(fmin(refined(&t, best, point), square)); /* the path does pass through its samples */
    }
}
