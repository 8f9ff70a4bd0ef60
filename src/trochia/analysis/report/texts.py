"""Numbers as a reader wants them: durations in words, lengths with as many digits as matter."""

from __future__ import annotations


def duration(seconds: float) -> str:
    """Return ``seconds`` [s] as ``"4.213 s"``, ``"1 min 23.4 s"`` or ``"2 h 05 min 09 s"``."""
    if round(seconds, 3) < 10:
        return f"{seconds:.3f} s"
    if round(seconds, 1) < 60:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds * 10), 600)
    if minutes < 60:
        return f"{minutes} min {rest / 10:04.1f} s"
    hours, minutes, whole = round(seconds) // 3600, round(seconds) // 60 % 60, round(seconds) % 60
    return f"{hours} h {minutes:02} min {whole:02} s"


def number(value: float, digits: int = 3) -> str:
    """Return ``value`` with thousands marked, at most ``digits`` decimals, and a true minus sign; never "-0"."""
    rounded = round(value, digits) + 0.0
    text = f"{rounded:,.{digits}f}"
    if "." in text:
        text = text.rstrip("0").removesuffix(".")
    return text.replace("-", "−")  # noqa: RUF001 - typography: the minus of tables


def count(amount: int, noun: str) -> str:
    """Return ``"1 warning"``, ``"2 warnings"``."""
    return f"{amount:,} {noun}" + ("" if amount == 1 else "s")


def percent(fraction: float) -> str:
    """Return a share of one as ``"43 %"``, with a decimal below ten percent."""
    value = fraction * 100
    return f"{value:.1f} %" if 0 < round(value, 1) < 10 else f"{value:.0f} %"
