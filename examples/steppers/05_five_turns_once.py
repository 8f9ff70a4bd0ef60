"""Sketch 5: five turns counter-clockwise, 20 rpm, on port 2, released after each; ``r`` repeats.

Mended: the original repeats by the board's reset button; its way of excitation, one phase, is now written down.
"""

from terminal import Terminal, run

from trochia.stepper import BACKWARD, SINGLE


def sketch(terminal: Terminal) -> None:
    """Run it."""
    motor = terminal.motor(2)
    motor.set_speed(20)
    while True:
        for turn in range(1, 6):
            motor.step(200, BACKWARD, SINGLE)
            motor.release()
            terminal.say(f"turn {turn}")
        terminal.say("r repeats, q ends")
        while terminal.key(wait=True) != ord("r"):
            pass


run(sketch, __doc__)
