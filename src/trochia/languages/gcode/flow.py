"""Where a program goes on: what O-words, M98 and M99 do.

In: one control line after another, as the walk comes to it.  Out: a cursor that has been moved, or lines that are
passed over until the one that is looked for.

The reference walks a text, it does not build a tree: a branch that is not taken is passed over line by line until its
label comes again, and a label means what its first line made of it.  So does this, because only then do programs whose
labels overlap run alike.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from trochia.errors import ModalConflictError, ParseError, ProgramError
from trochia.languages.gcode.computed import Computed
from trochia.languages.gcode.numbers import as_integer
from trochia.languages.gcode.owords import BARE, GLOBAL, UNKNOWN, Control

if TYPE_CHECKING:
    from collections.abc import Callable

    from trochia.languages.gcode.parameters import Frame, Parameters
    from trochia.languages.gcode.place import Place
    from trochia.languages.gcode.texts import Cursor, Mark, Texts

DEEPEST = 9  #: calls within calls


@dataclass(slots=True)
class Label:
    """What the first line with a label made of it; ``left`` counts the rounds of a repeat, -1 before the first."""

    word: str
    mark: Mark
    left: int = -1


@dataclass(slots=True)
class _Call:
    """What a return needs."""

    word: str
    name: str
    frame: Frame
    mark: Mark
    sub: str | None
    left: int


class Flow:
    """The control state of one run.

    Attributes
    ----------
    skipping
        The label that ends what is passed over; None: lines act.
    since
        Where passing over began.
    turning
        The label of the loop or subroutine that was jumped to last.
    line
        Number of the line that runs, in its own text.
    value, returned
        What the last subroutine returned, and 1 where it returned something.
    ended
        M99 stood in the main program: it ends.
    """

    def __init__(self, parameters: Parameters, cursor: Cursor, texts: Texts) -> None:
        self.skipping: str | None = None
        self.since: Control | None = None
        self.turning: Label | None = None
        self.ended = False
        self.line = 1
        self.calls: list[_Call] = []
        self.on_call: Callable[[], None] = _nothing
        self.on_return: Callable[[Place], None] = _nothing_at
        self.labels: dict[str, Label] = {}
        self._parameters = parameters
        self._cursor = cursor
        self._texts = texts
        self._to_sub = False
        self._defining = False
        self._sub: str | None = None
        self._taken = False  # a branch of the innermost IF has been executed
        self._continuing = self._breaking = False
        self.value, self.returned = 0.0, 0.0
        self._acts: dict[str, Callable[[Control, str, Mark], None]] = {
            "sub": self._begin_sub, BARE: self._begin_sub, "endsub": self._return, "return": self._return,
            "m99": self._return, "call": self._call, "m98": self._call_program, "do": self._do,
            "while": self._while, "endwhile": self._end_loop, "repeat": self._repeat, "endrepeat": self._end_loop,
            "if": self._if, "elseif": self._elseif, "else": self._else, "endif": self._endif,
            "break": self._break, "continue": self._continue,
        }  # fmt: skip
        parameters.predefined.offer(_BY_NAME, self)

    def act(self, control: Control, mark: Mark) -> None:
        """Let a control line act; ``mark`` is where it stands, and the cursor behind it."""
        name = control.name()
        word = control.word
        if self._sub is not None and word not in GLOBAL:
            name = f"{self._sub}#{name}"
        if word == UNKNOWN:
            if self._defining:
                return
            raise control.not_known()
        if word in ("sub", BARE) and self._defining:
            raise control.fault(ModalConflictError, "a subroutine begins inside another one",
                                hint=f"O{self._sub} has no ENDSUB before this line.")  # fmt: skip
        if self.skipping is not None and (name != self.skipping or word == "call"):
            return
        if self._to_sub and word not in ("sub", BARE):
            return
        self._acts[word](control, name, mark)

    # --- subroutines

    def _begin_sub(self, control: Control, name: str, mark: Mark) -> None:
        control.numbers(self._parameters)
        if self.calls:
            self._check_style(control)
        if self.skipping is not None:
            self._define(control, name, mark)
            self.skipping = None
        self._to_sub = False
        if control.word == BARE or self.calls:
            return
        self._define(control, name, mark)
        self._skip(name, control)
        self._defining = True
        self._sub = name

    def _check_style(self, control: Control) -> None:
        """Refuse M98 to a SUB, and CALL to a bare label."""
        by_m98 = self.calls[-1].word == "m98"
        if control.word == BARE and not by_m98:
            raise control.fault(ModalConflictError, "a program that begins with a label alone is called by M98",
                                hint="Write SUB behind the label, or call it by M98.")  # fmt: skip
        if control.word == "sub" and by_m98:
            raise control.fault(ModalConflictError, "M98 cannot call a SUB", hint="Call it by O-word CALL.")

    def _define(self, control: Control, name: str, mark: Mark) -> None:
        known = self.labels.get(name)
        if known is not None:
            raise control.fault(ModalConflictError, f"O{name} is already defined in line {known.mark.line}",
                                hint="A label may be defined once; a subroutine stands before the first call, "
                                     "or behind the end of the program.")  # fmt: skip
        self.labels[name] = Label(control.word, mark)

    def _call(self, control: Control, name: str, mark: Mark) -> None:
        del mark
        self._enter(control, name, control.numbers(self._parameters), left=1)

    def call(self, name: str, place: Place, at: int) -> None:
        """Call a subroutine without arguments, as a line of motion asks; ``at`` is where its number stands."""
        self._enter(Control("call", name, place, at), name, [], left=1)

    def _call_program(self, control: Control, name: str, mark: Mark) -> None:
        del mark
        times = 1 if control.times is None else as_integer(control.guarded(control.times))
        if times is None or times < 0:
            raise control.fault(ParseError, "L must be a whole number, 0 or more", hint="L counts calls, like L3.")
        if times > 0:
            self._enter(control, name, None, left=times)

    def _enter(self, control: Control, name: str, arguments: list[float] | None, *, left: int) -> None:
        if len(self.calls) == DEEPEST:
            raise control.fault(ModalConflictError, f"more than {DEEPEST} calls in each other",
                                hint="Does the subroutine call itself without end?")  # fmt: skip
        self.skipping = None
        frame = self._parameters.enter(arguments)
        self.calls.append(_Call(control.word, name, frame, self._cursor.mark(), self._sub, left))
        self.on_call()
        self._sub = name
        self._go_to(name, control)

    def _go_to(self, name: str, control: Control) -> None:
        """Go to a label, to the file of that name, or on to where it may be defined further down."""
        label = self.labels.get(name.rpartition("/")[2])
        if label is not None:
            self.turning = label
            self._cursor.go(label.mark)
            return
        found = self._texts.find(name)
        if found is not None:
            self._cursor.go(found)
        self._skip(name.rpartition("/")[2], control)
        self._to_sub = True

    def _return(self, control: Control, name: str, mark: Mark) -> None:
        del name, mark
        values = control.numbers(self._parameters)
        if not self.calls:
            self._end_definition(control, values)
            return
        call = self.calls[-1]
        if (call.word == "m98") != (control.word == "m99"):
            right = "M99" if call.word == "m98" else "ENDSUB or RETURN"
            raise control.fault(ModalConflictError, f"what {call.word.upper()} called ends with {right}",
                                hint="CALL and ENDSUB go together, and M98 and M99.")  # fmt: skip
        self.value, self.returned = (values[0], 1.0) if values else (0.0, 0.0)
        self.skipping = None
        if call.left > 1:
            call.left -= 1
            self._go_to(call.name, control)
            return
        self.calls.pop()
        self._parameters.leave(call.frame)
        self._cursor.go(call.mark)
        self._sub = call.sub
        self.on_return(control.place)

    def _end_definition(self, control: Control, values: list[float]) -> None:
        if control.word == "m99":
            self.ended = True
        elif self._sub is None or (control.word == "endsub" and not self._defining):
            raise control.fault(ModalConflictError, f"{control.word.upper()} stands in no subroutine",
                                hint="It needs a SUB of the same label before it.")  # fmt: skip
        elif control.word == "endsub":
            self.value, self.returned = (values[0], 1.0) if values else (0.0, 0.0)
            self.skipping = None
            self._defining = False
            self._sub = None

    # --- loops

    def _do(self, control: Control, name: str, mark: Mark) -> None:
        control.numbers(self._parameters)
        self.skipping = None
        self.labels.setdefault(name, Label("do", mark))

    def _while(self, control: Control, name: str, mark: Mark) -> None:
        label = self.labels.get(name)
        if label is None or label.word != "do":
            self._while_do(control, name, mark)
            return
        wanted = control.number(self._parameters)
        self.skipping = None
        self._continuing = False
        if wanted and not self._breaking:
            self.turning = label
            self._cursor.go(label.mark)
        self._breaking = False

    def _while_do(self, control: Control, name: str, mark: Mark) -> None:
        wanted = control.number(self._parameters)
        self._own(control, name, mark)
        if wanted:
            self.skipping = None
        else:
            self._skip(name, control)

    def _repeat(self, control: Control, name: str, mark: Mark) -> None:
        count = control.number(self._parameters)
        label = self._own(control, name, mark)
        self.skipping = None
        if label.left == -1:
            label.left = round(count)
        if label.left > 0:
            label.left -= 1
        else:
            label.left = -1
            self._skip(name, control)

    def _own(self, control: Control, name: str, mark: Mark) -> Label:
        """Return the label of this line; another line's is an error."""
        label = self.labels.get(name)
        if label is None:
            label = self.labels[name] = Label(control.word, mark)
        elif label.mark.line != mark.line:
            raise control.fault(ModalConflictError, f"this label is already used in line {label.mark.line}",
                                hint="Give each loop and branch a label of its own.")  # fmt: skip
        return label

    def _end_loop(self, control: Control, name: str, mark: Mark) -> None:
        del mark
        control.numbers(self._parameters)
        label = self._opened(control, name, control.word[3:])
        if self.skipping is not None:
            self.skipping = None
            if not self._continuing:
                self._breaking = False
                return
            self._continuing = False
        self.turning = label
        self._cursor.go(label.mark)

    def _break(self, control: Control, name: str, mark: Mark) -> None:
        del mark
        control.numbers(self._parameters)
        self._opened(control, name, "while", "do")
        self._skip(name, control)
        self._breaking = True

    def _continue(self, control: Control, name: str, mark: Mark) -> None:
        del mark
        control.numbers(self._parameters)
        self._opened(control, name, "while", "do")
        if self.skipping is None:
            self._skip(name, control)
            self._continuing = True

    # --- branches

    def _if(self, control: Control, name: str, mark: Mark) -> None:
        self._own(control, name, mark)
        self._branch(control, name, control.number(self._parameters))

    def _elseif(self, control: Control, name: str, mark: Mark) -> None:
        del mark
        self._opened(control, name, "if")
        wanted = control.number(self._parameters)
        if self._taken:
            self._skip(name, control)
        else:
            self._branch(control, name, wanted)

    def _else(self, control: Control, name: str, mark: Mark) -> None:
        del mark
        control.numbers(self._parameters)
        self._opened(control, name, "if")
        self._branch(control, name, 0.0 if self._taken else 1.0)

    def _branch(self, control: Control, name: str, wanted: float) -> None:
        if wanted:
            self.skipping = None
            self._taken = True
        else:
            self._skip(name, control)
            self._taken = self._taken and control.word != "if"

    def _endif(self, control: Control, name: str, mark: Mark) -> None:
        del mark
        control.numbers(self._parameters)
        self._opened(control, name, "if")
        self.skipping = None
        self._taken = True

    def _opened(self, control: Control, name: str, *words: str) -> Label:
        """Return the label, which one of these words must have opened."""
        label = self.labels.get(name)
        if label is not None and label.word in words:
            return label
        wanted = " or ".join(word.upper() for word in words)
        if label is None:
            raise control.fault(ModalConflictError, f"{control.word.upper()} has no {wanted} before it",
                                hint="Both need the same label.")  # fmt: skip
        opened = f"{label.word.upper() or 'a label'} in line {label.mark.line}"
        raise control.fault(ModalConflictError,
                            f"{control.word.upper()} belongs to {wanted}, but its label to {opened}",
                            hint="Give each loop and branch a label of its own.")  # fmt: skip

    # --- passing over

    def _skip(self, name: str, control: Control) -> None:
        self.skipping = name
        self.since = control

    def unended(self) -> ProgramError | None:
        """Return the error of a text that ended while something was looked for."""
        since = self.since
        if self.skipping is None or since is None:
            return None
        if self._to_sub:
            return since.fault(ModalConflictError, f"there is no subroutine O{self.skipping}",
                               hint=self._texts.where(self.skipping))  # fmt: skip
        return since.fault(ModalConflictError, f"{since.word.upper()} has no end",
                           hint=f"Below it no line ends O{self.skipping.rpartition('#')[2]}.")  # fmt: skip


_BY_NAME: dict[str, Callable[[Flow], Computed]] = {
    "_value": lambda flow: Computed(lambda: flow.value),
    "_value_returned": lambda flow: Computed(lambda: flow.returned),
    "_line": lambda flow: Computed(lambda: float(flow.line)),
    "_call_level": lambda flow: Computed(lambda: float(len(flow.calls))),
}


def _nothing() -> None:
    """Do nothing."""


def _nothing_at(place: Place) -> None:
    """Do nothing."""
    del place
