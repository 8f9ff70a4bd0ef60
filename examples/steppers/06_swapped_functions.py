"""Sketch 5a: to 1800 steps at 150 steps/s (45 rpm) on port 2, the two functions swapped, so it turns counter-clockwise.

Mended: the speed set before the target was overwritten by setting the target; here they do not touch each other.
"""

from terminal import Terminal, run

from trochia.stepper import BACKWARD, FORWARD, SINGLE, Calls, Stepper


def sketch(terminal: Terminal) -> None:
    """Run it."""
    motor = terminal.motor(2)
    swapped = Calls(lambda: motor.onestep(BACKWARD, SINGLE), lambda: motor.onestep(FORWARD, SINGLE))
    stepper = Stepper(swapped, terminal)
    stepper.set_max_speed(150)
    stepper.set_speed(150)
    stepper.move_to(1800)
    while stepper.run_speed_to_position():
        pass
    turns = stepper.current_position() / 200
    terminal.say(f"{turns:g} turns counter-clockwise in {terminal.now:.2f} s, {60 * turns / terminal.now:.1f} rpm")


run(sketch, __doc__)
