"""The walk over a program's lines: which one is next, and who takes it.

In: a text, the state and a sink.  Out: every line executed in its turn.  Plain lines go to the C core; the others are
read once, and those of loops and subroutines are kept, so that they are not read again.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from trochia.errors import ParseError, ProgramError
from trochia.languages.gcode.block import Block, sort_words
from trochia.languages.gcode.check import check
from trochia.languages.gcode.cycles.turning import finish
from trochia.languages.gcode.execution import execute, pretend_done
from trochia.languages.gcode.fast import FastPath
from trochia.languages.gcode.flow import Flow
from trochia.languages.gcode.groups import saved_modes
from trochia.languages.gcode.groups.compensation import sink_of
from trochia.languages.gcode.place import Place
from trochia.languages.gcode.reader import check_comments, read_template
from trochia.languages.gcode.straight import straight_of
from trochia.languages.gcode.texts import Cursor, Mark, next_line

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from trochia.languages.gcode.cycles.profile import Profile
    from trochia.languages.gcode.sink import Sink
    from trochia.languages.gcode.state import State
    from trochia.languages.gcode.template import Template
    from trochia.languages.gcode.texts import Text, Texts

    OnError = Callable[[ProgramError], None]

HOW_TO_END = "The program must end with M2 or M30, or with a line % if it begins with one."
_MOST_PATIENCE = 16  # lines the fast path is not tried after it was in vain
_MOST_AT_ONCE = 1000  # lines of a loop before the walk pauses
_WORTH = 4  # plain lines in a row, in a loop, that pay the way to C and back
_CONTROL = re.compile(rb"[ \t\r]*(?:/[ \t\r]*)?(?:[nN][ \t\r0-9.]*)?[oO]")


class Walk:
    """One run of a program."""

    def __init__(
        self,
        text: Text,
        state: State,
        sink: Sink,
        *,
        axes: str,
        texts: Texts,
        fast: bool,
        block_delete: bool,
        in_percent: bool,
        most_lines: int,
        on_error: OnError | None,
    ) -> None:
        self._main = text
        self._cursor = Cursor(text)
        self._state = state
        self._sink = sink
        self._axes = axes
        self._block_delete = block_delete
        self._in_percent = in_percent
        self._opened = not in_percent
        self._closed = False
        self._most_lines = self._left = most_lines
        self._on_error = on_error
        self._reported: set[tuple[str, int]] = set()
        self._shown = 1  # line of the main program
        self._fast: dict[str, FastPath] | None = {} if fast else None
        self._wait = self._patience = 0  # after k tries in vain the fast path is next tried k lines later
        self._flow = Flow(state.parameters, self._cursor, texts)
        self._flow.on_call = self._enter
        self._flow.on_return = self._leave

    def lines(self) -> Iterator[int]:
        """Run the program; yield the number of the last line done, in the main text, again and again."""
        cursor = self._cursor
        while cursor.offset < len(cursor.text.data):
            if cursor.offset in cursor.text.templates:
                ended = self._laps()
                yield self._shown
                if ended:
                    return
                continue
            if self._fast is not None and self._take_plain(self._fast):
                yield self._shown
                continue
            if self._step():
                yield self._shown
                return
            yield self._shown
        self._unended()

    # --- plain lines

    def _take_plain(self, readers: dict[str, FastPath]) -> bool:
        """Let the C core take plain lines; return whether it took one."""
        cursor, looping = self._cursor, self._flow.turning is not None
        text, offset, line = cursor.mark()
        if self._flow.skipping is not None or not self._opened or self._state.profile is not None:
            return False
        if self._wait and not looping:
            self._wait -= 1
            return False
        fast = readers.get(text.name)
        if fast is None:
            fast = readers[text.name] = FastPath(text, self._axes, compensated=self._on_error is None)
        cursor.offset, cursor.line = fast.advance(self._state, self._sink, offset, line)
        taken = cursor.line - line
        self._patience = 0 if taken else min(self._patience + 1, _MOST_PATIENCE)
        self._wait = max(self._patience - 1, 0)
        if text.main and taken:
            self._shown = cursor.line - 1
        if looping and taken < _WORTH:
            self._keep(Mark(text, offset, line), taken)
        return taken > 0

    def _keep(self, mark: Mark, count: int) -> None:
        """Read lines that are too few for the C core, so that the next round takes them here."""
        text, offset, line = mark
        for number in range(line, line + count):
            raw, after = next_line(text.data, offset)
            template = read_template(Place(text.name, number, raw), self._state.parameters)
            self._remember(template, Mark(text, offset, number), after)
            offset = after

    # --- other lines

    def _remember(self, template: Template, mark: Mark, after: int) -> None:
        """Keep a line that may run again."""
        template.straight = straight_of(template, self._axes)
        if template.setting is not None and not self._state.parameters.is_plain(template.setting[0]):
            template.setting = None
        mark.text.templates[mark.offset] = template, after, mark

    def _laps(self) -> bool:
        """Take lines that have been read before, while they set a parameter, move straight or lead somewhere else.

        Return whether the program has ended.
        """
        cursor, flow = self._cursor, self._flow
        parameters = self._state.parameters
        for _ in range(_MOST_AT_ONCE):
            known = cursor.text.templates.get(cursor.offset)
            if known is None:
                return False
            template, after, mark = known
            cursor.offset, cursor.line = after, mark.line + 1
            setting = template.setting
            if setting is not None and flow.skipping is None and self._left > 0:
                self._left -= 1
                flow.line = mark.line
                try:
                    template.set(setting, parameters)
                except ProgramError as error:
                    self._hand_over(error)
            elif self._run(template, mark):
                return True
            elif template.control is None and template.straight is None:
                return False
        return False

    def _step(self) -> bool:
        """Take the next line; return whether the program has ended."""
        cursor = self._cursor
        text, offset, line = mark = cursor.mark()
        cursor.line = line + 1
        raw, cursor.offset = next_line(text.data, offset)
        if text.main:
            if self._in_percent and raw.strip() == b"%":
                return self._percent()
            if not self._opened:
                return False
        if self._block_delete and raw.lstrip()[:1] == b"/":
            return False
        return self._read_and_run(Place(text.name, line, raw), mark)

    def _percent(self) -> bool:
        if self._opened:
            self._closed = True
            sink_of(self._state, self._sink).finish()
            error = self._flow.unended()
            if error is not None:
                self._hand_over(error)
            return True
        self._opened = True
        return False

    def _read_and_run(self, place: Place, mark: Mark) -> bool:
        """Read a line and run it, unless it is passed over."""
        try:
            if self._flow.skipping is not None and not _CONTROL.match(place.raw):
                check_comments(place)
                return False
            template = read_template(place, self._state.parameters)
        except ProgramError as error:
            self._hand_over(error)
            return False
        if self._flow.turning is not None or self._flow.calls:
            self._remember(template, mark, self._cursor.offset)
        return self._run(template, mark)

    def _run(self, template: Template, mark: Mark) -> bool:
        """Run a line; return whether it ends the program."""
        flow = self._flow
        control = template.control
        if control is None and flow.skipping is not None:
            return False
        if mark.text.main:
            self._shown = mark.line
        self._sink.line = self._shown
        flow.line = mark.line
        self._left -= 1
        try:
            if self._left < 0:
                raise self._endless(template.place)
            if control is None:
                self._act(template)
            else:
                flow.act(control, mark)
        except ProgramError as error:
            self._hand_over(error)
            return control is not None or self._left < 0
        if flow.ended:
            return self._end_by_return(template.place)
        if self._state.ended:
            self._look_for_percent()
            return True
        return False

    def _act(self, template: Template) -> None:
        """Run the words of a line."""
        state = self._state
        if template.set_only(state.parameters):
            return
        if state.profile is not None:
            self._draw(template, state.profile)
            return
        if state.compensation is not None:
            state.compensation.line = self._shown
        if template.straight is not None and template.straight.run(state, self._sink):
            return
        block: Block | None = None
        try:
            block = sort_words(template.fill(state.parameters), self._axes)
            check(block, state)
            execute(block, state, self._sink)
        except ProgramError:
            if self._on_error is not None:
                pretend_done(block, state)
            raise
        if state.profile is not None:
            self._call_profile(state.profile)

    def _end_by_return(self, place: Place) -> bool:
        """End the program by an M99 of the main program, which acts as M2."""
        self._act(read_template(Place(place.file, place.line, b"m2"), self._state.parameters))
        self._look_for_percent()
        return True

    # --- calls and errors

    def _enter(self) -> None:
        saved_modes.enter(self._state)

    def _leave(self, place: Place) -> None:
        state = self._state
        saved_modes.leave(state, self._sink, place)
        profile = state.profile
        if profile is not None and len(self._flow.calls) < profile.depth:
            state.profile = None
            self._sink.line = profile.line
            finish(profile, Block(place, None), state, self._sink)

    def _call_profile(self, profile: Profile) -> None:
        """Run the subroutine that draws a lathe cycle's profile."""
        self._state.motion = 10
        try:
            self._flow.call(str(profile.sub), profile.block.place, profile.block.where["q"])
        except ProgramError:
            self._state.profile = None
            raise
        profile.depth = len(self._flow.calls)

    def _draw(self, template: Template, profile: Profile) -> None:
        """Let a line of such a subroutine draw."""
        block = sort_words(template.fill(self._state.parameters), self._axes + "uw")
        check(block, self._state)
        profile.take(block, self._state)

    def _hand_over(self, error: ProgramError) -> None:
        """Raise an error, or report it once."""
        if self._on_error is None:
            raise error
        source = error.source
        key = (source.file, source.line) if source is not None else ("", 0)
        if key not in self._reported:
            self._reported.add(key)
            self._on_error(error)

    def _endless(self, place: Place) -> ProgramError:
        """Return the error of a program that does not come to its end, at the loop it is in."""
        turning = self._flow.turning
        if turning is None:
            return place.fault(ProgramError, f"more than {self._most_lines} lines were executed",
                               hint="Allow more by --max-lines.")  # fmt: skip
        text, offset, line = turning.mark
        raw, _ = next_line(text.data, offset)
        return Place(text.name, line, raw).fault(
            ProgramError, f"more than {self._most_lines} lines were executed, the last ones by this "
            f"{turning.word.upper() or 'program'}", 0, hint="Does it ever end?  If so, allow more by --max-lines.",
        )  # fmt: skip

    def _look_for_percent(self) -> None:
        """Remark on a program that begins with ``%`` and has none after its end."""
        cursor = self._cursor
        rest = self._main.data[cursor.offset :] if cursor.text.main else b""
        if self._in_percent and not any(line.strip() == b"%" for line in rest.split(b"\n")):
            self._sink.comment("interpreter: percent sign missing from end of file")

    def _unended(self) -> None:
        """Refuse a text that stops without an end."""
        error = self._flow.unended()
        text = self._cursor.text
        if error is None:
            what = "no closing %" if self._in_percent and text.main else "no M2, M30 or %"
            if not text.main:
                what = "no ENDSUB or M99"
            last = text.data[:].rstrip(b"\n").rpartition(b"\n")[2]
            error = Place(text.name, self._cursor.line - 1, last).fault(
                ParseError, f"the program has {what} at its end", hint=HOW_TO_END
            )
        self._hand_over(error)
