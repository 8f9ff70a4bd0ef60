"""Lines of INI-like files to settings: what LinuxCNC and Klipper share.

Keys may repeat, and every line is accounted for: also sections that hold nothing, and other files they ask for.
"""

from __future__ import annotations

import re

from trochia.machine.importers.report import Setting

_SECTION = re.compile(r"\s*\[([^\]]+)\]\s*(?:[#;].*)?$")
#: comments that mean something: LinuxCNC's include, Klipper's own saved settings
_ACTING_COMMENTS = ("#INCLUDE", "#*#")


def settings(text: str, *, separators: str, inline_comments: str = "", continued: str = "") -> list[Setting]:
    """Return the settings in order.

    Parameters
    ----------
    separators
        Characters that may stand between name and value.
    inline_comments
        Characters that begin a comment inside a line; at its start ``#`` and ``;`` always do.
    continued
        ``"indent"``: an indented line goes on with the value above; ``"backslash"``: at its end, with the line below.
    """
    entry = re.compile(
        rf"\s*([^{re.escape(separators)}\s][^{re.escape(separators)}]*?)\s*[{re.escape(separators)}]\s*(.*)$"
    )
    found: list[Setting] = []
    section, opened = "", 0
    for number, line in _logical_lines(text, backslash=continued == "backslash"):
        bare = _without_comment(line, inline_comments)
        header = _SECTION.match(bare)
        if bare.startswith(_ACTING_COMMENTS):
            found.append(Setting(section="", name=bare.strip(), value="", line=number))
        elif not bare.strip() or bare.lstrip()[0] in "#;":
            continue
        elif header:
            _close(found, section, opened)
            section, opened = header.group(1).strip(), number
        elif continued == "indent" and bare[0] in " \t" and found and found[-1].section == section:
            last = found.pop()
            value = f"{last.value}\n{bare.strip()}".strip()
            found.append(Setting(section=section, name=last.name, value=value, line=last.line))
        elif match := entry.match(bare):
            found.append(Setting(section=section, name=match.group(1), value=match.group(2).strip(), line=number))
        else:
            found.append(Setting(section=section, name=bare.strip(), value="", line=number))
    _close(found, section, opened)
    return found


def _close(found: list[Setting], section: str, opened: int) -> None:
    """Account for a section that held nothing, as an include does."""
    if opened and not any(setting.section == section for setting in found):
        found.append(Setting(section=section, name="", value="", line=opened))


def _logical_lines(text: str, *, backslash: bool) -> list[tuple[int, str]]:
    """Return (number, line), with lines ending in a backslash joined where that is the custom."""
    joined: list[tuple[int, str]] = []
    pending = ""
    start = 0
    for number, line in enumerate(text.splitlines(), 1):
        start = start or number
        if backslash and line.endswith("\\"):
            pending += line[:-1]
            continue
        joined.append((start, pending + line))
        pending, start = "", 0
    if pending:
        joined.append((start, pending))
    return joined


def _without_comment(line: str, marks: str) -> str:
    """Return the line up to a comment that stands behind a blank."""
    return re.split(rf"\s[{re.escape(marks)}]", line, maxsplit=1)[0] if marks else line
