"""Sketch "ramp": to 2000 steps on port 2, at most 600 steps/s, 1500 steps/s².

Mended: the library's rule halves the first delay and cuts delays to whole milliseconds (600 steps/s becomes 500); here
acceleration is constant from the first step on, and 3.733 s is what the closed form says.
"""

from terminal import Terminal, run

from trochia.stepper import DOUBLE, Calls, Stepper


def sketch(terminal: Terminal) -> None:
    """Run it."""
    motor = terminal.motor(2)
    stepper = Stepper(Calls(lambda: motor.onestep(1, DOUBLE), lambda: motor.onestep(-1, DOUBLE)), terminal)
    stepper.set_max_speed(600)
    stepper.set_acceleration(1500)
    stepper.move_to(2000)
    reached = None
    while stepper.run():
        if reached is None and stepper.speed() > 599.999:
            reached = stepper.current_position()
            terminal.say(f"600 steps/s at step {reached}")
    terminal.say(f"{stepper.current_position()} steps in {terminal.now:.3f} s")


run(sketch, __doc__)
