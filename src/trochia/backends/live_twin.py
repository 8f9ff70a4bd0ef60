"""The digital twin as a live backend: the machine that is there when no machine is there, run by a clock it is told.

In: orders.  Out: reports.  It goes from servo tick to servo tick up to the time it is asked about; with a virtual clock
or a real one it does the same.  Switches are where the machine really is, whatever the controller believes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

import numpy as np

from trochia.backends.executor import Executor
from trochia.backends.live import BUILT_IN, Orders, Report, Ticks, Trouble, check_outputs
from trochia.backends.plant import Plant
from trochia.backends.switches import Indexes, crossing
from trochia.errors import LocalProtocolError
from trochia.messages import Cause

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from trochia.backends.executor import Told
    from trochia.backends.live import Watch
    from trochia.machine.machine import Machine

    Switch = Callable[[NDArray[np.float64]], bool]


SHALLOW, DEEP = 0.2, 0.6  #: motion it holds [s]: by a virtual clock; by a real one, for a host kept from its work
AT_REST = 1000  #: servo periods at a time while servos settle


def absolute_joints(machine: Machine) -> NDArray[np.bool_]:
    """Return for each joint (joints,) whether its encoder knows at power-up where it is."""
    known = np.array([axis.home is not None and axis.home.method == "absolute" for axis in machine.axes])
    return np.array([bool(known[row != 0.0].all()) for row in machine.kinematics.matrix])


class LiveTwin:
    """One machine, live.

    Parameters
    ----------
    position
        Where the joints really are at power-up (joints,) [mm or degree]; all at 0 where None.
    switches
        Inputs by name: whether each is active, from the joints' real positions (joints,).
    ahead
        How much motion it wants to hold [s].

    Attributes
    ----------
    inputs
        Levels of inputs that are no switches; a test or a person sets them.
    faulty
        Joints whose drive reports a fault.
    tap
        Is told of every servo tick.
    """

    kind: ClassVar[str] = "twin"
    title = "twin"

    def __init__(
        self,
        machine: Machine,
        *,
        position: NDArray[np.float64] | None = None,
        switches: Mapping[str, Switch] | None = None,
        ahead: float = SHALLOW,
    ) -> None:
        joints = len(machine.joints)
        real = np.zeros(joints) if position is None else position.astype(np.float64)
        self.machine = machine
        self.latency = machine.servo_period
        self.ahead = ahead
        self.plant = Plant(machine, real)
        self.inputs: dict[str, float] = {c.name: False for c in machine.io if c.kind == "input"}
        self.inputs |= {channel.name: 0.0 for channel in machine.io if channel.kind == "analog-input"}
        names = (*BUILT_IN, *(channel.name for channel in machine.io if not channel.kind.endswith("input")))
        self.outputs = dict.fromkeys(names, 0.0)
        self.faulty: set[str] = set()
        self.tap: Callable[[Ticks], None] | None = None
        self._switches = dict(switches or {})
        self._indexes = Indexes(machine)
        self.inputs |= dict.fromkeys(self._indexes.names, False)
        self._names = [joint.name for joint in machine.joints]
        called = np.where(absolute_joints(machine), real, 0.0)
        self._offset = called - real  # what the controller calls a position, less where it really is
        self._executor = Executor(called, machine.servo_period)
        self._now = 0.0
        self._enabled = self._lit = False
        self._beam, self._line = 0.0, 0
        self._velocity = np.zeros(joints)
        self._timed: list[tuple[float, str, float]] = []
        self._watch: tuple[Watch, ...] = ()
        self._caught: tuple[str, NDArray[np.float64]] | None = None
        self._troubles: list[Trouble] = []

    def open(self, now: float) -> Report:
        """Begin at this time; nothing moves, drives are off."""
        self._now = now
        return self.poll(now)

    def close(self) -> None:
        """Stop, drives off."""
        self._halt()
        self._enabled = False

    def poll(self, now: float) -> Report:
        """Run up to ``now`` and report."""
        ticks = int((now - self._now) / self.machine.servo_period + 1e-6)
        while ticks > 0:
            ticks -= self._run(ticks)
        self._look_at_drives()
        executor = self._executor
        executor.queue.forget(executor.executed)
        troubles = tuple(self._troubles)
        self._troubles.clear()
        return Report(
            time=self._now, executed=executor.executed, rate=executor.rate if executor.moving else 0.0,
            queued=executor.queue.end - executor.executed if executor.moving else 0.0, commanded=executor.commanded,
            velocity=self._velocity, encoder=self.plant.encoder() + self._offset,
            actual=self.plant.real(self.plant.load[None, :])[0] + self._offset, enabled=self._enabled,
            beam=self._beam, line=self._line,
            inputs=self._read(), outputs=dict(self.outputs), troubles=troubles, caught=self._caught,
            settable=True,
        )  # fmt: skip

    def order(self, orders: Orders, now: float) -> None:  # noqa: ARG002 - the clock is told by poll
        """Take orders; see :class:`trochia.backends.live.SegmentBackend`."""
        if orders.stop or orders.enable is False:
            self._halt()
        if orders.enable and not self._enabled:
            self._rejoin()
        self._enabled = self._enabled if orders.enable is None else orders.enable
        self._set_outputs(orders)
        self._set_inputs(orders.inputs)
        if orders.lit is not None:
            self._lit = orders.lit
            self._beam = self._beam if orders.lit else 0.0
        if orders.watch is not None:
            self._watch, self._caught = orders.watch, None
        if orders.place:
            self._place(orders.place)
        stale = self._caught is not None and orders.watch is None  # sent before the host knew
        if orders.segments is not None and not stale:
            if not self._enabled:
                raise LocalProtocolError("segments for drives that are off")
            self._executor.add(orders.segments, orders.at)

    def _set_outputs(self, orders: Orders) -> None:
        check_outputs(orders, self.outputs)
        self.outputs |= orders.outputs
        if orders.segments is not None:
            self._timed = [entry for entry in self._timed if entry[0] < orders.at]
        self._timed = sorted([*self._timed, *orders.timed])

    def _set_inputs(self, levels: Mapping[str, float]) -> None:
        for name in levels:
            if name not in self.inputs:
                raise LocalProtocolError(f"there is no input {name!r}", hint=f"There are: {', '.join(self.inputs)}")
        self.inputs |= levels

    def _read(self) -> dict[str, float]:
        return self.inputs | {name: switch(self.plant.load) for name, switch in self._switches.items()}

    def _place(self, names: Mapping[str, float]) -> None:
        """Call the joints' present positions by other numbers."""
        if self._executor.moving:
            raise LocalProtocolError("positions are named at rest only")
        commanded = self._executor.commanded
        for name, value in names.items():
            i = self._names.index(name)
            self._offset[i] += value - commanded[i]
            commanded[i] = value
        self._executor.queue.clear(commanded, self._executor.executed)

    def _halt(self) -> None:
        """Stand still at once: what is queued is gone."""
        self._executor.halt()
        self._rest()
        self._timed.clear()
        self.outputs |= dict.fromkeys(BUILT_IN, 0.0)

    def _rejoin(self) -> None:
        """Command every servo to be where it is: its loop closes without a jump."""
        true = self.plant.rejoin(self._executor.commanded - self._offset)
        self._executor.queue.clear(true + self._offset, self._executor.executed)

    def _rest(self) -> None:
        self._velocity = np.zeros(len(self._names))
        self._beam = 0.0

    def _run(self, ticks: int) -> int:
        """Run through up to so many servo ticks, and return how many."""
        if not self._executor.moving:
            settling = self._enabled and self.plant.restless
            if settling:
                ticks = min(ticks, AT_REST)
                self.plant.follow(np.tile(self._executor.commanded - self._offset, (ticks, 1)))
                self._look_at_joints()
            self._now += ticks * self.machine.servo_period
            self._rest()
            self._outputs_due()
            self._tell_rest(ticks, settling=settling)
            return ticks
        braking = self._executor.braking
        before = (self.plant.load.copy(), self.plant.motor.copy(), self._measured()) if self._watch else None
        told = self._executor.run(ticks, one=bool(self._watch))
        if self._executor.rate == 0.0 and not braking:
            self._troubles.append(Trouble(cause=Cause.UNDERRUN))
        self.plant.follow(told.commanded - self._offset)
        self._now += told.ticks * self.machine.servo_period
        self._velocity, self._line = told.velocity, told.line
        self._light(told)
        self._tell(told)
        self._outputs_due()
        if before is not None:
            self._look_at_inputs(*before)
        self._look_at_joints()
        return told.ticks

    def _light(self, told: Told) -> None:
        """Light the beam at full rate only: whoever slows it down has stopped it."""
        lit = self._lit and not self._executor.braking and self._executor.rate >= 1.0
        self._beam = told.power if lit and bool(told.velocity.any()) else 0.0

    def _tell(self, told: Told) -> None:
        """Tell who listens of ticks in motion."""
        if self.tap is None:
            return
        lit = self._lit and not self._executor.braking and self._executor.rate >= 1.0
        beam = np.where(told.speeds.any(axis=1), told.powers, 0.0) if lit else np.zeros(told.ticks)
        self.tap(Ticks(
            period=self.machine.servo_period, executed=told.executed, commanded=told.commanded, velocity=told.speeds,
            encoder=self.plant.measured + self._offset,
            actual=self.plant.real(self.plant.loads) + self._offset,
            beam=beam.astype(np.float32), line=told.lines,
        ))  # fmt: skip

    def _tell_rest(self, ticks: int, *, settling: bool) -> None:
        """Tell who listens of ticks at rest, of the command or of all."""
        if self.tap is None:
            return
        joints = len(self._names)
        loads = self.plant.loads if settling else np.tile(self.plant.load, (ticks, 1))
        self.tap(Ticks(
            period=self.machine.servo_period, executed=np.full(ticks, self._executor.executed),
            commanded=np.tile(self._executor.commanded, (ticks, 1)), velocity=np.zeros((ticks, joints)),
            encoder=(self.plant.measured if settling else np.tile(self.plant.encoder(), (ticks, 1))) + self._offset,
            actual=self.plant.real(loads) + self._offset,
            beam=np.zeros(ticks, np.float32), line=np.full(ticks, self._line, np.uint32),
        ))  # fmt: skip

    def _outputs_due(self) -> None:
        while self._timed and self._timed[0][0] <= self._executor.executed + 1e-9:
            _, name, value = self._timed.pop(0)
            self.outputs[name] = value

    def _measured(self) -> NDArray[np.float64]:
        """Return where the joints are by their encoders, or where they are told to be without one (joints,)."""
        encoder = self.plant.encoder() + self._offset
        return np.where(np.isfinite(encoder), encoder, self._executor.commanded)

    def _look_at_inputs(
        self, loads: NDArray[np.float64], motors: NDArray[np.float64], measured: NDArray[np.float64]
    ) -> None:
        """Brake at an input that is watched; switches and index pulses are caught inside the tick that began there."""
        levels = self._read()
        for watch in self._watch:
            share: float | None = None
            if watch.name in self._indexes.names:
                share = self._indexes.passed(watch.name, motors, self.plant.motor)
            elif levels.get(watch.name) == watch.level:
                switch = self._switches.get(watch.name)
                share = 1.0 if switch is None else crossing(switch, loads, self.plant.load, level=watch.level)
            if share is not None:
                self._caught = (watch.name, measured + share * (self._measured() - measured))
                self._watch, self._executor.braking, self._beam = (), True, 0.0
                return

    def _look_at_joints(self) -> None:
        """Stop at once where a load lags too far."""
        for joint, lag in zip(self.machine.joints, self.plant.lag, strict=True):
            if joint.following_warning is not None and lag > joint.following_warning:
                self._troubles.append(Trouble(cause=Cause.FOLLOWING_WARNING, joint=joint.name, value=float(lag),
                                              limit=joint.following_warning))  # fmt: skip
            if joint.following_error is not None and lag > joint.following_error:
                self._troubles.append(
                    Trouble(cause=Cause.FOLLOWING, joint=joint.name, value=float(lag), limit=joint.following_error)
                )
                self._halt()

    def _look_at_drives(self) -> None:
        for name in sorted(self.faulty):
            self._troubles.append(Trouble(cause=Cause.DRIVE, joint=name))
            self._halt()
