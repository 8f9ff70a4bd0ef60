"""The states of a live machine, and the one table of how it gets from one to another.

A row is (state, event) → state.  An event is the kind of a command (``trochia.messages.command``), in small letters,
or something that happens by itself, an :class:`Event`.  What is not in the table is refused if it is a command, and
cannot happen if it is not: the picture in the documentation, the legal commands in ``Status`` and the refusals are
all read off this table.
"""

from __future__ import annotations

from enum import Enum


class State(Enum):
    """What the machine is doing."""

    OFF = "off"  # drives without power
    ESTOP = "estop"  # stopped at once; nothing moves until reset
    ALARM = "alarm"  # a fault is latched
    IDLE = "idle"
    HOMING = "homing"
    JOGGING = "jogging"
    RUNNING = "running"
    HOLDING = "holding"  # braking along the path
    RETRACTING = "retracting"  # taking the tool away from the part, after a hold for a door
    HELD = "held"  # at rest in a job: held, paused by the program, or waiting for its operator
    REVERSING = "reversing"  # back along the path, beam off
    RESUMING = "resuming"  # back to where the beam went out, then on
    STEPPING = "stepping"  # running to the end of one block
    PROBING = "probing"
    STOPPING = "stopping"  # braking to give the motion up


class Event(Enum):
    """What happens without being asked for."""

    AWAY = "Away"  # a job at rest in a hold is left by its tool
    STILL = "Still"  # the motion under way has come to its end, or braking has
    PAUSED = "Paused"  # the program waits: M0, M1, a tool change, the end of a block
    PROBE = "Probe"  # the program's next move is a probing move
    CONTACT = "Contact"  # the probe has answered, and motion is at rest
    ANSWER = "Answer"  # the input that M66 reads, or waits for, has answered
    BACK = "Back"  # at speed again where a hold began
    RELEASED = "Released"  # nobody has used the drives for a while
    FAULT = "Fault"
    CLEARED = "Cleared"  # all alarms acknowledged, none still there, drives on
    DARK = "Dark"  # the same with the drives off


#: states in which motion is under way
MOVING = frozenset({
    State.HOMING, State.JOGGING, State.RUNNING, State.HOLDING, State.RESUMING, State.STEPPING, State.PROBING,
    State.STOPPING, State.RETRACTING, State.REVERSING,
})  # fmt: skip

#: commands that are taken in every state and change none
ALWAYS = ("acknowledge", "answer", "override", "record", "record-stop", "set-input", "switches")
#: commands that are taken where no motion and no job is under way, and change no state
QUIET = ("arm-beam", "load", "set-output", "unload", "work-zero")

_JOBS = {
    (State.IDLE, "run"): State.RUNNING,
    (State.IDLE, "run-from"): State.RUNNING,
    (State.IDLE, "mdi"): State.RUNNING,
    (State.IDLE, "step"): State.STEPPING,
    (State.RUNNING, "hold"): State.HOLDING,
    (State.RUNNING, Event.PAUSED): State.HELD,
    (State.RUNNING, Event.PROBE): State.PROBING,
    (State.RUNNING, Event.ANSWER): State.RUNNING,
    (State.RUNNING, Event.STILL): State.IDLE,
    (State.STEPPING, "hold"): State.HOLDING,
    (State.STEPPING, Event.PAUSED): State.HELD,
    (State.STEPPING, Event.PROBE): State.PROBING,
    (State.STEPPING, Event.ANSWER): State.STEPPING,
    (State.STEPPING, Event.STILL): State.IDLE,
    (State.PROBING, "hold"): State.STOPPING,
    (State.PROBING, Event.CONTACT): State.RUNNING,
    (State.HOLDING, Event.STILL): State.HELD,
    (State.HOLDING, Event.AWAY): State.RETRACTING,
    (State.RETRACTING, Event.STILL): State.HELD,
    (State.HELD, "resume"): State.RESUMING,
    (State.HELD, "reverse"): State.REVERSING,
    (State.REVERSING, "hold"): State.HOLDING,
    (State.REVERSING, Event.STILL): State.HELD,
    (State.HELD, "step"): State.STEPPING,
    (State.HELD, "abort"): State.IDLE,
    (State.RESUMING, "hold"): State.HOLDING,
    (State.RESUMING, Event.BACK): State.RUNNING,
    (State.RESUMING, Event.PROBE): State.PROBING,
    (State.RESUMING, Event.ANSWER): State.RUNNING,
    (State.RESUMING, Event.PAUSED): State.HELD,
    (State.RESUMING, Event.STILL): State.IDLE,
}

_HANDS = {
    (State.IDLE, "jog"): State.JOGGING,
    (State.IDLE, "jog-by"): State.JOGGING,
    (State.IDLE, "jog-to"): State.JOGGING,
    (State.IDLE, "home"): State.HOMING,
    (State.JOGGING, "jog"): State.JOGGING,
    (State.JOGGING, "jog-stop"): State.STOPPING,
    (State.JOGGING, "hold"): State.STOPPING,
    (State.JOGGING, Event.STILL): State.IDLE,
    (State.HOMING, "hold"): State.STOPPING,
    (State.HOMING, Event.STILL): State.IDLE,
    (State.STOPPING, Event.STILL): State.IDLE,
}

_POWER = {
    (State.OFF, "enable"): State.IDLE,
    (State.IDLE, "disable"): State.OFF,
    (State.IDLE, Event.RELEASED): State.OFF,
    (State.ALARM, Event.CLEARED): State.IDLE,
    (State.ALARM, Event.DARK): State.OFF,
    (State.ESTOP, "reset"): State.OFF,
}

TABLE: dict[tuple[State, str | Event], State] = {
    **{(state, command): state for state in State for command in ALWAYS},
    **{(state, command): state for state in (State.OFF, State.IDLE) for command in QUIET},
    **{(state, "abort"): State.STOPPING for state in sorted(MOVING - {State.STOPPING}, key=str)},
    **{(state, Event.FAULT): State.ALARM for state in State if state is not State.ESTOP},
    **{(state, "estop"): State.ESTOP for state in State},
    **_JOBS,
    **_HANDS,
    **_POWER,
}


def legal(state: State) -> tuple[str, ...]:
    """Return the kinds of command that are taken in a state, in alphabetical order."""
    return tuple(sorted(event for at, event in TABLE if at is state and isinstance(event, str)))
