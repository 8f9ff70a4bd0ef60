/* The pass back, and how it may be joined.
 *
 * From a node (a stop, a stretch passed at an even speed, or a lowest place of the ceiling) motion is followed back in
 * time, as fast as it gets, to where the ceiling is below it.  From there to the next lowest place only the ceiling
 * binds.  For every place the arrest is kept: where a would be 0, and at which speed, were it to fall from there on;
 * both grow along the pass, so any a = 0 at a speed has one place that joins it. */
#include "host/scurve_march.h"

static const double SUMMED = 1.0 + 1e-12;
static const double EXACT = 1e-14;
static const double NEAR = 1e-12;         /* speeds that are the same */
static const double ROUNDED = 1.0 + 1e-9; /* above a ceiling by what searches leave */
enum { FARTHEST = 64 };                   /* stretches looked back over */
static const double BELOW = 1.0 - 1e-5;

/* Of a place passed at an even speed, by a lower one than planned: that of which the arrest back in time ends at v. */
static trochia_leave slower_node(const trochia_course *course, int64_t b, double v) {
    trochia_track back = trochia_track_of(course, -1);
    const trochia_stretch *node = &course->stretches[b];
    double low = 0.0, high = node->node_v;
    trochia_arrest at = {.s = node->start};
    for (int k = 0; k < 100 && high - low > EXACT * high; k++) {
        double middle = 0.5 * (low + high);
        trochia_arrest found = trochia_kick_arrest(&back, b - 1, node->kick_in, middle);
        if (found.margin >= 0.0 && found.v <= v) {
            low = middle;
            at = found;
        } else
            high = middle;
    }
    return (trochia_leave){.s = at.s, .v_node = low, .stretch = b};
}

static trochia_arrest arrest_on(const trochia_track *back, const trochia_leg *leg, double t) {
    double way = trochia_way_after(leg->v, leg->a, leg->j, t);
    double rem = (leg->from - back->stretches[leg->stretch].start) - way; /* s jumps from one double to the next */
    double v = trochia_speed_after(leg->v, leg->a, leg->j, t);
    return trochia_arrest_from(back, (int64_t)leg->stretch, trochia_larger(rem, 0.0), v,
                               trochia_larger(leg->a + t * leg->j, 0.0), NULL, 0, NULL);
}

/* The time on a leg from which an arrest of one jerk ends at v; negative: it does not end in the leg's stretch. */
static double leave_straight(const trochia_track *back, const trochia_leg *leg, double v, double *s) {
    const trochia_stretch *stretch = &back->stretches[leg->stretch];
    if (stretch->free < INFINITY)
        return -1.0;
    double jerk = stretch->most_j, gain = 1.0 + leg->j / jerk, half = leg->a * gain;
    double off = v - leg->v - 0.5 * leg->a * leg->a / jerk, root = half * half + 2.0 * leg->j * gain * off;
    if (!(root > 0.0))
        return -1.0;
    double t = trochia_smaller(2.0 * off / (half + sqrt(root)), leg->duration);
    double u = trochia_speed_after(leg->v, leg->a, leg->j, t), a = leg->a + t * leg->j, time = a / jerk;
    *s = leg->from - trochia_way_after(leg->v, leg->a, leg->j, t) - time * (u + a * time / 3.0);
    return *s >= stretch->start ? t : -1.0;
}

/* The time on a leg by which it has gained part of its speed. */
static double time_of_part(const trochia_leg *leg, double part) {
    double rise = part * leg->duration * (leg->a + 0.5 * leg->duration * leg->j);
    return 2.0 * rise / (leg->a + sqrt(trochia_larger(leg->a * leg->a + 2.0 * leg->j * rise, 0.0)));
}

/* The time on a leg from which the arrest ends at v; that from its start ends at `from`, below.  How fast an arrest
 * ends grows nearly as the speed it begins at: the false position is looked for in that. */
static double leave_on(const trochia_track *back, const trochia_leg *leg, double from, double to, double v, double *s) {
    double low = 0.0, high = 1.0, under = from - v, over = to - v, found_at = -1.0;
    int stayed = 0;
    double straight = leave_straight(back, leg, v, s);
    if (straight >= 0.0)
        return straight;
    for (int k = 0; k < 80 && high - low > EXACT; k++) {
        double part = k % 6 < 5 && over > under && over < INFINITY ? low - under * (high - low) / (over - under)
                                                                   : 0.5 * (low + high);
        if (!(part > low) || !(part < high))
            part = 0.5 * (low + high);
        trochia_arrest found = arrest_on(back, leg, time_of_part(leg, part));
        double off = found.margin >= 0.0 ? found.v - v : INFINITY;
        if (off <= 0.0) {
            over *= stayed == 1 ? trochia_lowered(off, under) : 1.0;
            stayed = 1;
            low = found_at = part;
            under = off;
            *s = found.s;
            if (under >= -NEAR * v)
                break;
        } else {
            under *= stayed == -1 ? trochia_lowered(off, over) : 1.0;
            stayed = -1;
            high = part;
            over = off;
            if (over < NEAR * v) {
                low = found_at = part;
                *s = found.s;
                break;
            }
        }
    }
    if (found_at < 0.0)
        *s = arrest_on(back, leg, 0.0).s;
    return time_of_part(leg, low);
}

/* Nearest stretch to the node (back in time the first) whose arrest at its start gets to v. */
static int64_t stretch_for(const trochia_stretch *stretches, int64_t low, int64_t high, double v) {
    while (high - low > 1) {
        int64_t middle = low + (high - low) / 2;
        if (stretches[middle].peak_v >= v)
            low = middle;
        else
            high = middle;
    }
    return low;
}

double trochia_room_at(const trochia_course *course, const trochia_arrest *arrest) {
    const trochia_stretch *stretches = course->stretches;
    double v = arrest->v;
    if (stretches[arrest->stretch].birth == TROCHIA_NO_BIRTH)
        return INFINITY;
    int64_t b = (int64_t)stretches[arrest->stretch].birth, death = (int64_t)stretches[b].death;
    if (v > stretches[b].birth_v && v <= stretches[death].peak_v) {
        int64_t k = stretch_for(stretches, death, b, v);
        double to_v = stretches[k].peak_v, to_s = stretches[k].peak_s;
        double from_v = k + 1 == b ? stretches[b].birth_v : stretches[k + 1].peak_v;
        double from_s = k + 1 == b ? stretches[b].birth_s : stretches[k + 1].peak_s;
        double clear = trochia_smaller(from_s, to_s) - fabs(from_s - to_s); /* the place may lie a little outside */
        if (arrest->s > from_s || arrest->s < clear)
            return (v - from_v) / (to_v - from_v) * (to_s - from_s) + from_s - arrest->s;
    }
    return trochia_leave_at(course, arrest->stretch, v).s - arrest->s;
}

trochia_leave trochia_leave_at(const trochia_course *course, int64_t i, double v) {
    const trochia_stretch *stretches = course->stretches;
    trochia_leave leave = {.s = INFINITY};
    if (stretches[i].birth == TROCHIA_NO_BIRTH)
        return leave;
    int64_t b = (int64_t)stretches[i].birth, death = (int64_t)stretches[b].death;
    leave.v_node = stretches[b].node_v;
    leave.stretch = b;
    if (v <= stretches[b].birth_v) {
        if (b < course->count && trochia_is_pinned(&stretches[b]))
            return v < stretches[b].birth_v ? slower_node(course, b, v)
                                            : (trochia_leave){stretches[b].birth_s, leave.v_node, 0.0, b};
        if (stretches[b].node_v == 0.0)
            leave.s = trochia_end_of(&stretches[b - 1]);
        return leave;
    }
    if (stretches[death].peak_v < v) {
        leave.s = -INFINITY;
        return leave;
    }
    trochia_track back = trochia_track_of(course, -1);
    int64_t k = stretch_for(stretches, death, b, v);
    double from = k + 1 == b ? stretches[b].birth_v : stretches[k + 1].peak_v, passed = 0.0;
    leave.stretch = k;
    leave.s = stretches[k].peak_s;
    leave.tau = stretches[k].climb;
    for (uint64_t n = 0; n < stretches[k].climbs; n++) {
        const trochia_leg *leg = &course->legs[stretches[k].leg + n];
        double to = leg->end_v;
        if (to >= v) {
            double s = leave.s;
            leave.tau = passed + leave_on(&back, leg, from, to, v, &s);
            leave.s = s;
            return leave;
        }
        from = to;
        passed += leg->duration;
    }
    const trochia_leg *last = &course->legs[stretches[k].leg];
    if (stretches[k].climbs > 0)
        leave.s = last[stretches[k].climbs - 1].end_s;
    else
        leave.s = arrest_on(&back, last, 0.0).s;
    return leave;
}

/* Where each leg's arrest would end: what joins ask for. */
static void mark(const trochia_course *course, const trochia_stretch *stretch, const trochia_arrest *last) {
    trochia_track back = trochia_track_of(course, -1);
    trochia_leg *legs = course->legs + stretch->leg;
    if (stretch->leg + stretch->legs > course->room)
        return;
    for (uint64_t n = 0; n < stretch->climbs; n++) {
        trochia_arrest end = *last;
        if (n + 1 < stretch->climbs)
            end = arrest_on(&back, &legs[n], legs[n].duration);
        legs[n].end_v = end.margin >= 0.0 ? end.v : stretch->peak_v;
        legs[n].end_s = end.s;
    }
}

static void keep(trochia_course *course, int64_t i, const trochia_run *run) {
    trochia_stretch *stretch = &course->stretches[i];
    stretch->leg = course->made;
    stretch->legs = (uint16_t)run->count;
    stretch->climbs = (uint16_t)run->climbs;
    for (int k = 0; k < run->count; k++, course->made++)
        if (course->made < course->room)
            course->legs[course->made] = run->legs[k];
}

/* Motion back in time that has come to the end of stretch i. */
typedef struct {
    int64_t i;
    double v, a;
    int closing; /* a is only brought to 0 */
} trochia_mover;

/* Through stretch m->i. */
static void pass_stretch(trochia_course *course, int64_t b, trochia_mover *m) {
    trochia_stretch *stretches = course->stretches, *here = &stretches[m->i];
    trochia_track back = trochia_track_of(course, -1);
    trochia_run run;
    trochia_arrest arrest;
    int joins, barrier = 0;
    if (m->closing || (m->a == 0.0 && trochia_is_still(here, m->v)))
        run = (trochia_run){.v = m->v, .a = m->a, .rem = here->length};
    else
        trochia_climb(&back, m->i, m->v, m->a, &run);
    double time = trochia_search(&back, NULL, m->i, &run, &arrest, &joins, &barrier);
    /* a later stretch's ceiling, once come to, forbids more until a is 0 */
    barrier |= time < run.time && arrest.stretch < m->i && arrest.v > stretches[arrest.stretch].ceiling * BELOW;
    trochia_run_out(&back, m->i, &run, time);
    here->climb = time;
    here->birth = (uint64_t)b;
    here->peak_v = run.a > 0.0 ? arrest.v : run.v;
    here->peak_s = run.a > 0.0 ? arrest.s : here->start;
    keep(course, m->i, &run);
    mark(course, here, &arrest);
    m->v = run.v;
    m->a = run.a;
    m->closing = (m->closing || barrier) && m->a > 0.0;
    if (m->i > 0 && m->a == 0.0 && m->v > here[-1].ceiling && m->v <= here[-1].ceiling * ROUNDED)
        m->v = here[-1].ceiling;
}

/* Motion that ends in stretch m->i, while an arrest from a stretch k before it would have got farther: by that instead,
 * from the start of k on. */
static int turn_back(trochia_course *course, int64_t b, trochia_mover *m) {
    const trochia_stretch *stretches = course->stretches;
    double end = stretches[m->i].start;
    if (course->made > course->room)
        return 0;
    for (int64_t k = m->i + 1; k < b && k <= m->i + FARTHEST; k++) {
        if (!(stretches[k].peak_s < end - TROCHIA_SAME_PLACE(end)) || stretches[k].legs == 0)
            continue;
        const trochia_leg *last = &course->legs[stretches[k].leg + stretches[k].legs - 1];
        double a = last->a + last->duration * last->j;
        if (!(a > 0.0))
            continue;
        course->made = stretches[k].leg + stretches[k].legs;
        *m = (trochia_mover){k - 1, trochia_speed_after(last->v, last->a, last->j, last->duration), a, 1};
        return 1;
    }
    return 0;
}

/* From the node at the start of stretch b back to where the ceiling is below. */
static int64_t pass_from(trochia_course *course, int64_t b, double v, double a) {
    trochia_stretch *stretches = course->stretches;
    trochia_track back = trochia_track_of(course, -1);
    trochia_arrest birth = trochia_arrest_from(&back, b - 1, stretches[b - 1].length, v, a, NULL, 0, NULL);
    trochia_mover m = {b - 1, v, a, 0};
    int64_t ended = b;
    stretches[b].birth_v = a > 0.0 ? birth.v : v;
    stretches[b].birth_s = a > 0.0 ? birth.s : trochia_end_of(&stretches[b - 1]);
    for (;; m.i--) {
        pass_stretch(course, b, &m);
        if (!trochia_is_barrier(&back, m.i) && m.v <= stretches[m.i - 1].ceiling * SUMMED)
            continue;
        int64_t i = m.i;
        if (i < ended && turn_back(course, b, &m)) {
            ended = i; /* only ever farther back */
            m.i++;
            continue;
        }
        stretches[b].death = (uint64_t)i;
        return i;
    }
}

/* The next node before place d, where a pass back has ended; 0: the path's start. */
static int64_t next_node(trochia_course *course, int64_t d, double *v) {
    trochia_stretch *stretches = course->stretches;
    for (int64_t j = d; j > 0; j--) {
        trochia_stretch *before = &stretches[j - 1];
        *v = 0.0;
        if (before->last)
            return j;
        if (trochia_is_pinned(before)) {
            *v = trochia_node_speed(course, j - 1);
            return j - (j > 1 && trochia_pinned_end(stretches, j - 2) == j - 1 ? 2 : 1);
        }
        *v = stretches[j].ceiling;
        if (j < d && before->ceiling > *v)
            return j;
        before->birth = TROCHIA_NO_BIRTH;
    }
    return 0;
}

static int may_join(const trochia_course *course, int64_t d, double v) {
    return trochia_leave_at(course, d, v).s >= course->stretches[d].start;
}

/* From even speed before place d, where a pass back ends, that is joined behind it: where budgets change, its arrests
 * may end earlier than later ones do, and then only a lower speed is safe. */
static void lower_before(trochia_course *course, int64_t d) {
    trochia_stretch *stretches = course->stretches;
    if (d == 0 || stretches[d - 1].last || trochia_is_pinned(&stretches[d - 1]))
        return;
    double low = 0.0, high = stretches[d - 1].ceiling * SUMMED;
    if (may_join(course, d, high))
        return;
    for (int k = 0; k < 60 && high - low > EXACT * high; k++) {
        double v = 0.5 * (low + high);
        *(may_join(course, d, v) ? &low : &high) = v;
    }
    if (low > 0.0)
        stretches[d - 1].ceiling = low / SUMMED;
}

void trochia_scurve_back(trochia_course *course) {
    double v = 0.0;
    trochia_pin(course);
    for (int64_t b = course->count; b > 0;) {
        trochia_stretch *node = &course->stretches[b];
        node->node_v = v;
        int64_t d = pass_from(course, b, v, (b < course->count ? node->kick_in : 0.0) * v * v);
        lower_before(course, d);
        b = next_node(course, d, &v);
    }
}
