"""Sketch 7: search for the start/stop speed: one phase, a turn from rest at each speed, released for 3 s in between.

Mended: the original goes on for ever and sees nothing, somebody has to watch; here the twin counts lost steps.
"""

from terminal import Terminal, run
from twin import rig

from trochia.stepper import FORWARD, SINGLE


def sketch(terminal: Terminal) -> None:
    """Run it."""
    output = rig("one-phase")
    motor = terminal.shield.motor(2, 200, output, whole_milliseconds=not terminal.options.exact)
    rpm = terminal.options.rpm
    while True:
        motor.set_speed(rpm)
        motor.step(200, FORWARD, SINGLE)
        motor.release()
        terminal.wait(3)
        if int(output.settle(terminal.now).lost_steps[-1]):
            break
        terminal.say(f"{rpm} rpm")
        rpm += 1
    terminal.say(f"Steps lost at {rpm} rpm: start/stop speed {rpm - 1} rpm, {200 * (rpm - 1) / 60:.0f} steps/s.")


run(sketch, __doc__)
