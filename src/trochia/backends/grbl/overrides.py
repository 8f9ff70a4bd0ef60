"""Overrides as GRBL has them: real-time bytes that set 100 % and step from there.  In: fractions.  Out: bytes."""

from __future__ import annotations

LEAST, MOST = 10, 200  #: percent, of feed and spindle
_FEED, _SPINDLE = (0x90, 0x91, 0x92, 0x93, 0x94), (0x99, 0x9A, 0x9B, 0x9C, 0x9D)
_RAPID = ((1.0, 0x95), (0.5, 0x96), (0.25, 0x97))


def codes(*, feed: float, rapid: float, spindle: float) -> bytes:
    """Return the bytes that set overrides; a rapid override is the greatest of 25, 50, 100 % not above it."""
    down = next((code for share, code in _RAPID if rapid >= share), _RAPID[-1][1])
    return _steps(feed, _FEED) + bytes([down]) + _steps(spindle, _SPINDLE)


def stepped(percent: int, code: int) -> int | None:
    """Return a feed or spindle override after a byte [percent]; None where the byte is neither's."""
    for whole, up_ten, down_ten, up, down in (_FEED, _SPINDLE):
        change = {whole: 100 - percent, up_ten: 10, down_ten: -10, up: 1, down: -1}.get(code)
        if change is not None:
            return min(max(percent + change, LEAST), MOST)
    return None


def _steps(value: float, row: tuple[int, int, int, int, int]) -> bytes:
    whole, up_ten, down_ten, up, down = row
    way = min(max(round(100.0 * value), LEAST), MOST) - 100
    tens, ones = divmod(abs(way), 10)
    return bytes([whole, *([up_ten if way > 0 else down_ten] * tens), *([up if way > 0 else down] * ones)])
