/* Motor, drive train, load. */
#include "host/servo_plant.h"

#include <math.h>
#include <stddef.h>

static double between(double x, double most) {
    return x > most ? most : x < -most ? -most : x;
}

trochia_plant_constants trochia_plant_prepare(const trochia_plant *p) {
    trochia_plant_constants k = {.half = 0.5 * p->gap, .rigid = p->stiffness == 0.0};
    k.volts = p->mode == TROCHIA_VOLTAGE || p->power == TROCHIA_BRAKED;
    const double tau = k.volts ? p->inductance / p->resistance : p->lag;
    k.keep = tau > 0.0 ? exp(-p->h / tau) : 0.0;
    k.gather = 1.0 - k.keep;
    const double both = p->motor_inertia + p->load_inertia;
    k.per_motor = 1.0 / (k.rigid ? both : p->motor_inertia);
    k.per_load = k.rigid ? k.per_motor : 1.0 / p->load_inertia;
    k.dry_motor = p->motor_friction.coulomb > 0.0 || p->motor_friction.stick > 0.0;
    k.dry_load = p->load_friction.coulomb > 0.0 || p->load_friction.stick > 0.0;
    k.sticky_motor = p->motor_friction.stick != p->motor_friction.coulomb && p->motor_friction.stribeck > 0.0;
    k.sticky_load = p->load_friction.stick != p->load_friction.coulomb && p->load_friction.stribeck > 0.0;
    k.conductance = 1.0 / p->resistance;
    k.per_smooth_motor = 1.0 / p->motor_friction.smooth;
    k.per_smooth_load = 1.0 / p->load_friction.smooth;
    k.per_stribeck_motor = k.sticky_motor ? 1.0 / p->motor_friction.stribeck : 0.0;
    k.per_stribeck_load = k.sticky_load ? 1.0 / p->load_friction.stribeck : 0.0;
    return k;
}

/* Beyond these exp(-x^2) and 1 - |tanh x| are less than a double of their size can show. */
static const double GONE = 40.0, FULL = 20.0;

static double friction(const trochia_friction *f, int dry, double per_smooth, double per_stribeck, double w) {
    double force = f->viscous * w + f->offset;
    if (dry) {
        const double x = w * per_stribeck, y = w * per_smooth;
        double level = f->coulomb;
        if (per_stribeck > 0.0 && x * x < GONE)
            level += (f->stick - f->coulomb) * exp(-x * x);
        force += y > FULL ? level : y < -FULL ? -level : level * tanh(y);
    }
    return force;
}

/* The current that an applied voltage ends in. */
static double by_voltage(const trochia_plant *p, const trochia_plant_constants *k, double wanted, double w) {
    double v = between(wanted, p->most_voltage);
    if (p->quantum > 0.0)
        v = p->quantum * floor(v / p->quantum + 0.5);
    if (p->drop > 0.0) {
        /* the bridge takes its drop from whatever drives the current, never more than there is */
        const double inner = v - p->emf_constant * w;
        v -= inner > p->drop ? p->drop : inner < -p->drop ? -p->drop : inner;
    }
    return (v - p->emf_constant * w) * k->conductance;
}

/* The current that the amplifier's own speed loop asks for. */
static double by_speed(const trochia_plant *p, trochia_plant_state *s, double wanted, double w) {
    const double e = wanted - w, current = p->speed_gain * e + s->sum;
    if (fabs(current) <= p->most_current || e * current < 0.0)
        s->sum += p->speed_integral * e * p->h;
    return between(current, p->most_current);
}

/* Current after a step, and the torque it gives over it (from the mean current). */
static double torque(const trochia_plant *p, const trochia_plant_constants *k, trochia_plant_state *s, double command,
                     double w) {
    const double before = s->current;
    if (p->power == TROCHIA_FREE) {
        s->current = s->sum = 0.0;
        return 0.0;
    }
    double target = p->power == TROCHIA_BRAKED ? 0.0 : p->gain * (command + p->offset);
    if (k->volts)
        target = by_voltage(p, k, target, w);
    else if (p->mode == TROCHIA_SPEED)
        target = by_speed(p, s, target, w);
    s->current = between(k->keep * before + k->gather * target, p->most_current);
    return p->torque_constant * 0.5 * (k->keep > 0.0 ? before + s->current : 2.0 * s->current);
}

static double coupling(const trochia_plant *p, const trochia_plant_constants *k, double twist, double slide) {
    if (twist > k->half)
        return p->stiffness * (twist - k->half) + p->damping * slide;
    if (twist < -k->half)
        return p->stiffness * (twist + k->half) + p->damping * slide;
    return k->half > 0.0 ? 0.0 : p->stiffness * twist + p->damping * slide;
}

static void advance(const trochia_plant *p, const trochia_plant_constants *k, trochia_plant_state *s, double command,
                    double disturbance) {
    const double h = p->h, half = 0.5 * h;
    const double w = s->motor_speed + half * s->motor_force, z = s->load_speed + half * s->load_force;
    const double drive = torque(p, k, s, command, w) -
                         friction(&p->motor_friction, k->dry_motor, k->per_smooth_motor, k->per_stribeck_motor, w);
    const double against =
        friction(&p->load_friction, k->dry_load, k->per_smooth_load, k->per_stribeck_load, z) + p->load + disturbance;
    if (k->rigid) {
        const double a = (drive - against) * k->per_motor, v = s->motor_speed;
        s->motor_speed = v + h * a;
        s->motor += half * (v + s->motor_speed);
        s->motor_force = s->load_force = a;
        s->load = s->motor;
        s->load_speed = s->motor_speed;
        return;
    }
    const double x = s->motor + half * s->motor_speed, y = s->load + half * s->load_speed;
    const double c = coupling(p, k, x - y, w - z);
    s->motor_force = (drive - c) * k->per_motor;
    s->load_force = (c - against) * k->per_load;
    s->motor_speed += h * s->motor_force;
    s->load_speed += h * s->load_force;
    s->motor = x + half * s->motor_speed;
    s->load = y + half * s->load_speed;
}

void trochia_plant_step(const trochia_plant *p, const trochia_plant_constants *k, trochia_plant_state *s,
                        double command, double disturbance) {
    const double from = p->on_load ? s->load : s->motor;
    advance(p, k, s, command, disturbance);
    if (p->encoder.watched)
        trochia_encoder_watch(&p->encoder, &s->encoder, from * p->counts, (p->on_load ? s->load : s->motor) * p->counts,
                              p->h, command);
}

/* Beyond it a loop that runs away is seen as it is, up to infinity. */
static const double COUNTABLE = 9e18;

double trochia_plant_measured(const trochia_plant *p, const trochia_plant_state *s) {
    const double x = p->on_load ? s->load : s->motor;
    if (p->encoder.watched && s->encoder.begun && fabs(x * p->counts) < COUNTABLE)
        return (double)s->encoder.told / p->counts;
    return p->counts > 0.0 ? floor(x * p->counts) / p->counts : x;
}

void trochia_plant_run(const trochia_plant *plant, trochia_plant_state *state, const double *commands, uint64_t count,
                       uint32_t steps, double *out) {
    const trochia_plant_constants k = trochia_plant_prepare(plant);
    trochia_plant_state s = *state;
    for (uint64_t i = 0; i < count; i++, out += 7) {
        const double speed = plant->on_load ? s.load_speed : s.motor_speed;
        trochia_plant_row(plant, &s, trochia_plant_measured(plant, &s), speed, commands[i], out);
        for (uint32_t n = 0; n < steps; n++)
            trochia_plant_step(plant, &k, &s, commands[i], 0.0);
    }
    *state = s;
}
