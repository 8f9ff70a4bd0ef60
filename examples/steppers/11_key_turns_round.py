"""Sketch 10: tells every key's number; ``Z`` makes 2000 steps at 100 rpm on port 2, each time the other way.

Mended: a speed of 0 was set, which divides by it; keys typed while it turned were taken for further turns at once, and
now wait their turn, told when they are taken.
"""

from terminal import Terminal, run

from trochia.stepper import BACKWARD, DOUBLE, FORWARD


def sketch(terminal: Terminal) -> None:
    """Run it."""
    motor = terminal.motor(2)
    motor.set_speed(100)
    forward = False
    terminal.say("motor_set.")
    while True:
        key = terminal.key(wait=True)
        terminal.say(key)
        if key == ord("Z"):
            forward = not forward
            motor.step(2000, FORWARD if forward else BACKWARD, DOUBLE)
            motor.release()
            terminal.say(f"{'clockwise' if forward else 'counter-clockwise'}, {terminal.now:.3f} s")
            terminal.say_rotors()


run(sketch, __doc__)
