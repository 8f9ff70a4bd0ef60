/* The loops, and the run from tick to tick. */
#include <math.h>
#include <stddef.h>

#include "host/servo_plant.h"

enum { POSITION = 1, SPEED = 2, CURRENT = 4 };

static double between(double x, double most) {
    return x > most ? most : x < -most ? -most : x;
}

static double integral(const trochia_pid *c, const trochia_pid_state *s, double e, double unbound) {
    const double more = c->i_now * e + c->i_before * s->error;
    double sum = s->sum + more;
    if (c->windup == TROCHIA_WINDUP_CLAMP)
        sum = between(sum, c->most_sum);
    else if (c->windup == TROCHIA_WINDUP_HOLD && fabs(unbound + more) > c->most && unbound * more > 0.0)
        sum = s->sum;
    return sum;
}

static double pid(const trochia_pid *c, trochia_pid_state *s, double wanted, double measured, double bias) {
    double e = wanted - measured;
    if (fabs(e) <= c->dead)
        e = 0.0;
    const double damped = c->c * wanted - measured, change = damped - s->damped;
    const double proportional = c->dead > 0.0 ? c->p * e : c->p * (c->b * wanted - measured);
    const double derivative = c->d_keep * s->derivative + c->d_gain * change;
    double out;
    if (c->incremental) {
        out = s->output + (proportional - s->proportional) + (c->i_now * e + c->i_before * s->error) +
              (derivative - s->derivative);
        out = between(out, c->most);
    } else {
        s->sum = integral(c, s, e, proportional + s->sum + derivative + bias);
        const double unbound = proportional + s->sum + derivative + bias;
        out = between(unbound, c->most);
        if (c->windup == TROCHIA_WINDUP_BACK)
            s->sum += c->back * (out - unbound);
    }
    s->derivative = derivative;
    s->proportional = proportional;
    s->error = e;
    s->damped = damped;
    s->output = out;
    return c->incremental ? between(out + bias, c->most) : out;
}

static double filtered(const trochia_loop *loop, double *memory, double x) {
    for (uint32_t i = 0; i < loop->filters; i++, memory += 2) {
        const trochia_biquad *f = &loop->filter[i];
        const double y = f->b0 * x + memory[0];
        memory[0] = f->b1 * x - f->a1 * y + memory[1];
        memory[1] = f->b2 * x - f->a2 * y;
        x = y;
    }
    return x;
}

/* Speed from the measured positions of the last periods. */
static double speed_of(const trochia_loop *loop, trochia_servo_state *state, double measured) {
    if (state->ticks == 0) {
        for (uint32_t i = 0; i <= loop->averaged; i++)
            state->seen[i] = measured;
    }
    for (uint32_t i = loop->averaged; i > 0; i--)
        state->seen[i] = state->seen[i - 1];
    state->seen[0] = measured;
    return (measured - state->seen[loop->averaged]) / (loop->period * loop->averaged);
}

/* What the loops above the current ask for. */
static double command_of(const trochia_loop *loop, trochia_servo_state *state, const double *wanted, double measured,
                         double speed, double injected) {
    double bias = loop->bias + loop->acceleration_forward * wanted[2] + loop->speed_into_command * wanted[1] + injected;
    if (loop->friction_forward != 0.0)
        bias += loop->friction_forward * tanh(wanted[1] / loop->friction_smooth);
    double command = 0.0;
    if (loop->loops & POSITION) {
        const double forward = loop->loops & SPEED ? loop->speed_forward * wanted[1] : bias;
        command = pid(&loop->position, &state->position, wanted[0], measured, forward);
    } else if (loop->loops & SPEED)
        command = wanted[1];
    if (loop->loops & SPEED)
        command = pid(&loop->speed, &state->speed, command, speed, bias);
    else if (!(loop->loops & POSITION))
        command = bias;
    return between(filtered(loop, state->filter, command), loop->most_command);
}

void trochia_servo_run(const trochia_plant *plant, const trochia_loop *loop, trochia_servo_state *state,
                       const double *wanted, const double *disturbance, const double *injected, uint64_t ticks,
                       double *out) {
    const trochia_plant_constants k = trochia_plant_prepare(plant);
    trochia_servo_state s = *state;
    for (uint64_t i = 0; i < ticks; i++, wanted += 3, out += 7) {
        const double measured = trochia_plant_measured(plant, &s.plant);
        double speed = speed_of(loop, &s, measured);
        if (plant->encoder.watched && plant->encoder.clock > 0.0)
            speed = trochia_encoder_speed(&s.plant.encoder, plant->h) / plant->counts;
        s.command = command_of(loop, &s, wanted, measured, speed, injected != NULL ? injected[i] : 0.0);
        trochia_plant_row(plant, &s.plant, measured, speed, s.command, out);
        const double force = disturbance != NULL ? disturbance[i] : 0.0;
        for (uint32_t n = 0; n < loop->steps; n++) {
            double u = s.command;
            if (loop->loops & CURRENT)
                u = pid(&loop->current, &s.current, s.command, s.plant.current, 0.0);
            trochia_plant_step(plant, &k, &s.plant, u, force);
        }
        s.ticks++;
    }
    *state = s;
}
