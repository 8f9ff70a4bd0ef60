"""Sketch 4: one turn in 200 single steps of both phases, 500 ms apart, on port 1; ``r`` repeats.

Mended: the original repeats by the board's reset button, which also forgets where the motor stands; here it does not.
"""

from terminal import Terminal, run

from trochia.stepper import DOUBLE, FORWARD


def sketch(terminal: Terminal) -> None:
    """Run it."""
    motor = terminal.motor(1)
    made = 0
    while True:
        for _ in range(200):
            motor.onestep(FORWARD, DOUBLE)
            made += 1
            terminal.wait(0.5)
        motor.release()
        terminal.say(f"step {made}, at {made * 1.8:g} degrees; r repeats, q ends")
        while terminal.key(wait=True) != ord("r"):
            pass


run(sketch, __doc__)
