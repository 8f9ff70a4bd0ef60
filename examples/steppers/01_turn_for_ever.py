"""Sketch 1: turn clockwise for ever, one phase on, 20 rpm, on port 2.

Mended: nothing but the power switch stops the original; here ``q`` does, and the winding is released.
"""

from terminal import Terminal, run

from trochia.stepper import FORWARD, SINGLE


def sketch(terminal: Terminal) -> None:
    """Run it."""
    motor = terminal.motor(2)
    motor.set_speed(20)
    turns = 0
    while True:
        motor.step(200, FORWARD, SINGLE)
        turns += 1
        terminal.say(f"{turns} turn{'s' if turns > 1 else ''}")


run(sketch, __doc__)
