"""The H bridge of one phase as a picture: which transistors conduct in each state, and the way of the current.

In: nothing; the states are those of ``machine/drivers/bridge.py``.  Out: the bytes of a PNG or SVG.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from trochia.machine.drivers.bridge import Output, bridge_voltage

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_INK, _SOFT, _FAINT, _LIVE = "#222222", "#777777", "#c9c9c9", "#d55e00"
_SUPPLY, _MIDDLE, _GROUND, _LEFT, _RIGHT, _OUT = (
    6.0,
    3.0,
    0.0,
    1.4,
    4.6,
    0.62,
)  # where lines run; diodes stand _OUT beside
_PLACES = {"T1": (_LEFT, 4.5), "T2": (_LEFT, 1.5), "T3": (_RIGHT, 4.5), "T4": (_RIGHT, 1.5)}
_STYLE: dict[Any, Any] = {"font.size": 10, "text.color": _INK, "svg.hashsalt": "trochia"}


@dataclass(frozen=True, slots=True, kw_only=True)
class State:
    """A state of the bridge.

    Attributes
    ----------
    title, said
        What it is called, and what it does.
    outputs
        Of both halves, A and B.
    conducting
        Transistors and diodes that carry the current, in its order from left.
    way
        The current's way, corners (x, y).
    """

    title: str
    said: str
    outputs: tuple[Output, Output]
    conducting: tuple[str, ...]
    way: tuple[tuple[float, float], ...]

    @property
    def voltage(self) -> str:
        """What the phase sees."""
        volts = bridge_voltage(*self.outputs, 1.0)
        return {None: "-V", 0.0: "0"}.get(volts, f"{volts or 0.0:+.0f} V".replace("1 ", ""))


_HIGH, _LOW, _OPEN = Output.HIGH, Output.LOW, Output.OPEN
_DOWN_LEFT, _DOWN_RIGHT = _LEFT - _OUT, _RIGHT + _OUT
STATES = (
    State(title="A+", said="T1 and T4 on:\nthe current rises forwards", outputs=(_HIGH, _LOW), conducting=("T1", "T4"),
          way=((_LEFT, _SUPPLY), (_LEFT, _MIDDLE), (_RIGHT, _MIDDLE), (_RIGHT, _GROUND))),
    State(title="A-", said="T2 and T3 on:\nthe current rises backwards", outputs=(_LOW, _HIGH), conducting=("T3", "T2"),
          way=((_RIGHT, _SUPPLY), (_RIGHT, _MIDDLE), (_LEFT, _MIDDLE), (_LEFT, _GROUND))),
    State(title="all off after A+", said="enable low: D2 and D3 lead\nthe current back to the supply",
          outputs=(_OPEN, _OPEN), conducting=("D2", "D3"),
          way=((_DOWN_LEFT, _GROUND), (_DOWN_LEFT, _MIDDLE), (_DOWN_RIGHT, _MIDDLE), (_DOWN_RIGHT, _SUPPLY))),
    State(title="level 0, released", said="inputs low, enable high: T2 and T4 on,\nshorted; a turning rotor is braked",
          outputs=(_LOW, _LOW), conducting=("D2", "T4"),
          way=((_DOWN_LEFT, _GROUND), (_DOWN_LEFT, _MIDDLE), (_RIGHT, _MIDDLE), (_RIGHT, _GROUND),
               (_DOWN_LEFT, _GROUND))),
)  # fmt: skip


def picture(form: str = "png") -> bytes:
    """Return the states side by side as ``png`` or ``svg``."""
    import matplotlib as mpl  # noqa: PLC0415 - takes half a second, and only a picture needs it
    from matplotlib.figure import Figure  # noqa: PLC0415 - as above

    with mpl.rc_context(_STYLE):
        sheet = Figure(figsize=(12.0, 4.2), dpi=110, layout="constrained")
        panels: Any = sheet.subplots(1, len(STATES))
        for axes, state in zip(panels, STATES, strict=True):
            _draw_bridge(axes, state)
        out = io.BytesIO()
        sheet.savefig(out, format=form, metadata={"Date": None} if form == "svg" else None)
    return out.getvalue()


def _draw_bridge(axes: Axes, state: State) -> None:
    """Draw one state."""
    axes.set(xlim=(-0.3, 6.3), ylim=(-1.7, 6.7), aspect="equal")
    axes.axis("off")
    for y in (_SUPPLY, _GROUND):
        axes.plot([_DOWN_LEFT - 0.35, _DOWN_RIGHT + 0.35], [y, y], color=_INK, linewidth=1.4, zorder=1)
    axes.text(_DOWN_LEFT - 0.35, _SUPPLY + 0.12, "supply", fontsize=8, color=_SOFT, va="bottom")
    for x in (_LEFT, _RIGHT):
        axes.plot([x, x], [_GROUND, _SUPPLY], color=_FAINT, linewidth=1.2, zorder=1)
    axes.plot([_LEFT, _RIGHT], [_MIDDLE, _MIDDLE], color=_FAINT, linewidth=1.2, zorder=1)
    x, y = zip(*state.way, strict=True)
    axes.plot(x, y, color=_LIVE, linewidth=3.2, solid_joinstyle="round", zorder=2)
    for (x0, y0), (x1, y1) in zip(state.way, state.way[1:], strict=False):
        if y0 == y1:  # an arrow on either side of the phase
            for part in (0.24, 0.88):
                tip, tail = x0 + part * (x1 - x0), x0 + (part - 0.05) * (x1 - x0)
                axes.annotate("", (tip, y1), (tail, y0), zorder=5,
                              arrowprops={"arrowstyle": "-|>", "color": _LIVE, "mutation_scale": 16})  # fmt: skip
    for name, (x0, y0) in _PLACES.items():
        _draw_transistor(axes, name, x0, y0, on=name in state.conducting)
        outside = x0 - _OUT if x0 == _LEFT else x0 + _OUT
        _draw_diode(axes, "D" + name[1], (x0, outside), y0, on="D" + name[1] in state.conducting)
    axes.text(0.5 * (_LEFT + _RIGHT), _MIDDLE, "phase", ha="center", va="center", fontsize=9, zorder=6,
              bbox={"boxstyle": "round,pad=0.35", "facecolor": "white", "edgecolor": _INK})  # fmt: skip
    axes.set_title(f"{state.title}: {state.voltage}", fontsize=11, fontweight="bold")
    axes.text(3.0, -0.5, state.said, ha="center", va="top", fontsize=9, color=_SOFT, in_layout=False)


def _draw_transistor(axes: Axes, name: str, x: float, y: float, *, on: bool) -> None:
    """Draw a transistor as a box, filled where it conducts."""
    axes.text(x, y, name, ha="center", va="center", fontsize=9, zorder=6, color="white" if on else _SOFT,
              bbox={"boxstyle": "square,pad=0.32", "facecolor": _LIVE if on else "white",
                    "edgecolor": _LIVE if on else _SOFT})  # fmt: skip


def _draw_diode(axes: Axes, name: str, across: tuple[float, float], y: float, *, on: bool) -> None:
    """Draw a diode beside its transistor, which leads upwards."""
    leg, x = across
    colour = _LIVE if on else _FAINT
    end = 0.95
    if not on:
        axes.plot([leg, x, x, leg], [y - end, y - end, y + end, y + end], color=_FAINT, linewidth=1.1, zorder=1)
    axes.fill([x - 0.2, x + 0.2, x], [y - 0.2, y - 0.2, y + 0.18], color=colour, zorder=5)
    axes.plot([x - 0.2, x + 0.2], [y + 0.2, y + 0.2], color=colour, linewidth=2.2, zorder=5)
    side = -0.3 if x < leg else 0.3
    axes.text(x + side, y, name, ha="right" if side < 0 else "left", va="center", fontsize=8,
              color=_LIVE if on else _SOFT)  # fmt: skip
