"""Sketch 7: search for the start/stop speed: one phase, a turn from rest at each speed, released for 3 s in between.

Mended: the original goes on for ever and sees nothing, somebody has to watch; here the twin counts lost steps.
"""

from terminal import Terminal, run

from trochia.stepper import FORWARD, SINGLE


def sketch(terminal: Terminal) -> None:
    """Run it."""
    motor = terminal.motor(2)
    rpm, lost = terminal.options.rpm, 0
    while True:
        motor.set_speed(rpm)
        motor.step(200, FORWARD, SINGLE)
        motor.release()
        terminal.wait(3)
        lost = terminal.shield.twins[2].look(terminal.now).lost
        if lost:
            break
        terminal.say(f"{rpm} rpm")
        rpm += 1
    if rpm == terminal.options.rpm:
        terminal.say(f"{lost} steps lost at the first speed already: begin below {rpm} rpm, by --rpm.")
    else:
        terminal.say(f"Steps lost at {rpm} rpm: start/stop speed {rpm - 1} rpm, {200 * (rpm - 1) / 60:.0f} steps/s.")


run(sketch, __doc__)
