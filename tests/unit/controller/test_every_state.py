"""Commands, faults and time in any order: what must hold in every state, and after every command."""

from __future__ import annotations

import os
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, initialize, invariant, precondition, rule

import trochia
from trochia.backends.live_twin import LiveTwin
from trochia.backends.switches import switches_of
from trochia.controller.runtime import Runtime
from trochia.controller.states import MOVING, TABLE, State, legal
from trochia.errors import LinkError
from trochia.machine.homing import Homing
from trochia.machine.io import Beam, Channel
from trochia.machine.panel import Panel
from trochia.machine.probe import Part, Probe
from trochia.messages import command as c

if TYPE_CHECKING:
    from trochia.backends.live import Report
    from trochia.machine.machine import Machine

TURN = 0.005
SLACK = 1e-6  #: of a place, and of what is rounded [mm]
TEXTS = (
    "G21 G90 G94 M3 S60\nG1 X8 F1500\nY8\nG2 X0 Y0 R8\nM2\n",
    "G21 G91 M4 S80 G1 X4 F3000\nM64 P0\nM0\nX-4\nM1\nM65 P0\nY3\nM2\n",
    "G21 G90 G0 X5 Y5\nG4 P0.1\nG1 X6 F60\nM2\n",
    "G21 T2 M6\nG1 X2 F600\nM2\n",
    "M2\n",
    "M0\nM0\nM2\n",
    "G21 G90 M3 S60 G38.3 X40 F900\nG1 Y[#5070 * 3] F600\nM66 P7 L1 Q0.3\nG1 X[#5061 - 1 + #5399]\nM2\n",
    "G21 G91 G38.2 X9 F2000\nG38.5 X-9 F300\nM66 P7 L0\nG1 Y1 F900\nM2\n",
    "",
    "G1 X1\n",  # no feed: refused
    "G21 G0 X9999\nM2\n",  # out of travel: refused
)
PROGRAMS = st.sampled_from(TEXTS)
GUARDS = ("limit-x-minus", "limit-x-plus", "limit-y-minus", "limit-y-plus")  # door, interlock, button, key
AXES = st.sampled_from(["X", "Y", "A"])
FRACTIONS = st.sampled_from([0.0, 0.3, 1.0, 1.7])
COMMANDS = st.one_of(
    st.sampled_from(
        [
            c.Enable(),
            c.Enable(),
            c.Disable(),
            c.EmergencyStop(),
            c.Reset(),
            c.Acknowledge(),
            c.Unload(),
            c.Run(),
            c.Run(),
            c.Hold(),
            c.Hold(),
            c.Resume(),
            c.Resume(),
            c.Reverse(way=4.0),
            c.Step(),
            c.Abort(),
            c.JogStop(),
            c.Home(),
            c.ArmBeam(on=True),
            c.ArmBeam(on=False),
            c.RunFrom(line=2),
        ]
    ),
    st.builds(c.Load, name=st.just("p"), text=PROGRAMS),
    st.builds(c.Mdi, text=st.sampled_from(["G0 X1", "G91 G1 Y-2 F900", "G10 L20 P1 X0", "M64 P0", "G1 X2", "M3 S5"])),
    st.builds(c.Jog, axis=AXES, speed=st.sampled_from([-30.0, 10.0, 0.0, 500.0])),
    st.builds(c.JogBy, way=st.dictionaries(AXES, st.sampled_from([-3.0, 0.0, 60.0]), max_size=2)),
    st.builds(c.JogTo, position=st.dictionaries(AXES, st.sampled_from([-3.0, 5.0]), max_size=2)),
    st.builds(c.Home, axes=st.lists(AXES, max_size=2).map(tuple)),
    st.builds(
        c.Override,
        feed=st.none() | FRACTIONS,
        rapid=st.none() | st.sampled_from([0.0, 0.5, 1.0]),
        spindle=st.none() | FRACTIONS,
    ),
    st.builds(
        c.Switches,
        single_block=st.none() | st.booleans(),
        optional_stop=st.none() | st.booleans(),
        dry_run=st.none() | st.booleans(),
        machine_lock=st.none() | st.booleans(),
    ),
    st.builds(c.WorkZero, axes=st.dictionaries(AXES, st.just(1.0), max_size=1)),
    st.builds(c.SetOutput, name=st.sampled_from(["lamp", "horn"]), value=st.just(1.0)),
    st.builds(c.SetInput, name=st.sampled_from([*GUARDS, "feed"]), value=st.sampled_from([0.0, 1.0])),
    st.builds(c.Answer, request=st.integers(0, 3), yes=st.booleans()),
)


def machine_of() -> Machine:
    made = trochia.load("xy-table")
    axes = tuple(
        replace(
            axis,
            minimum=-50.0,
            maximum=50.0,
            velocity=80.0,
            acceleration=800.0,
            jerk=2e4,
            home=Homing(
                input=f"home-{axis.name.lower()}", towards="-", position=-48.0, rest=-45.0, search=60.0, latch=10.0
            ),
        )
        for axis in made.axes
    )
    # ideal servos: whether a state lets nothing move is asked to a fraction of a micrometre
    joints = tuple(replace(joint, velocity=None, following_error=2.0, loop=None) for joint in made.joints)
    return replace(
        made,
        axes=axes,
        joints=joints,
        beam=Beam(kind="power", full_power=100.0),
        io=(
            *made.io,
            Channel(name="lamp", kind="latched"),
            Channel(name="probe", kind="input"),
            Channel(name="feed", kind="input"),
        ),
        panel=Panel(door=GUARDS[0], interlock=GUARDS[1], estop=GUARDS[2], arm=GUARDS[3], idle_release=3.0),
        probe=Probe(input="probe", part=Part(left=9.0, right=30.0)),
    )


class Flaky(LiveTwin):
    """A twin whose link can fail."""

    broken = False

    def poll(self, now: float) -> Report:
        """Report, or fail."""
        report = super().poll(now)
        if self.broken:
            raise LinkError("no answer")
        return report


class EveryState(RuleBasedStateMachine):
    """The machine, and whoever is at it."""

    @initialize(x=st.floats(-40.0, 40.0), y=st.floats(-40.0, 40.0))
    def power_up(self, x: float, y: float) -> None:
        self.machine = machine_of()
        self.twin = Flaky(self.machine, position=np.array([x, y]), switches=switches_of(self.machine))
        self.runtime = Runtime(self.twin)
        self.it = self.runtime.controller
        self.now, self.idle = 0.0, 0.0
        self.still = self.twin.plant.load.copy()
        self.dark_by = 0.0

    @rule(command=COMMANDS)
    def command(self, command: c.AnyCommand) -> None:
        self.runtime.turn(self.now)  # what has come about by now comes first
        was, kind = self.it.state, str(type(command).__struct_config__.tag)
        turned = (was, kind) in TABLE
        ack = self.runtime.command(command, self.now)
        assert ack.id == command.id
        assert ack.ok or ack.reason
        if not turned:
            assert not ack.ok
        if not ack.ok:
            assert set(ack.legal) <= set(legal(was)) | set(legal(self.it.state))
        if ack.ok and kind in {"hold", "abort", "estop"}:
            self.dark_by = self.now

    @rule(count=st.integers(1, 120))
    def time(self, count: int) -> None:
        for _ in range(count):
            self.tick()

    @rule()
    def recover(self) -> None:
        """Bring the machine to idle as an operator would: from every state that works."""
        self.twin.faulty.clear()
        self.twin.plant.jammed.clear()
        self.twin.broken = False
        for number, name in enumerate(GUARDS):
            self.command(c.SetInput(name=name, value=float(number == len(GUARDS) - 1)))
        self.tick()
        for command in (c.Abort(), c.Reset(), c.Acknowledge(), c.Enable(), c.Override(feed=1.0, rapid=1.0)):
            self.command(command)
            for _ in range(6000):
                self.tick()
                if self.it.state not in MOVING:
                    break
        assert self.it.state is State.IDLE, self.it.alarms.latched
        self.command(c.Switches(machine_lock=False))
        self.command(c.Home())
        for _ in range(12000):
            self.tick()
            if self.it.state is not State.HOMING:
                break
        assert all(self.it.trusted.values())

    @rule(text=PROGRAMS)
    @precondition(lambda self: self.it.state is State.IDLE)
    def begin(self, text: str) -> None:
        for number, name in enumerate(GUARDS):
            self.command(c.SetInput(name=name, value=float(number == len(GUARDS) - 1)))
        self.command(c.ArmBeam(on=True))
        self.command(c.Load(name="p", text=text))
        self.command(c.Run())

    @rule(joint=st.sampled_from(["X", "Y"]), what=st.sampled_from(["drive", "jam", "link", "off"]))
    def fault(self, joint: str, what: str) -> None:
        if what == "drive":
            self.twin.faulty.add(joint)
        elif what == "jam":
            self.twin.plant.jammed.add(joint)
        elif what == "link":
            self.twin.broken = True
        else:
            self.twin._enabled = False
            self.twin._halt()

    @rule()
    def mend(self) -> None:
        self.twin.faulty.clear()
        self.twin.plant.jammed.clear()
        self.twin.broken = False

    def tick(self) -> None:
        self.now = round(self.now + TURN, 9)
        was, before = self.it.state, self.it.report.commanded.copy()
        self.runtime.turn(self.now)
        if was is self.it.state and was in {State.IDLE, State.HELD}:
            np.testing.assert_allclose(self.it.report.commanded, before, atol=SLACK)
        self.looks_right()

    @invariant()
    def looks_right(self) -> None:
        if not hasattr(self, "it"):
            return
        state, report = self.it.state, self.it.report
        dark = {State.OFF, State.ESTOP, State.IDLE, State.HELD, State.HOMING, State.JOGGING}
        if state in dark and not self.twin.broken:
            assert self.twin._beam == 0.0, state
        if state in {State.HOLDING, State.STOPPING, State.ALARM} and self.now > self.dark_by + TURN:
            assert self.twin._beam == 0.0, state
        if state in {State.OFF, State.ESTOP} and not self.twin.broken:
            assert not self.twin._executor.moving
        for axis, at in zip(self.machine.axes, report.commanded, strict=True):
            if self.it.trusted[axis.name] and state is not State.HOMING:
                assert axis.minimum - SLACK <= at <= axis.maximum + SLACK, (axis.name, at, state)
        status = self.it.status(self.now)
        assert status.legal == legal(state)
        assert (status.state == "alarm") <= bool(status.alarms) or self.it.activity is None
        if state is State.IDLE:
            assert self.it.activity is None
            assert status.request is None


TestEveryState = EveryState.TestCase
TestEveryState.settings = settings(
    max_examples=int(os.environ.get("TROCHIA_STATES", "5")),
    stateful_step_count=25,
    phases=[Phase.explicit, Phase.reuse, Phase.generate],  # a case is long: it is not cut down
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.filter_too_much],
)
