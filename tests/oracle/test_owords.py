"""Expressions, parameters, O-words and acting comments against LinuxCNC's stand-alone interpreter, by grammar."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

pytestmark = pytest.mark.oracle

MANY = settings(max_examples=2 * settings().max_examples)

# --- expressions

LITERAL = st.sampled_from(["0", "1", "2", "3.5", ".25", "-1", "-2.5", "10", "+4", "100.", "0.0001", "45", "--7"])
NAMED = st.sampled_from(["#1", "#2", "#3", "##2", "#[1+1]", "#<a>", "#<_g>", "#<A b>", "#<_x>", "#<_metric>", "#5420",
                         "#<_plane>", "#<_motion_mode>", "#<_feed>", "#<unset>"])  # fmt: skip
OPERATORS = st.sampled_from(["+", "-", "*", "/", "**", " mod ", " eq ", "NE", " gt ", " ge ", " lt ", " LE ", " and ",
                             " or ", " xor "])  # fmt: skip
# not TAN, which the reference works out at its poles in another precision
FUNCTIONS = st.sampled_from(["abs", "ACOS", "asin", "cos", "exp", "fix", "fup", "ln", "round", "sin", "sqrt"])


def _wider(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    chain = st.lists(st.tuples(OPERATORS, inner), min_size=0, max_size=3)
    bracket = st.builds(lambda first, rest: "[" + first + "".join(op + value for op, value in rest) + "]", inner, chain)
    return st.one_of(
        bracket, bracket,
        st.builds(lambda name, value: f"{name}[{value}]", FUNCTIONS, inner),
        st.builds(lambda up, along: f"atan[{up}]/[{along}]", inner, inner),
        bracket.map(lambda value: "-" + value),
        st.sampled_from(["exists[#<a>]", "exists[#<unset>]", "exists[#<_g>]"]),
    )  # fmt: skip


VALUE = st.recursive(st.one_of(LITERAL, NAMED), _wider, max_leaves=6)
SET_UP = ["#1=2 #2=3 #3=-1.5", "#<a>=4", "#<_g>=.5", "#<ab>=7", "g1 f100 x1 y2"]


@MANY
@given(values=st.lists(VALUE, min_size=1, max_size=8))
def test_expressions_agree(agree, values):
    lines = [f"x{value}"[:250] for value in values]
    agree("\n".join([*SET_UP, *lines, "m2", ""]).encode("latin-1"))


@MANY
@given(text=st.text(st.sampled_from("[]#<>a_12.+-*/= xyexistsmod"), min_size=1, max_size=14))
def test_random_characters_of_expressions_agree(agree, text):
    if "<" in text and ">" not in text.partition("<")[2]:
        return  # the reference reads some names that are not closed
    agree("\n".join([*SET_UP, f"x[{text}]", "m2", ""]).encode("latin-1"))


TARGET = st.sampled_from(["#1", "#2", "#30", "#5000", "#[#1]", "##2", "#<a>", "#<b>", "#<_g>", "#<_new>", "#5420", "#0",
                          "#<_x>", "#5602", "#1.5", "#5399", "#5600"])  # fmt: skip
SETTING = st.builds(lambda target, value: f"{target}={value}", TARGET, st.one_of(LITERAL, NAMED, VALUE))
SHOWN = "(debug,#1 #2 %d#30 %.2f#<a> #<b> %f#<_g> #<_new> #5000)"


@MANY
@given(lines=st.lists(st.lists(SETTING, min_size=1, max_size=3).map(" ".join), min_size=1, max_size=6))
def test_assignments_agree(agree, lines):
    agree("\n".join([*SET_UP, *(text for line in lines for text in (line[:250], SHOWN)), "m2", ""]).encode("latin-1"))


# --- O-words


@st.composite
def body(draw: st.DrawFn, depth: int, labels: list[int], loop: int | None) -> list[str]:
    """Lines of a block: motion, settings, loops that end, branches, calls."""
    lines: list[str] = []
    for _ in range(draw(st.integers(1, 3))):
        kind = draw(st.sampled_from(["move", "set", "show", "if", "while", "repeat", "do", "call", "leave"]))
        labels[0] += 1
        label, counter = labels[0], 1000 + labels[0]
        if kind == "move":
            lines.append(draw(st.sampled_from(["g1 x#1 y[#2+1]", "g0 z#3", "x[#1*2]", "g91 x1", "g90", "g1 x2"])))
        elif kind == "set":
            lines.append(draw(st.sampled_from(["#1=[#1+1]", "#2=[#1*2]", "#3=[#2 mod 3]", "#<a>=[#<a>+1] #1=#<a>"])))
        elif kind == "show" or depth == 0:
            lines.append("(debug,#1 #2 #3 #<a> #<_value> #<_call_level>)")
        elif kind == "if":
            lines += draw(branch(depth - 1, labels, label, loop))
        elif kind in ("while", "do"):
            inner = draw(body(depth - 1, labels, label))
            ahead, back = f"o{label} {kind}", f"o{label} endwhile"
            condition = f" [#{counter} lt {draw(st.integers(0, 3))}]"
            ahead, back = (ahead + condition, back) if kind == "while" else (ahead, f"o{label} while{condition}")
            lines += [f"#{counter}=0", ahead, f"#{counter}=[#{counter}+1]", *inner, back]
        elif kind == "repeat":
            inner = draw(body(depth - 1, labels, None))
            lines += [f"o{label} repeat [{draw(st.integers(0, 3))}]", *inner, f"o{label} endrepeat"]
        elif kind == "call":
            lines.append(draw(st.sampled_from(["o<one> call [#1] [5]", "o<two> call", "m98 p900", "m98 p900 l2"])))
        elif loop is not None:
            lines += [f"o{label} if [#1 gt 2]", f"o{loop} continue", f"o{label} endif"]
    return lines


@st.composite
def branch(draw: st.DrawFn, depth: int, labels: list[int], label: int, loop: int | None) -> list[str]:
    """An IF with what may follow it."""
    lines = [f"o{label} if [{draw(st.sampled_from(['1', '0', '#1 gt 1', '#2 eq 0', '#3 and #1']))}]"]
    lines += draw(body(depth, labels, loop))
    for _ in range(draw(st.integers(0, 2))):
        lines += [f"o{label} elseif [{draw(st.sampled_from(['1', '0', '#1 lt 3']))}]", *draw(body(depth, labels, loop))]
    if draw(st.booleans()):
        lines += [f"o{label} else", *draw(body(depth, labels, loop))]
    return [*lines, f"o{label} endif"]


@st.composite
def program(draw: st.DrawFn) -> list[str]:
    """A program with two subroutines, one before and one behind its end, and one of M98's."""
    one = ["o<one> sub", "#<a>=#1", "g1 x#1 y#2", "o3 if [#1 gt 3]", "o<one> return [#1]", "o3 endif",
           "#3=[#3+1]", "o<one> endsub [#2]"]  # fmt: skip
    two = ["o<two> sub", "(debug,two #1 #<_call_level>)", "o4 repeat [2]", "g0 x#<_call_level>", "o4 endrepeat",
           "o<two> endsub"]  # fmt: skip
    lines = draw(body(2, [10], None))
    return ["f100 g1 x0", "#<a>=0", *one, *lines, "m2", *two, "o900", "#2=[#2+1]", "g0 y#2", "m99"]


@MANY
@given(lines=program())
def test_programs_with_o_words_agree(agree, lines):
    agree("\n".join([*lines, ""]).encode("latin-1"))


WILD = st.builds(
    lambda label, word, rest: f"o{label} {word}{rest}",
    st.sampled_from(["1", "1", "2", "<a>", "#1", "[1+1]"]),
    st.sampled_from(["sub", "endsub", "call", "return", "do", "while", "endwhile", "repeat", "endrepeat", "if",
                     "elseif", "else", "endif", "continue", "", "loop"]),
    st.sampled_from(["", "", "[0]", "[0]", "[1]", " [#2 lt 0]", " [1/0]", "[1] [2]", "(remark)"]),
)  # fmt: skip
PLAIN = st.sampled_from(["g0 x1", "(debug,#1)", "#2=[#2+1]", "m98 p1", "m99", "m2"])


# ELSE with a value behind it is taken by the reference, and a repeat left by RETURN begins where it was
@MANY
@given(lines=st.lists(st.one_of(WILD, WILD, PLAIN), min_size=1, max_size=6))
def test_wild_o_words_agree(agree, lines):
    text = "\n".join(["#1=1", *lines, "m2", ""])
    if "else[" in text or "else [" in text or _may_not_end(lines):
        return
    agree(text.encode("latin-1"))


def _may_not_end(lines: list[str]) -> bool:
    """Return whether a loop may run for ever."""
    return any(f"{word}{true}" in line for line in lines for word in ("while", "repeat")
               for true in ("[1]", "[1] [2]"))  # fmt: skip
