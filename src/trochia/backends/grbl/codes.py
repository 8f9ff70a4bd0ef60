"""What GRBL 1.1 means by its numbers, and what to do about it: a row an error, a row an alarm."""

from __future__ import annotations

from typing import NamedTuple

from trochia.messages import Cause


class Meaning(NamedTuple):
    """A number's sentence, what to do, and the cause it is a case of."""

    sentence: str
    remedy: str
    cause: Cause = Cause.PROGRAM


_LINE = "Mend the line, or let Trochia write it: `trochia run` sends only what GRBL takes."
_ASK = "Look at the board's settings; `$$` shows them."

#: number of ``error:`` -> meaning
ERRORS: dict[int, Meaning] = {
    1: Meaning("a word began with no letter", _LINE),
    2: Meaning("a number is missing or cannot be read", _LINE),
    3: Meaning("the board does not know this $ command", "Look at its firmware's version; 1.1 is expected."),
    4: Meaning("a value below zero stands where none may", _LINE),
    5: Meaning("homing is switched off on the board", "Set $22=1 if the machine has switches."),
    6: Meaning("the step pulse is shorter than 3 µs", "Set $0 to 3 or more."),
    7: Meaning("the board could not read its settings and took defaults", "Check all settings before anything moves."),
    8: Meaning("the board takes this only while it is idle", "Wait for the end of motion."),
    9: Meaning("the board is locked by an alarm or a jog", "Home it, or unlock it, then begin again."),
    10: Meaning("soft limits need homing", "Set $22=1, or $20=0."),
    11: Meaning("the line is longer than the board's 79 characters", _LINE),
    12: Meaning("the step rate asked for is above what the board can make", "Lower $110 to $112 or $100 to $102."),
    13: Meaning("the safety door is open", "Close it, then go on.", Cause.DOOR),
    14: Meaning("a startup line or build name is too long to be kept", _ASK),
    15: Meaning("the jog would leave the travel", "Jog a shorter way.", Cause.SOFT_LIMIT),
    16: Meaning("the jog lacks its = or has a word that jogs cannot have", _LINE),
    17: Meaning("laser mode needs a board with a power output", "Set $32=0."),
    20: Meaning("the board does not have this code", _LINE),
    21: Meaning("two codes of one modal group stand on the line", _LINE),
    22: Meaning("no feed has been set", _LINE),
    23: Meaning("a code or value must be a whole number", _LINE),
    24: Meaning("two codes on the line both want the axis words", _LINE),
    25: Meaning("a word stands twice on the line", _LINE),
    26: Meaning("the code needs axis words, and there are none", _LINE),
    27: Meaning("the line number is out of range", _LINE),
    28: Meaning("the code lacks a value it needs", _LINE),
    29: Meaning("G59.1 to G59.3 are not there on the board", "Use G54 to G59."),
    30: Meaning("G53 goes only with G0 and G1", _LINE),
    31: Meaning("axis words stand where no code uses them", _LINE),
    32: Meaning("an arc has no end in its plane", _LINE),
    33: Meaning("the target cannot be reached: an arc's radii differ, or a probing move goes nowhere", _LINE),
    34: Meaning("an arc's radius is too small for its ends", _LINE),
    35: Meaning("an arc has no centre in its plane", _LINE),
    36: Meaning("words are left over that no code uses", _LINE),
    37: Meaning("a tool length offset stands on another axis than the board's", _LINE),
    38: Meaning("the tool number is above what the board takes", _LINE),
}

#: number of ``ALARM:`` -> meaning
ALARMS: dict[int, Meaning] = {
    1: Meaning("a limit switch was hit; motion stopped at once and the position is lost",
               "Reset, unlock, jog off the switch, home.", Cause.HARD_LIMIT),
    2: Meaning("a move would have left the travel; motion was held, the position is kept",
               "Reset and unlock; move the work zero or the part.", Cause.SOFT_LIMIT),
    3: Meaning("the board was reset while it moved; steps may be lost", "Home before anything else.", Cause.ESTOP),
    4: Meaning("the probe was not in the state the probing move expects", "Look at the probe's wiring.", Cause.PROBE),
    5: Meaning("the probe was not touched on its way", "Move nearer, or let the probing move go further.",
               Cause.PROBE),
    6: Meaning("homing was ended by a reset", "Home again.", Cause.HOMING),
    7: Meaning("homing was ended by the safety door", "Close it, home again.", Cause.HOMING),
    8: Meaning("homing could not leave the switch", "Look at the switch; raise the pull-off $27.", Cause.HOMING),
    9: Meaning("homing found no switch in its search", "Look at the switch, its wiring, and $23, $130 to $132.",
               Cause.HOMING),
    10: Meaning("homing of a two-motor axis found only one of its switches", "Look at both switches.", Cause.HOMING),
}  # fmt: skip

#: alarms that the board leaves only by a reset
CRITICAL = frozenset({1, 2})


def error(number: int) -> Meaning:
    """Return the meaning of an error's number."""
    return ERRORS.get(number, Meaning("an error this version of GRBL's list does not have", _ASK))


def alarm(number: int) -> Meaning:
    """Return the meaning of an alarm's number."""
    return ALARMS.get(number, Meaning("an alarm this version of GRBL's list does not have", _ASK, Cause.DRIVE))
