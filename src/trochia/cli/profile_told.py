"""How ``trochia profile`` tells what it found: to a person, as JSON, as CSV."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import click

from trochia.cli.tables import clock, table

if TYPE_CHECKING:
    from trochia.cli.motor_options import Asked
    from trochia.cli.profile_found import Found
    from trochia.pulses.ramps import Profile

_SHOWN = 5  # rows of the table's beginning and of its end
_NAMED = 8  # rows of an excitation that are told by their phases


def csv_text(found: Found) -> str:
    """Return the whole table as CSV; numbers with nine significant digits, torques where there is a motor."""
    columns: dict[str, Any] = dict(found.profile.columns())
    if found.use is not None:
        columns |= {"torque_needed_Nm": found.use.needed, "torque_available_Nm": found.use.available}
    lines = [",".join(columns)]
    lines += [
        ",".join(f"{value:.9g}" for value in row)
        for row in zip(*(column.tolist() for column in columns.values()), strict=True)
    ]
    return "\n".join(lines) + "\n"


def json_of(found: Found, motor: Asked | None, chip_clock: float | None) -> dict[str, Any]:
    """Return what was found by JSON's keys; the table is a list of rows."""
    from trochia.pulses.ramps import one_acceleration  # noqa: PLC0415 - `trochia --help` must stay light

    profile, verdict = found.profile, found.verdict
    columns = {key: column.tolist() for key, column in profile.columns().items()}
    even = one_acceleration(profile)
    return {
        "law": profile.law,
        "steps": profile.demand.steps,
        "time_s": profile.duration,
        "peak_steps_s": profile.peak,
        "acceleration_steps_s2": profile.demand.rising if even else None,
        "deceleration_steps_s2": profile.demand.falling if even else None,
        "ok": found.ok,
        "verdict": {"ok": verdict.ok, "reason": verdict.reason, "remedy": verdict.remedy},
        "motor": None if motor is None else _motor_json(found, motor),
        "timer": None if chip_clock is None else _timer_json(profile, chip_clock),
        "table": [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)],
    }


def _motor_json(found: Found, motor: Asked) -> dict[str, Any]:
    """Return what the motor makes of it."""
    from trochia.analysis.stepper_move import figures  # noqa: PLC0415 - `trochia --help` must stay light

    assert found.use is not None
    proof, remedy = found.proof, found.remedy
    return {
        "name": motor.title,
        "excitation": motor.made.excitation.name,
        "current_A": motor.made.current,
        "holding_torque_Nm": motor.made.holding,
        **figures(found.use, found.profile.demand.steps_per_turn),
        "twin": None if proof is None else {"lost_steps": proof.lost, "from_step": proof.step,
                                            "at_steps_s": proof.speed},
        "would_do": None if remedy is None else {"speed_steps_s": remedy.demand.speed,
                                                 "acceleration_steps_s2": remedy.demand.rising,
                                                 "deceleration_steps_s2": remedy.demand.falling,
                                                 "time_s": remedy.duration},
    }  # fmt: skip


def _timer_json(profile: Profile, chip_clock: float) -> list[dict[str, Any]]:
    from trochia.pulses.ramps.timer import settings  # noqa: PLC0415 - `trochia --help` must stay light

    return [
        {"division": one.division, "clock_Hz": one.clock, "longest_ticks": one.longest, "shortest_ticks": one.shortest,
         "fits": one.fits} for one in settings(profile, chip_clock)
    ]  # fmt: skip


def show(found: Found, motor: Asked | None, chip_clock: float | None, speed: float | None = None) -> None:
    """Print the first and last rows, the summary, what the motor makes of it, and the verdict."""
    from trochia.pulses.ramps import COLUMNS, one_acceleration  # noqa: PLC0415 - `trochia --help` must stay light

    profile = found.profile
    demand, columns, size = profile.demand, profile.columns(), profile.delays.size
    click.secho(
        f"{profile.title}: {demand.steps} step{'s' * (demand.steps > 1)} in {clock(profile.duration)}", bold=True
    )
    rows = range(size) if size <= 2 * _SHOWN + 1 else [*range(_SHOWN), None, *range(size - _SHOWN, size)]
    cells = [[title for _, title, _ in COLUMNS]]
    cells += [
        ["…" for _ in COLUMNS] if row is None else [f"{columns[key][row]:.{digits}f}" for key, _, digits in COLUMNS]
        for row in rows
    ]
    click.echo(table(cells, left=()))
    reached, held = _parts(profile)
    click.echo(f"  accelerates for {reached} steps, holds {demand.said(profile.peak)} for {held}, "
               f"brakes for {size - reached - held}")  # fmt: skip
    if one_acceleration(profile):
        click.echo(f"  acceleration {demand.said_acceleration(demand.rising)}, "
                   f"deceleration {demand.said_acceleration(demand.falling)}")  # fmt: skip
    if speed is not None:
        _show_reach(profile, speed)
    _show_timer(profile, chip_clock)
    if motor is not None:
        _show_motor(found, motor)
    _show_verdict(found)


def _show_verdict(found: Found) -> None:
    """Print the answer and what would do."""
    verdict, demand = found.verdict, found.profile.demand
    reason = verdict.reason
    if not found.ok and verdict.ok:
        use = found.use
        lost = "the motor does not start so fast" if use is not None and not use.starts else "the motor loses steps"
        reason = f"{lost}; {reason}"
    click.secho(f"  {'It will do' if found.ok else 'It will not do'}: {reason}", fg="green" if found.ok else "red")
    if verdict.remedy is not None:
        click.echo(f"  {verdict.remedy}{_cured(found)}")
    if found.remedy is not None:
        cure = found.remedy.demand
        speed = "" if cure.speed == demand.speed else f" and a speed of {demand.at_most(cure.speed)}"
        down = "" if cure.deceleration is None else f", {demand.at_most_acceleration(cure.falling)} down"
        checked = ", on the twin too" if found.proof is not None else ""
        click.echo(f"  The motor makes it with an acceleration of {demand.at_most_acceleration(cure.rising)}{down}"
                   f"{speed}, in {found.remedy.duration:.4g} s{checked}.")  # fmt: skip
    elif found.use is not None and not found.use.ok:
        click.echo("  No lower speed or acceleration was found that does: take a stronger motor, a higher supply, a "
                   "gear, or a lighter load.")  # fmt: skip


def _cured(found: Found) -> str:
    """Return whether the motor makes what the verdict offers."""
    use = found.cured
    if use is None:
        return ""
    if use.ok:
        return f" The motor makes that, {use.left:.0%} of its torque left."
    why = "it does not start so fast" if not use.starts else f"it would lose steps from step {use.lost_at} on"
    return f" The motor does not make that: {why}."


def _show_reach(profile: Profile, speed: float) -> None:
    """Print time and steps to a speed, and from it to rest."""
    from trochia.pulses.ramps.reach import reach  # noqa: PLC0415 - `trochia --help` must stay light

    found = reach(profile, speed)
    if found is not None:
        click.echo(f"  {profile.demand.said(speed)}: reached in {1e3 * found.up_time:.4g} ms, {found.up_steps:.4g} "
                   f"steps; to rest in {1e3 * found.down_time:.4g} ms, {found.down_steps:.4g} steps")  # fmt: skip


def _show_timer(profile: Profile, chip_clock: float | None) -> None:
    """Print whether a timer of 16 bits counts the delays."""
    from trochia.pulses.ramps.demand import shown, shown_down  # noqa: PLC0415 - `trochia --help` must stay light
    from trochia.pulses.ramps.timer import BITS, best, setting, settings  # noqa: PLC0415

    if chip_clock is None:
        one = setting(profile, profile.demand.clock)
        if not one.fits:
            fits = profile.demand.clock * (2**BITS - 1) / one.longest
            said = f"{shown_down(fits / 1e3)} kHz" if fits >= 1e3 else f"{shown_down(fits)} Hz"
            click.secho(f"  timer: a delay of {one.longest} ticks does not fit {BITS} bits; a clock of at most "
                        f"{said} would do", fg="yellow")  # fmt: skip
        return
    chosen = best(profile, chip_clock)
    for one in settings(profile, chip_clock):
        word = f"fits, a tick is {shown(float(f'{100 * one.coarseness:.2g}'))} % of the greatest speed"
        if not one.fits:
            word = (
                f"does not fit: {BITS} bits hold no less than {one.slowest:.3g} steps/s" if one.shortest else "too slow"
            )
        mark = "  <- the finest" if one == chosen else ""
        click.echo(f"  timer at {chip_clock / 1e6:g} MHz / {one.division}: delays of {one.shortest} to {one.longest} "
                   f"ticks, {word}{mark}")  # fmt: skip


def _show_motor(found: Found, motor: Asked) -> None:
    """Print what the move asks of the motor."""
    use, demand = found.use, found.profile.demand
    assert use is not None
    click.secho(f"  {motor.title}", bold=True)
    lines = [("excitation", _excitation(motor)), ("starts", _starts(found)), ("follows", _follows(found)),
             ("stalls", _stalls(found, motor))]  # fmt: skip
    if use.hunts is not None:
        lines.append(("hunts", f"from {demand.said(use.hunts)} on by linear theory: there it may fall out of step"))
    if use.swing:
        lines.append(("swings", f"{use.swing:.0%} of what is safe, by linear theory"))
    if use.resonance < use.peak and motor.made.excitation.steps_per_full_step <= 2:
        lines.append(("resonates", f"at {demand.said(use.resonance)}, which the ramp passes"))
    lines += [("too hot", text) for text in use.too_hot]
    if found.proof is not None:
        lines.append(("on the twin", _proof(found)))
    click.echo(table([[name, text] for name, text in lines], left=(0, 1)))


def _excitation(motor: Asked) -> str:
    """Return how the phases are switched, with what current, for what torque."""
    made = motor.made
    mode = made.excitation
    text = f"{mode.name}, {made.current:.3g} A a phase, holds {made.holding:.3g} N·m"
    if len(mode.levels) > _NAMED:
        return f"{text}; {motor.pulses_per_turn} steps a turn"
    signs = {1: "+", -1: "-"}
    rows = ["".join(f"{phase}{signs[int(level)]}" for phase, level in zip("AB", row, strict=True) if level)
            for row in mode.levels.tolist()]  # fmt: skip
    return f"{text}; {' '.join(rows)}"


def _starts(found: Found) -> str:
    """Return whether the first and the last step are slow enough."""
    use, demand = found.use, found.profile.demand
    assert use is not None
    if not use.start_stop:
        return "no: the load holds it"
    slow = f"it starts and stops up to {demand.said(use.start_stop)} (an estimate from energy)"
    return f"{'yes' if use.starts else 'no'}: the first step is made at {demand.said(use.first)}, {slow}"


def _follows(found: Found) -> str:
    """Return whether the torque suffices at every step, and where it is tightest."""
    use, demand = found.use, found.profile.demand
    assert use is not None
    worst = use.worst
    speed = demand.said(float(found.profile.speeds[worst]))
    there = max(float(use.available[worst]), 0.0)
    tight = f"step {worst}, {speed}, takes {abs(float(use.needed[worst])):.3g} of {there:.3g} N·m"
    if use.lost_at is not None:
        first = demand.said(float(found.profile.speeds[use.lost_at]))
        return f"no: it would lose steps from step {use.lost_at} on, {first}; the worst, {tight}"
    left = f"{max(use.left, 0.0):.0%} left"
    return f"{'yes' if use.easy else 'closely'}: at its tightest, {tight}: {left}, {use.margin:.0%} wanted"


def _stalls(found: Found, motor: Asked) -> str:
    """Return at which speed the load takes all torque."""
    use, demand = found.use, found.profile.demand
    assert use is not None
    angle = demand.step_angle
    fifth = motor.made.top() / angle
    if use.stalls > fifth:
        return f"not below {demand.said(fifth)}, where a fifth of its torque is left (iron losses are not in the model)"
    planned = f"; with the margin up to {demand.said(use.usable)}" if math.isfinite(use.usable) else ""
    return f"above {demand.said(use.stalls)} under this load{planned}"


def _proof(found: Found) -> str:
    """Return what the twin did."""
    proof, demand = found.proof, found.profile.demand
    assert proof is not None
    assert found.use is not None
    if proof.ok:
        return "no step is lost"
    assert proof.step is not None
    assert proof.speed is not None
    why = "" if found.use.lost_at is not None else "; the closed forms know no swinging: more friction or damping helps"
    return f"{abs(proof.lost)} full steps are lost, from step {proof.step} on, {demand.said(proof.speed)}{why}"


def _parts(profile: Profile) -> tuple[int, int]:
    """Return the steps before the shortest delay is first used, and how many use it."""
    shortest = float(profile.delays.min())
    held = (profile.delays <= shortest * (1.0 + 1e-9)).nonzero()[0]
    return int(held[0]), int(held[-1] - held[0] + 1)
