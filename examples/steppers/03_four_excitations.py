"""Sketch 3: 100 steps there and back in each way of excitation, 10 rpm, on port 2, for ever.

Mended: half steps cover half the way for the same count, which the original hides; here the angle is told.
"""

from terminal import Terminal, run

from trochia.stepper import BACKWARD, FORWARD, SINGLE, Style


def sketch(terminal: Terminal) -> None:
    """Run it."""
    motor = terminal.motor(2)
    motor.set_speed(10)
    motor.step(100, FORWARD, SINGLE)
    motor.release()
    terminal.wait(1)
    while True:
        for style in Style:
            degrees = 180 / (2 if style is Style.INTERLEAVE else 1)
            terminal.say(f"{style.name}: {degrees:g} degrees and back")
            motor.step(100, FORWARD, style)
            motor.step(100, BACKWARD, style)
        terminal.wait(2)


run(sketch, __doc__)
