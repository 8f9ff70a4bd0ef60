#include "host/follower.h"

#include <math.h>

static void take(const trochia_follower *f, trochia_follower_state *s) {
    s->owed += f->num;
    const int64_t due = s->owed / f->den;
    s->owed -= due * f->den;
    s->error += (int32_t)(due - (s->pulses - s->counted));
    s->counted = s->pulses;
}

int64_t trochia_follower_run(const trochia_follower *f, trochia_follower_state *state, int64_t rows, double *out) {
    trochia_follower_state s = *state;
    const double keep = exp(-f->pole * f->h), way = (1.0 - keep) / f->pole;
    int64_t done = 0;
    while (done < rows) {
        if (s.step % f->pid_steps == 0) {
            const int32_t e = s.error > 32767 ? 32767 : s.error < -32768 ? -32768 : s.error;
            s.duty = trochia_pid16_step(&s.pid, (int16_t)e);
            if (f->one_way && s.duty < 0)
                s.duty = 0;
        }
        const double target = f->gain * s.duty, excess = s.speed - target;
        s.position += target * f->h + excess * way;
        s.speed = target + excess * keep;
        const int64_t at = (int64_t)floor(s.position);
        s.pulses = at > s.pulses ? at : s.pulses;
        s.step++;
        const double now = (double)s.step * f->h;
        if (now * f->spindle >= (double)(s.spindle_pulses + 1)) {
            s.spindle_pulses++;
            take(f, &s);
            out[0] = now;
            out[1] = s.error;
            out[2] = s.duty;
            out[3] = s.position;
            out += 4;
            done++;
        }
    }
    *state = s;
    return done;
}
