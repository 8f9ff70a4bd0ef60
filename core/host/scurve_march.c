/* Speeding up through a stretch, and bringing a to 0 over as many as that takes.
 *
 * Every leg has one jerk; its limits are taken at the highest speed it can reach and the greatest |a| it has, so they
 * hold everywhere in it. */
#include "host/scurve_march.h"

static const double SUMMED = 1.0 + 1e-12;
/* Forward a little less than back in time: then forward no ceiling is followed above what the pass back has. */
static const double SLACK[2] = {1.0 + 1e-12, 1.0 + 1e-13};
static const double ENDED = 1e-13;     /* less than this part of it is left of a: none is */
static const double CLOSE = 1e-12;     /* nearer to the ceiling than this part, speed stays */
static const double SHARE = 0.35;      /* of what v^2 is below the ceiling, taken at one go where budgets fall with v */
static const double LITTLE_A = 0.75;   /* a budget that falls no lower until the ceiling is taken there at once */
static const double LEAST_JERK = 1e-6; /* part of its jerk that turning must leave to an arrest */
/* An arrest that is too fast by less is followed to its end: by rounding of one that is not. */
static const double GRAZED = 1e-9;
static const double CLOSE_TIME = 1e-5;
static const double LOWER = 0.035; /* the same, where that leaves less than the a there is */
/* Of what a stretch leaves: so much a may be there where it is come to, and by rounding a little more where it is left
 * to itself.  Else motion that is let in with all of it would have to be arrested at once, and crawl through. */
static const double LET_IN = 1.0 - 1e-7, ROUNDED = 1.0 + 1e-11;
enum { STEPS = 7 };

static double place(const trochia_track *track, int64_t i, double rem) {
    return trochia_exit(track, i) - (double)track->by * rem;
}

/* The way is convex in time, so Newton's method overshoots at most once, from the left; then it nears from the right.
 * It begins at what an even a would take. */
double trochia_time_over(double v, double a, double j, double rem, double most) {
    double root = sqrt(v * v + 2.0 * a * rem), t = most;
    if (v + root > 0.0)
        t = trochia_smaller(t, 2.0 * rem / (v + root));
    if (j > 0.0 && !(j * t * t < v + root))
        t = trochia_smaller(t, cbrt(6.0 * rem / j));
    for (int k = 0; k < 50; k++) {
        double off = trochia_way_after(v, a, j, t) - rem, speed = trochia_speed_after(v, a, j, t);
        double step = off * speed / (speed * speed - 0.5 * off * (a + j * t));
        t = trochia_smaller(t - step, most);
        if (!(fabs(step) > CLOSE_TIME * t)) /* the next step would be the cube of that */
            break;
    }
    return t;
}

static void note(const trochia_track *track, int64_t i, double rem, double after, double v, double a, double j,
                 double duration, trochia_leg *legs, uint64_t room, uint64_t *made) {
    if (!legs || !(duration > 0.0))
        return;
    if (*made < room)
        legs[*made] =
            (trochia_leg){place(track, i, rem), place(track, i, after), v, a, j, duration, 0.0, 0.0, (uint64_t)i};
    ++*made;
}

/* Whether nothing but an end of acceleration is possible in stretch i, at speed v: what comes next is passed slower. */
static int is_end(const trochia_track *track, int64_t i, double v) {
    return trochia_is_barrier(track, i) || v > track->stretches[i + track->by].ceiling * SUMMED;
}

/* One leg of an arrest: its jerk, by what the highest speed it may get to leaves, and its duration: to a = 0, to that
 * speed, or to the stretch's end (then `rem` becomes 0).  Both are continuous in the state, so that an arrest's end is.
 */
static double arrest_leg(const trochia_stretch *stretch, double *rem, double v, double a, double *high, double *time) {
    double free = stretch->free, reach = INFINITY;
    *time = 0.0;
    if (free < INFINITY)
        reach = sqrt(v * v + 2.0 * a * *rem);
    *high = reach;
    if (free < INFINITY)
        *high = trochia_smaller(reach, v < free ? sqrt(v * v + SHARE * (free * free - v * v)) : v);
    double jerk = free < INFINITY ? trochia_jerk_left(stretch, *high, a) : stretch->most_j;
    if (!(jerk > 0.0))
        return jerk;
    double rise = *high - v, root = a * a - 2.0 * jerk * rise;
    *time = *high < reach && root > 0.0 ? 2.0 * rise / (a + sqrt(root)) : a / jerk;
    double way = trochia_way_after(v, a, -jerk, *time);
    if (way < *rem) {
        *rem -= way;
        return jerk;
    }
    *time = trochia_time_over(v, a, -jerk, *rem, *time);
    *rem = 0.0;
    return jerk;
}

/* Of the greatest a at the start of an arrest's leg: what its highest speed leaves, or what its own does, less what is
 * lost of that faster than a falls. */
static double arrest_most(const trochia_stretch *stretch, double v, double a, double jerk, double high, double time) {
    if (!(stretch->free < INFINITY))
        return stretch->most_a;
    double lost = 2.0 * stretch->bend_a * high * a * stretch->most_a - jerk;
    return trochia_larger(trochia_acceleration_left(stretch, high),
                          trochia_acceleration_left(stretch, v) - trochia_larger(lost, 0.0) * time);
}

trochia_arrest trochia_arrest_from(const trochia_track *track, int64_t i, double rem, double v, double a,
                                   trochia_leg *legs, uint64_t room, uint64_t *made) {
    trochia_arrest out = {.margin = INFINITY, .v = v, .s = place(track, i, rem), .stretch = i};
    double slack = SLACK[track->by > 0], spare = ROUNDED;
    while (a > 0.0) {
        const trochia_stretch *stretch = &track->stretches[i];
        double high, time, before = rem, jerk = arrest_leg(stretch, &rem, v, a, &high, &time);
        double most = arrest_most(stretch, v, a, jerk, high, time);
        if (most * spare < a)
            out.margin = trochia_smaller(out.margin, most * spare / a - 1.0);
        out.margin = trochia_smaller(out.margin, stretch->ceiling * slack / v - 1.0);
        if (stretch->free < INFINITY)
            out.margin = trochia_smaller(out.margin, jerk * stretch->along_j - LEAST_JERK);
        if (out.margin < -GRAZED)
            return out;
        note(track, i, before, rem, v, a, -jerk, time, legs, room, made);
        double first = a;
        v = trochia_speed_after(v, a, -jerk, time);
        a = time < a / jerk ? a - jerk * time : 0.0;
        a = a > ENDED * first ? a : 0.0;
        out.margin = trochia_smaller(out.margin, stretch->ceiling * slack / v - 1.0);
        out.v = v;
        out.s = place(track, i, rem);
        out.stretch = i;
        if (out.margin < -GRAZED)
            return out;
        if (a == 0.0) {
            if (is_end(track, i, v))
                out.margin = trochia_smaller(out.margin, rem / stretch->length);
            return out;
        }
        if (rem > 0.0)
            continue;
        if (is_end(track, i, v)) { /* beyond it, as if the stretch went on */
            out.barrier = 1;
            out.margin = -a / jerk * (v + a * a / (3.0 * jerk)) / stretch->length;
            return out;
        }
        i += track->by;
        rem = track->stretches[i].length;
        spare = track->stretches[i].free < INFINITY ? LET_IN : SUMMED;
    }
    return out;
}

/* One leg of a run, no longer than the stretch; returns 0 at the stretch's end. */
static int leg(const trochia_track *track, int64_t i, trochia_run *run, double j, double time) {
    if (!(time > 0.0))
        return 1;
    double way = trochia_way_after(run->v, run->a, j, time), rem = run->rem - way;
    int inside = rem > 0.0;
    if (!inside) {
        time = trochia_time_over(run->v, run->a, j, run->rem, time);
        rem = 0.0;
    }
    run->legs[run->count++] =
        (trochia_leg){place(track, i, run->rem), place(track, i, rem), run->v, run->a, j, time, 0.0, 0.0, (uint64_t)i};
    run->v = trochia_speed_after(run->v, run->a, j, time);
    run->a = trochia_larger(run->a + j * time, 0.0);
    run->rem = rem;
    run->time += time;
    return inside;
}

typedef struct {
    double a, j;
} trochia_budget;

/* Where the path bends, at most half of the jerk goes to 3 q'' v a. */
static trochia_budget budget_at(const trochia_stretch *stretch, double v) {
    double rest = 1.0 - stretch->twist_j * v * v * v, cross = stretch->bend_j * v;
    double a = trochia_acceleration_left(stretch, v);
    if (!(rest > 0.0) || !(a > 0.0))
        return (trochia_budget){0.0, 0.0};
    if (cross * a > 0.5 * rest)
        a = 0.5 * rest / cross;
    return (trochia_budget){a, (rest - cross * a) * stretch->most_j};
}

/* Up to which speed the budget of that speed is to be used, from v on. */
static double next_high(const trochia_stretch *stretch, double v) {
    if (stretch->bend_a == 0.0 && stretch->twist_j == 0.0)
        return stretch->ceiling;
    trochia_budget here = budget_at(stretch, v), top = budget_at(stretch, stretch->ceiling);
    if (top.a >= LITTLE_A * here.a && top.j >= 0.5 * here.j)
        return stretch->ceiling;
    return sqrt(v * v + SHARE * (stretch->ceiling * stretch->ceiling - v * v));
}

/* Infinite where a falls to 0 before. */
static double time_to_speed(double v, double a, double j, double to) {
    double rise = to - v, square = a * a + 2.0 * j * rise;
    if (!(square >= 0.0))
        return INFINITY;
    return rise > 0.0 ? 2.0 * rise / (a + sqrt(square)) : 0.0;
}

/* From v to `high` by that speed's budget, with a at the end no more than what comes next leaves; 0: no further. */
static int climb_to(const trochia_track *track, int64_t i, trochia_run *run, double high) {
    const trochia_stretch *stretch = &track->stretches[i];
    trochia_budget b = budget_at(stretch, high);
    if (!(b.a > 0.0) || !(b.j > 0.0))
        return 0;
    double after = high < stretch->ceiling ? budget_at(stretch, next_high(stretch, high)).a : b.a;
    if (run->a > b.a * SUMMED) {
        double j = trochia_jerk_left(stretch, high, run->a), time = (run->a - b.a) / j;
        double v = trochia_speed_after(run->v, run->a, -j, time);
        if (!(j > 0.0) || v > high || arrest_most(stretch, run->v, run->a, j, v, time) * ROUNDED < run->a)
            return 0;
        if (!leg(track, i, run, -j, time))
            return 0;
    }
    if (run->a < b.a &&
        !leg(track, i, run, b.j, trochia_smaller((b.a - run->a) / b.j, time_to_speed(run->v, run->a, b.j, high))))
        return 0;
    double drop = trochia_larger(run->a - after, 0.0), until = high - 0.5 * drop * (run->a + after) / b.j;
    if (run->v < until && run->a > 0.0 && !leg(track, i, run, 0.0, (until - run->v) / run->a))
        return 0;
    if (drop > 0.0 && run->v < high) {
        double time = trochia_smaller(drop / b.j, time_to_speed(run->v, run->a, -b.j, high));
        if (!leg(track, i, run, -b.j, time))
            return 0;
    }
    return run->v < stretch->ceiling * (1.0 - CLOSE);
}

void trochia_climb(const trochia_track *track, int64_t i, double v, double a, trochia_run *run) {
    const trochia_stretch *stretch = &track->stretches[i];
    run->v = v;
    run->a = a;
    run->rem = stretch->length;
    run->time = 0.0;
    run->count = 0;
    for (int k = 0; k < STEPS && run->rem > 0.0 && run->v < stretch->ceiling * (1.0 - CLOSE); k++)
        if (!climb_to(track, i, run, next_high(stretch, run->v))) {
            /* more a than the speed ahead leaves: first by the budget of a lower one */
            double rise = stretch->ceiling * stretch->ceiling - run->v * run->v;
            if (run->count || !(run->a > 0.0) || !climb_to(track, i, run, sqrt(run->v * run->v + LOWER * rise)))
                break;
        }
}

void trochia_run_at(const trochia_track *track, int64_t i, const trochia_run *run, double time, trochia_run *out) {
    double rem = track->stretches[i].length;
    if (time >= run->time) {
        out->v = run->v;
        out->a = run->a;
        out->rem = run->rem;
        return;
    }
    for (int k = 0; k < run->count; k++) {
        const trochia_leg *at = &run->legs[k];
        double t = trochia_smaller(time, at->duration);
        if (time <= at->duration || k + 1 == run->count) {
            out->v = trochia_speed_after(at->v, at->a, at->j, t);
            out->a = trochia_larger(at->a + at->j * t, 0.0);
            out->rem = trochia_larger(rem - trochia_way_after(at->v, at->a, at->j, t), 0.0);
            return;
        }
        time -= at->duration;
        rem = fabs(trochia_exit(track, i) - at->to);
    }
}

void trochia_run_out(const trochia_track *track, int64_t i, trochia_run *run, double time) {
    if (time < run->time) {
        trochia_run cut = {.count = 0};
        trochia_run_at(track, i, run, time, &cut);
        double sum = 0.0;
        int k = 0;
        while (k < run->count && sum + run->legs[k].duration < time)
            sum += run->legs[k++].duration;
        run->count = time > sum ? k + 1 : k;
        if (time > sum) {
            run->legs[k].duration = time - sum;
            run->legs[k].to = place(track, i, cut.rem);
        }
        run->v = cut.v;
        run->a = cut.a;
        run->rem = cut.rem;
        run->time = time;
    }
    run->climbs = run->count;
    while (run->a > 0.0 && run->rem > 0.0 && run->count + 1 < TROCHIA_RUN_LEGS) {
        double high, duration, rem = run->rem, first = run->a;
        double jerk = arrest_leg(&track->stretches[i], &rem, run->v, run->a, &high, &duration);
        if (!(jerk > 0.0))
            break;
        leg(track, i, run, -jerk, duration);
        run->rem = rem;
        run->a = run->a > ENDED * first ? run->a : 0.0;
    }
    if (run->rem > 0.0 && run->v > 0.0)
        leg(track, i, run, 0.0, 2.0 * run->rem / run->v);
}
