"""Sketch 2: five turns counter-clockwise, both phases on, 20 rpm, on port 1; released after each; again after 10 s.

Mended: released, the shield's windings are shorted, not open, so the motor still brakes: it says so.
"""

from terminal import Terminal, run

from trochia.stepper import BACKWARD, DOUBLE


def sketch(terminal: Terminal) -> None:
    """Run it."""
    motor = terminal.motor(1)
    motor.set_speed(20)
    while True:
        for turn in range(1, 6):
            motor.step(200, BACKWARD, DOUBLE)
            motor.release()
            terminal.say(f"turn {turn}, released: windings shorted, register {terminal.shield.image:02X}")
        terminal.wait(10)


run(sketch, __doc__)
