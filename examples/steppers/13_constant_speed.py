"""Sketch "constant": to 1800 steps at 150 steps/s on port 2, without a ramp.

Mended: setting the target also recomputed the speed, so the order of the calls decided; here it does not.
"""

from terminal import Terminal, run

from trochia.stepper import SINGLE, Calls, Stepper


def sketch(terminal: Terminal) -> None:
    """Run it."""
    motor = terminal.motor(2)
    stepper = Stepper(Calls(lambda: motor.onestep(1, SINGLE), lambda: motor.onestep(-1, SINGLE)), terminal)
    stepper.set_max_speed(150)
    stepper.move_to(1800)
    stepper.set_speed(150)
    while stepper.run_speed_to_position():
        pass
    terminal.say(
        f"{stepper.current_position()} steps, {stepper.current_position() / 200:g} turns, {terminal.now:.2f} s"
    )


run(sketch, __doc__)
