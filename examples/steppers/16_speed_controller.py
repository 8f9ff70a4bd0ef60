"""The speed controller's demonstration: 600 steps, 190 rpm, 30 rad/s² both ways; keys A R D S choose the next state.

Each key first executes the state stored before it, so ``ARDS`` speeds up, runs, brakes and ends in S, and so does any
other key.

Mended: delays were cut to whole milliseconds, the run was at 150 rpm in place of 190, the first delay was left out,
braking overwrote the shortest delay so that a second run went wrong, and a short move took 400 steps for 600.
"""

from terminal import Terminal, run

from trochia.stepper import DOUBLE, FORWARD
from trochia.stepper.controller import SpeedController, State, plan_move

ANGLE, CLOCK = 0.0314, 1e6  # the source's step angle [rad] and timer clock [Hz]
NAMES = {"A": State.ACCEL, "R": State.RUN, "D": State.DECEL}


def sketch(terminal: Terminal) -> None:
    """Run it."""
    plan = plan_move(600, 19.90, 30, 30, angle=ANGLE, clock=CLOCK)
    delays, counts = (plan.shortest, plan.first), (plan.rising, plan.limit, plan.braking)
    terminal.say("c {:.2f}, c0 {:.2f} us; n {}, n1 {}, n2 {} steps".format(*delays, *counts))
    motor = terminal.motor(1)
    controller, stored, delay = SpeedController(plan), State.STOP, None
    while True:
        key = terminal.key(wait=True)
        if stored is State.STOP:
            terminal.say("Running...")
            controller, delay = SpeedController(plan), None
        else:
            delay = controller.begin() if delay is None else delay
            while delay is not None and controller.state is stored:
                terminal.wait(delay / CLOCK)
                motor.onestep(FORWARD, DOUBLE)
                delay = controller.interrupt()
            terminal.say(f"{stored.value}: {controller.count} steps made, {terminal.now:.4f} s")
            if stored is State.DECEL and delay is None:
                terminal.say("DONE!")
        stored = NAMES.get(chr(key or 0), State.STOP)


run(sketch, __doc__)
