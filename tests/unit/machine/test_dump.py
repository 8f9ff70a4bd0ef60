"""Any machine that can be made can be written and read back equal."""

from __future__ import annotations

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from trochia.machine.axes import LETTERS, Axis, AxisKind, PathLimits
from trochia.machine.dump import dumps
from trochia.machine.io import Beam, Channel, Spindle
from trochia.machine.joints import Encoder, Joint, PulseTiming, Servo, Stepper
from trochia.machine.kinematics import Cartesian
from trochia.machine.load import loads
from trochia.machine.machine import Machine
from trochia.machine.transmissions import Belt, Direct, Leadscrew, Travel

positive = st.floats(1e-9, 1e9)
some = st.none() | positive
exact = st.fractions(Fraction(1, 1000), 1000)
ratio = exact | exact.map(lambda value: -value)
text = st.text(st.characters(exclude_categories=("Cs",)), max_size=12)
name = text.filter(lambda value: value.strip() != "")


@st.composite
def axes(draw: st.DrawFn, letter: str) -> Axis:
    low = draw(st.floats(-1e6, 1e6))
    return Axis(
        name=letter, kind=draw(st.sampled_from(AxisKind)), minimum=low, maximum=low + draw(st.floats(1, 1e6)),
        velocity=draw(positive), acceleration=draw(positive), jerk=draw(some),
    )  # fmt: skip


@st.composite
def joints(draw: st.DrawFn, axis: Axis, called: str) -> Joint:
    screw = [st.builds(Leadscrew, lead=exact, ratio=ratio), st.builds(Belt, pitch=exact, teeth=st.integers(1, 500))]
    fitting = [st.builds(Direct, ratio=ratio)] if axis.rotary else screw
    return Joint(
        name=called,
        motor=draw(st.builds(Servo, model=st.none() | text)),
        transmission=draw(st.one_of(st.builds(Travel, per_turn=exact, ratio=ratio), *fitting)),
        encoder=draw(st.none() | st.builds(Encoder, counts=ratio, on_load=st.booleans(), index=st.booleans())),
        backlash=draw(st.floats(0, 0.5)), velocity=draw(some), acceleration=draw(some), jerk=draw(some),
        pulses=draw(st.builds(PulseTiming, length=positive, space=positive, setup=positive, hold=positive)),
    )  # fmt: skip


@st.composite
def machines(draw: st.DrawFn) -> Machine:
    spindles = st.builds(Spindle, maximum=st.floats(10, 1e5), minimum=st.floats(0, 10), spin_up=positive)
    train = Channel(name=draw(name), kind="train", frequency=draw(positive), pin=draw(st.none() | st.integers(0, 99)))
    letters = sorted(draw(st.sets(st.sampled_from(LETTERS), min_size=1, max_size=4)), key=LETTERS.index)
    made = [draw(axes(letter)) for letter in letters]
    columns = [*range(len(made)), *draw(st.lists(st.integers(0, len(made) - 1), max_size=2))]
    names = draw(st.lists(name, min_size=len(columns), max_size=len(columns), unique=True))
    return Machine(
        name=draw(name), description=draw(text), axes=tuple(made),
        joints=tuple(draw(joints(made[column], called)) for column, called in zip(columns, names, strict=True)),
        kinematics=Cartesian(tuple(columns), len(made)),
        path=draw(st.builds(PathLimits, velocity=some, acceleration=some, jerk=some)),
        path_tolerance=draw(positive), servo_period=draw(positive), tool_change_time=draw(st.floats(0, 1e3)),
        spindle=draw(st.none() | spindles),
        beam=draw(st.none() | st.builds(Beam, kind=st.sampled_from(["shutter", "power"]), delay=st.floats(0, 1))),
        io=(train,),
    )  # fmt: skip


@given(machines(), st.booleans())
def test_any_machine_reads_back_equal(machine: Machine, comments: bool):  # noqa: FBT001 - hypothesis gives it so
    assert loads(dumps(machine, comments=comments)) == machine


@given(exact, st.integers(1, 512))
def test_steps_a_unit_survive_exactly(lead: Fraction, microsteps: int):
    joint = Joint(
        name="X", motor=Stepper(microsteps=microsteps), transmission=Leadscrew(lead=lead),
        pulses=PulseTiming(length=1e-12, space=1e-12),
    )  # fmt: skip
    axis = Axis(name="X", kind=AxisKind.LINEAR, minimum=0, maximum=1, velocity=1, acceleration=1)
    machine = Machine(name="m", axes=(axis,), joints=(joint,), kinematics=Cartesian((0,), 1))
    assert loads(dumps(machine)).joints[0].steps_per_unit == 200 * microsteps / lead
