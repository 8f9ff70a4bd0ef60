"""Sketch 8: asks for a speed [rpm] and makes 1000 steps at it on port 2, counter-clockwise below 0; 0 releases.

Mended: what is no number was taken for 0, and speeds beyond 16 bits wrapped round; now they are named and asked again.
"""

from terminal import Terminal, run

from trochia.stepper import BACKWARD, DOUBLE, FORWARD

FASTEST = 1000  # rpm; no such motor turns faster


def sketch(terminal: Terminal) -> None:
    """Run it."""
    motor = terminal.motor(2)
    while True:
        terminal.say("Enter Speed")
        typed = terminal.line().strip()
        try:
            rpm = int(typed)
        except ValueError:
            terminal.say(f"{typed!r} is no whole number of rpm")
            continue
        terminal.say(rpm)
        if abs(rpm) > FASTEST:
            terminal.say(f"at most {FASTEST} rpm either way")
        elif rpm == 0:
            motor.release()
        else:
            motor.set_speed(abs(rpm))
            motor.step(1000, FORWARD if rpm > 0 else BACKWARD, DOUBLE)
            terminal.say(f"1000 steps {'clockwise' if rpm > 0 else 'counter-clockwise'}, {terminal.now:.3f} s")
            terminal.say_rotors()


run(sketch, __doc__)
