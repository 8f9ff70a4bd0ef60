"""Canonical output against LinuxCNC's stand-alone interpreter: by hand, by the golden cases, and by grammar."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from trochia.program import WorkState

pytestmark = pytest.mark.oracle

MANY = settings(max_examples=2 * settings().max_examples)

HERE = Path(__file__).parent
SNIPPETS = [
    line
    for line in (HERE / "snippets.txt").read_text(encoding="utf-8").split("\n")
    if line and not line.startswith("#")
]
work_of = runpy.run_path(str(HERE.parent / "golden" / "rewrite.py"))["work_of"]
GOLDEN = sorted(path.parent for path in (HERE.parent / "golden").glob("*/program.ngc"))
SAMPLES = sorted((HERE.parents[1] / "programs").glob("*.ngc"))

# Programs the reference takes although they are at fault, or the other way round, each with its reason.
DIFFERENCES = {
    "error-arc-radius-beyond-numbers": "the reference prints a centre of two hundred digits",
    "error-arc-too-many-turns": "the reference has no bound",
    "error-cycle-too-many-pecks": "the reference has no bound",
    "error-cycle-too-many-repeats": "the reference has no bound",
    "error-expression-too-deep": "the reference takes as many brackets as a line has room for, 127",
    "error-g10-no-table": "without a tool table the reference writes to the sample one it has",
    "error-lathe-tool-arc-entry": "the reference cuts straight to the arc's end, then a whole turn",
    "error-lathe-tool-orientation": "the reference takes an orientation 10, which is none",
    "error-log-elsewhere": "the reference opens a log anywhere",
    "error-turning-narrow": "the reference dies of a D that a groove has no room for",
    "error-turning-too-many-passes": "the reference has no bound",
    "error-thread-cycle-too-many-passes": "the reference has no bound, and is not ready in a minute",
    "error-turning-with-stop": "the reference forgets the stop",
    "error-turning-y": "the reference does not look at Y",
    "error-profile-other-code": "the reference takes the axis words of any code for a line",
    "error-profile-arc-radii-differ": "refused whole; the reference cuts up to the arc first",
    "error-thread-cycle-slide-too-steep": "a slide at 90 degrees sends the reference to the end of the world",
    "error-binary": "the reference reads a line up to its NUL byte; a binary file is refused whole",
    "branches": "after a BREAK out of a WHILE the reference leaves the next DO loop after its first round",
    "error-python-in-comment": "the reference runs it",
    "user-codes": "the reference alone has no codes of the machine's own",
    "error-compensation-no-table": "without a tool table the reference knows tools 1 to 3; here D is asked for",
    "tools": "without a tool table the reference knows tools 1 to 3 only; here every tool can be called",
}


@pytest.mark.parametrize("snippet", SNIPPETS)
def test_snippets_agree(agree, snippet):
    lines = snippet.split(" | ")
    agree("\n".join([*lines, "m2", ""]).encode("latin-1"))


@pytest.mark.parametrize("case", GOLDEN, ids=lambda case: case.name)
def test_golden_programs_agree(agree, case):
    if case.name in DIFFERENCES:
        pytest.skip(DIFFERENCES[case.name])
    extra = {name: case / file for name, file in (("variables", "params.var"), ("tools", "tool.tbl"))}
    files = {name: path.read_text() for name, path in extra.items() if path.exists()}
    agree((case / "program.ngc").read_bytes(), work=work_of(case), **files)


@pytest.mark.parametrize("path", SAMPLES, ids=lambda path: path.name)
def test_sample_programs_agree(agree, path):
    agree(path.read_bytes())


# --- by grammar


def _number(low: float, high: float, step: float) -> st.SearchStrategy[str]:
    steps = st.integers(round(low / step), round(high / step))
    forms = st.sampled_from(["{:.3f}", "{:.1f}", "{:g}", "{:+.2f}", "{:.4f}"])
    return st.builds(lambda count, form: form.format(count * step), steps, forms)


NUMBER = _number(-20, 20, 0.5)
AXES = st.lists(
    st.tuples(st.sampled_from("xyzxyzabc"), NUMBER), min_size=1, max_size=4, unique_by=lambda word: word[0]
).map(lambda words: " ".join(letter + value for letter, value in words))


def _line(*parts: st.SearchStrategy[str] | str) -> st.SearchStrategy[str]:
    return st.tuples(*(st.just(part) if isinstance(part, str) else part for part in parts)).map(" ".join)


def _of(*texts: str) -> st.SearchStrategy[str]:
    return st.sampled_from(texts)


FEED = _number(0.5, 900, 0.5).map("f{}".format)
MAYBE_FEED = st.one_of(st.just(""), st.just(""), FEED)
STRAIGHT = _line(_of("g0", "g1", "g01", "", "G1", "G 00"), AXES, MAYBE_FEED)
TURNS = _of("", "", "", "p1", "p2", "p3")
RADIUS = _number(12, 60, 0.5)
ARC_BY_RADIUS = _line(
    _of("g91 g2", "g91 g3", "g91 g17 g2"), _number(0.5, 8, 0.5).map("x{}".format),
    _number(-8, 8, 0.5).map("y{}".format), _of("r", "r-"), RADIUS, TURNS,
).map(lambda text: text.replace("r ", "r").replace("r- ", "r-"))  # fmt: skip


@st.composite
def arc_by_centre(draw: st.DrawFn) -> str:
    """A whole, half or quarter turn, incremental, in any plane, perhaps with a climb."""
    code, first, second, i, j, climb = draw(_of("g17 x y i j z", "g18 z x k i y", "g19 y z j k x")).split()
    centre = draw(st.tuples(st.integers(1, 9), st.integers(-9, 9)))
    across, up = draw(
        st.sampled_from([(0, 0), (2 * centre[0], 2 * centre[1]), (centre[0] - centre[1], centre[1] + centre[0]),
                         (centre[0] + centre[1], centre[1] - centre[0])])
    )  # fmt: skip
    words = [f"{first}{across}", f"{second}{up}", f"{i}{centre[0]}", f"{j}{centre[1]}"]
    if draw(st.booleans()):
        words.append(f"{climb}{draw(NUMBER)}")
    return " ".join(["g91 g91.1", code, draw(_of("g2", "g3")), *draw(st.permutations(words)), draw(TURNS)])


MODES = _of(
    "g17", "g18", "g19", "g20", "g21", "g90", "g91", "g90.1", "g91.1", "g94 f120", "g94", "g95 f.2", "g93", "g54",
    "g55", "g59.3", "g56 g20", "g61", "g61.1", "g64", "g64 p.1", "g64 p0.01 q.02", "g64 q1", "g80", "g40", "g49",
    "g97 s9", "g98", "g17 g21 g40 g49 g80 g90 g94", "g90 g54 f300", "s1200", "s.5 m3", "m4", "m5", "m3", "m7", "m8",
    "m9", "m8 m3", "t1", "t2 m6", "m6", "m0", "m1", "g4 p.25", "m5 g4 p1",
)  # fmt: skip
OFFSETS = st.one_of(
    _line("g92", AXES), _of("g92.1", "g92.2", "g92.3"), _of("g28", "g30", "g28.1", "g30.1"), _line("g28", AXES),
    _line("g30", AXES), _line("g90 g53 g0", AXES), _line("g90 g53 g1", FEED, AXES), _line("g92.2 g0", AXES),
)  # fmt: skip
TEXTS = _of("(a comment)", "; nothing", "(MSG, look)", "( two ) (words)", "", "  ", "n100", "/g0 x1", "N7 g1 y2 f50")
WILD = st.lists(
    st.one_of(
        AXES, _of("g0", "g1", "g2", "g3", "g4", "g28", "g53", "g92", "g80", "g17", "g18", "g20", "g61", "g64",
                  "g90", "g91", "g93", "g95", "m2", "m3", "m5", "m6", "m8", "m30", "t2", "%", "g1.5", "m10"),
        # not Q-1, which the reference takes for no Q at all
        st.tuples(_of(*"ijkrpqfshlde"), NUMBER).map("".join).filter(lambda word: not re.match(r"q-1\.?0*$", word)),
    ), min_size=1, max_size=4,
).map(" ".join)  # fmt: skip
POLAR = st.one_of(
    _line(_of("g90 g17 g0", "g90 g17 g1 f9"), NUMBER.map("@{}".format), NUMBER.map("^{}".format)),
    st.tuples(_of("", "g0 ", "g91 g1 ", "g90 g0 "), _of("@", "^"), NUMBER).map("".join),
)
GOOD = st.one_of(STRAIGHT, STRAIGHT, ARC_BY_RADIUS, arc_by_centre(), MODES, MODES, POLAR, OFFSETS, TEXTS)


@MANY
@given(lines=st.lists(GOOD, min_size=5, max_size=40), last=st.one_of(st.just("m2"), st.just("m30"), WILD))
def test_programs_agree(agree, lines, last):
    agree("\n".join(["g0 x0 y0 f100 s100", *lines, last, "m2", ""]).encode("latin-1"))


@MANY
@given(lines=st.lists(st.one_of(MODES, WILD), min_size=1, max_size=6))
def test_wild_programs_agree(agree, lines):
    agree("\n".join([*lines, "m2", ""]).encode("latin-1"))


# Only characters that make no code or tool the reference has and we do not.
CHARACTERS = st.text(st.sampled_from("gxyzfmnijrp0123.-+ ()/;	e"), min_size=1, max_size=12)


@MANY
@given(text=CHARACTERS)
def test_lines_of_random_characters_agree(agree, text):
    agree(f"g0 x1 f1\n{text}\nm2\n".encode("latin-1"))


OFFSET = st.integers(-40, 40).map(lambda count: count * 2.5)
SIX = st.tuples(*[OFFSET] * 3, *[st.integers(-9, 9)] * 3)
TURN = st.sampled_from([0.0, 0.0, 90.0, 30.0, -45.5])
FIRST = {"g28": 5161, "g30": 5181, "g92": 5211}


def _variables(work: WorkState) -> str:
    """Return a work state as the reference's variable file, whose lengths are inches when it stands alone."""
    rows = dict.fromkeys(range(5161, 5401), 0.0)
    rows[5220] = float(work.active)
    for name, first in FIRST.items():
        rows |= {first + axis: value for axis, value in enumerate(_stored(getattr(work, name)))}
    rows[5210] = float(work.g92_on)
    for system, offsets in enumerate(work.systems):
        rows |= {5221 + 20 * system + axis: value for axis, value in enumerate(_stored(offsets))}
        rows[5230 + 20 * system] = work.rotations[system]
    return "".join(f"{number}\t{value:.15f}\n" for number, value in sorted(rows.items()))


def _stored(offsets: tuple[float, ...]) -> list[float]:
    return [value / 25.4 if axis in (0, 1, 2, 6, 7, 8) else value for axis, value in enumerate(offsets)]


@MANY
@given(
    lines=st.lists(st.one_of(STRAIGHT, ARC_BY_RADIUS, OFFSETS, _of("g54", "g55", "g20", "g21", "g90", "g91")),
                   min_size=1, max_size=12),
    offsets=st.lists(SIX, min_size=6, max_size=6), turns=st.tuples(TURN, TURN), active=st.sampled_from([1, 1, 2]),
)  # fmt: skip
def test_programs_on_a_machine_with_offsets_agree(agree, lines, offsets, turns, active):
    padded = [tuple(float(value) for value in six) + (0.0,) * 3 for six in offsets]
    none = (0.0,) * 9
    work = WorkState(
        systems=(padded[0], padded[1], *[none] * 7), rotations=(*turns, *[0.0] * 7), active=active,
        g28=padded[2], g30=padded[3], g92=padded[4], g92_on=padded[5][0] > 0,
    )  # fmt: skip
    # The stand-alone reference does not turn the point where it starts, so the first line gives the point anew.
    text = "\n".join(["g53 g0 x0 y0 z0 a0 b0 c0 f100 s100", *lines, "m2", ""]).encode("latin-1")
    agree(text, variables=_variables(work), work=work)
