"""Sketch 11: commands like S450A300D800S: greatest speed [steps/s], acceleration [steps/s²], target [steps]; port 2.

Mended: the original stays in S after the closing S, so a line end sets the speed to 0 and freezes the move; values wrap
at 65,536 and none is below 0; a repeated target moves nothing and says nothing.  Here a command ends at its closing S,
is read whole, checked, and answered with units; a new one may come while the motor turns.
"""

import re

from terminal import Terminal, run

from trochia.errors import LimitError
from trochia.stepper import DOUBLE, Calls, Stepper

FORM = re.compile(r"S(\d+)A(\d+)D(-?\d+)S")


def obey(command: str, stepper: Stepper, terminal: Terminal) -> None:
    """Take up a whole command."""
    form = FORM.fullmatch(command)
    if not form or not int(form[1]) or not int(form[2]):
        terminal.say(f"{command!r} is no command like S450A300D800S, speed and acceleration above 0")
        return
    speed, acceleration, target = map(int, form.groups())
    try:
        stepper.set_max_speed(speed)
        stepper.set_acceleration(acceleration)
        stepper.move_to(target)
    except LimitError as error:
        terminal.say(error)
        return
    terminal.say(f"MAXSPEED = {speed} steps/s")
    terminal.say(f"ACCEL = {acceleration} steps/s²")
    terminal.say(f"DIST = {target} steps{', where it stands' if target == stepper.current_position() else ''}")


def sketch(terminal: Terminal) -> None:
    """Run it."""
    motor = terminal.motor(2)
    stepper = Stepper(Calls(lambda: motor.onestep(1, DOUBLE), lambda: motor.onestep(-1, DOUBLE)), terminal)
    typed, moving = "", False
    terminal.say("Commands like S450A300D800S")
    while True:
        key = terminal.key(wait=not stepper.is_running())
        if key is not None and chr(key) > " ":
            typed += chr(key)
        if len(typed) > 1 and typed[-1] == "S":
            obey(typed, stepper, terminal)
            typed = ""
        if stepper.run():
            moving = True
        elif moving:
            moving = False
            terminal.say(f"at {stepper.current_position()}, {terminal.now:.3f} s")
            terminal.say_rotors()


run(sketch, __doc__)
