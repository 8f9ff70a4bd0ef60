#include "host/servo_law.h"

#include <math.h>
#include <stddef.h>

#include "host/servo_plant.h"

enum { FINE = 32, INNER_BITS = 39 };

static int64_t within(int64_t x, int64_t most) {
    return x > most ? most : x < -most ? -most : x;
}

/* The error as the law takes it: within i67, and behind the dead band.  1/32 count; i65 and i67 are 1/16. */
static int64_t taken(const trochia_law *k, int64_t error) {
    error = within(error, 2 * k->i67);
    const int64_t band = 2 * (int64_t)k->i65;
    if (error > band)
        return error + (k->i64 - 16) * band / 16;
    if (error < -band)
        return error - (k->i64 - 16) * band / 16;
    return error * k->i64 / 16;
}

static int32_t pmac(const trochia_law *k, trochia_law_state *s, int64_t commanded, int64_t actual) {
    if (s->ticks == 0) {
        s->commanded = commanded;
        s->actual = actual;
    }
    const int64_t cv = commanded - s->commanded, ca = cv - s->velocity, av = actual - s->actual;
    const int64_t e = taken(k, commanded - actual);
    if ((k->i34 == 0 || cv == 0) && s->saturated * e <= 0)
        s->sum = within(s->sum + e, FINE * k->i63);
    /* 1/4096 count: 1/32 of the feedback, 1/128 of the velocity terms */
    const int64_t most = (int64_t)1 << INNER_BITS;
    int64_t inner = k->i08 * (128 * e + k->i32 * cv + k->i35 * ca + ((k->i33 * s->sum) >> 16));
    inner = within(inner - (int64_t)k->i31 * k->i09 * av, most);
    const int64_t bits = ((k->i30 * inner) >> 31) + k->i29, out = within(bits, k->i69);
    s->saturated = bits > out ? 1 : bits < out ? -1 : 0;
    s->commanded = commanded;
    s->velocity = cv;
    s->actual = actual;
    s->ticks++;
    return (int32_t)out;
}

static int32_t thirty_seconds(trochia_law_state *s, int64_t commanded, int64_t actual) {
    if (s->ticks++ == 0) {
        s->commanded = commanded;
        s->way = s->way == 0 ? 1 : s->way;
    }
    const int64_t change = commanded - s->commanded;
    if (change != 0 && !s->pid.mended && (change > 0) != (s->way > 0)) {
        s->way = -s->way;
        s->pid.sum = 0;
        s->pid.last = 0;
    }
    s->commanded = commanded;
    const int64_t sense = s->pid.mended ? 1 : s->way;
    return (int32_t)sense * trochia_pid16_step(&s->pid, (int16_t)within(sense * (commanded - actual), 32767));
}

void trochia_law_bits(const trochia_law *law, trochia_law_state *state, const int64_t *commanded, const int64_t *actual,
                      uint64_t ticks, int32_t *out) {
    for (uint64_t i = 0; i < ticks; i++)
        out[i] = pmac(law, state, commanded[i], actual[i]);
}

void trochia_law_run(const trochia_plant *plant, const trochia_law *law, trochia_law_state *state, const double *wanted,
                     const double *disturbance, uint64_t ticks, double *out) {
    const trochia_plant_constants k = trochia_plant_prepare(plant);
    trochia_law_state s = *state;
    const double period = plant->h * law->steps;
    for (uint64_t i = 0; i < ticks; i++, out += 7) {
        const double measured = trochia_plant_measured(plant, &s.plant);
        const int64_t count = (int64_t)floor(measured * law->counts + 0.5);
        double speed = 0.0;
        if (law->kind == TROCHIA_LAW_PMAC) {
            if (s.ticks != 0)
                speed = (double)(FINE * count - s.actual) / (FINE * law->counts * period);
            s.command = law->volts * pmac(law, &s, llround(wanted[i] * law->counts * FINE), FINE * count);
        } else {
            if (s.ticks != 0)
                speed = (double)(count - s.actual) / (law->counts * period);
            s.command = law->volts * thirty_seconds(&s, (int64_t)floor(wanted[i] * law->counts + 0.5), count);
            s.actual = count;
        }
        trochia_plant_row(plant, &s.plant, measured, speed, s.command, out);
        const double force = disturbance != NULL ? disturbance[i] : 0.0;
        for (uint32_t n = 0; n < law->steps; n++)
            trochia_plant_step(plant, &k, &s.plant, s.command, force);
    }
    *state = s;
}
