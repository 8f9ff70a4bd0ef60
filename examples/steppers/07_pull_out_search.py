"""Sketch 6: search for the pull-out speed: both phases, from 50 rpm, one turn at each speed, 1 rpm more each turn.

Mended: the original goes on for ever and sees nothing, somebody has to watch; here the twin counts lost steps.
"""

from terminal import Terminal, run
from twin import rig

from trochia.stepper import DOUBLE, FORWARD


def sketch(terminal: Terminal) -> None:
    """Run it."""
    output = rig("two-phase")
    motor = terminal.shield.motor(2, 200, output, whole_milliseconds=not terminal.options.exact)
    rpm = terminal.options.rpm
    while True:
        motor.set_speed(rpm)
        motor.step(200, FORWARD, DOUBLE)
        lost = int(output.settle(terminal.now).lost_steps[-1])
        if lost:
            break
        terminal.say(f"{rpm} rpm")
        rpm += 1
    terminal.say(f"Steps lost at {rpm} rpm: pull-out speed {rpm - 1} rpm, {200 * (rpm - 1) / 60:.0f} steps/s.")


run(sketch, __doc__)
