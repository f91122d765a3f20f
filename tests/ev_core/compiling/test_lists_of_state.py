"""Parts of a state by other names.

What is not refused means the same with lists of Python as with numbers in a row.

Records of numpy stand for compiled code here: they copy, slice and count as it does, and nothing
has to be compiled.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_core.compiled.lists_of_state import wrong_lists
from ev_core.law import compilable, each_wheel, entry, part, series
from ev_core.parameters.record import fill, memory_type, numbers, working_memory
from ev_msgs_py.compilable import FUNCTIONS


@dataclass(slots=True)
class Tyre:
    slip: float = entry(unit="1")
    window: list[float] = series(3, unit="1")


@dataclass(slots=True)
class S:
    now: list[float] = series(3, unit="1")
    old: list[float] = series(3, unit="1")
    tyre: Tyre = part(Tyre)
    spare: Tyre = part(Tyre)
    tyres: list[Tyre] = each_wheel(Tyre)


HELPERS = """
from typing import NamedTuple
class Pair(NamedTuple):
    one: object
    other: object
@compilable
def picked(w, v):
    return v
@compilable
def first(r):
    return r[0] + r[1]
@compilable
def within(w, function):
    return function(w.window)
"""
RECORDS = st.sampled_from(["s.tyre", "s.spare", "s.tyres[0]", "s.tyres[1]", "w", "v"])
PICKED = st.one_of(
    RECORDS,
    st.builds("picked({}, {})".format, RECORDS, RECORDS),
    st.builds("({} if x > 1.0 else {})".format, RECORDS, RECORDS),
    st.builds("Pair({}, {}).one".format, RECORDS, RECORDS),
    st.builds("({}, {})[1]".format, RECORDS, RECORDS),
)
LISTS = st.one_of(
    st.sampled_from(["s.now", "s.old", "r", "q"]), st.builds("{}.window".format, RECORDS)
)
SLICES = st.builds("{}{}".format, LISTS, st.sampled_from(["[:]", "[:2]", "[1:]"]))
ANY = st.one_of(LISTS, SLICES)
PLACES = st.one_of(
    st.builds("{}[{}]".format, LISTS, st.integers(0, 1)),
    st.builds("{}.slip".format, RECORDS),
    st.builds("{}[{}]".format, SLICES, st.integers(0, 1)),
)
SIMPLE = st.one_of(
    st.builds(
        "{} = {}".format, st.sampled_from(["w", "v", "w = v", "w: Tyre", "v, w"]), PICKED
    ).map(lambda text: text if ", w" not in text[:5] else f"{text}, w"),
    st.builds("{} = {}".format, st.sampled_from(["r", "q", "r = q"]), ANY),
    st.builds("{} = {}".format, RECORDS, PICKED),
    st.builds("{}, {} = {}, {}".format, RECORDS, RECORDS, RECORDS, RECORDS),
    st.builds("{} = {}".format, LISTS, LISTS),
    st.builds("{}[:2] = {}[1:]".format, LISTS, LISTS),
    st.builds("{}[:] = {}[:]".format, LISTS, LISTS),
    st.builds("{}[:1], {}[1:2] = {}[1:2], {}[:1]".format, LISTS, LISTS, LISTS, LISTS),
    st.builds("{}[:], {}[:] = {}, {}".format, LISTS, LISTS, LISTS, LISTS),
    st.builds("{} = x".format, PLACES),
    st.builds("{} += 1.0".format, PLACES),
    st.builds("x = {} + 1.0".format, PLACES),
    st.builds("x = ({} + {})[1]".format, ANY, ANY),
    st.builds("x = float({} == {})".format, SLICES, SLICES),
    st.builds("x = sum({})".format, SLICES),
    st.builds("x = first({})".format, ANY),
    st.builds("x = within({}, first)".format, RECORDS),
    st.builds("x = helped({}, {})".format, RECORDS, ANY),
    st.builds("x = (w := {}).slip".format, RECORDS),
)
HEADS = st.one_of(
    st.sampled_from(
        [
            "for w in s.tyres:",
            "for i, w in enumerate(s.tyres):",
            "for w, v in zip(s.tyres, reversed(s.tyres)):",
        ]
    ),
    st.builds("for x in {}:".format, ANY),
    st.builds("for w in ({}, {}):".format, RECORDS, RECORDS),
    st.just("if x > 2.0:"),
)
BODIES = st.lists(
    st.one_of(
        SIMPLE,
        st.builds(
            lambda head, body: "\n    ".join([head, *body]), HEADS, st.lists(SIMPLE, min_size=1)
        ),
    ),
    min_size=1,
    max_size=6,
)


def function_of(name: str, arguments: str, begin: str, body: list[str]) -> str:
    lines = [line for text in (begin, *body, "return x") for line in text.splitlines()]
    return "\n".join(
        ["@compilable", f"def {name}({arguments}):", *(f"    {line}" for line in lines)]
    )


def of_states(text: str) -> tuple[dict[Any, Any], Any]:
    """Return the findings in a text with a function `law`, and that function."""
    space: dict[str, Any] = {"compilable": compilable, "Tyre": Tyre}
    before = len(FUNCTIONS)
    exec(compile(text, "<text>", "exec"), space)
    trees = {each.name: each for each in ast.parse(text).body if isinstance(each, ast.FunctionDef)}
    found = wrong_lists([space["law"]], S(), lambda function: trees[function.__name__])
    del FUNCTIONS[before:]
    return {each.__name__: what for each, what in found.items() if what}, space["law"]


START = [float(each) for each in range(len(numbers(S())))]


def run_plain(law: Any) -> list[float] | None:
    """The numbers of a state behind a step, with what it gives; None if it raises."""
    state = S()
    fill(state, START)
    try:
        return [float(law(state)), *numbers(state)]
    except (TypeError, ValueError):
        return None


def run_in_a_row(law: Any) -> list[float] | None:
    """The same, of numbers in a row."""
    memory = working_memory(memory_type(S))
    memory.view(np.float64)[:] = START
    try:
        return [float(law(memory[0])), *memory.view(np.float64).tolist()]
    except (TypeError, ValueError):
        return None


@settings(deadline=None, max_examples=400)
@given(own=BODIES, helped=BODIES)
def test_what_is_not_refused_means_the_same(own, helped):
    begin = "x = 0.0\nw, v, r, q = s.tyre, s.spare, s.now, s.old"
    helper = [each for each in helped if "s." not in each and "helped" not in each]
    text = "\n".join(
        [
            HELPERS,
            function_of("helped", "w, r", "x = 0.0\nv, q = w, w.window", helper),
            function_of("law", "s", begin, own),
        ]
    )
    found, law = of_states(text)
    if not found:
        assert run_plain(law) == run_in_a_row(law), text


TWICE = {
    "w = s.tyre\nw.window = s.now": "w.window = s.now may make them one list, numbers are copied by w.window[:]",
    "for i, w in enumerate(s.tyres): w.window = s.now": "w.window = s.now may make them one list, numbers",
    "w = v = s.tyre\nv.window = s.now": "v.window = s.now may make them one list, numbers",
    "w, v = s.tyres[0], s.tyres[1]\nv.window = s.now": "v.window = s.now may make them one list, numbers",
    "v: Tyre = s.tyre\nv.window = s.now": "v.window = s.now may make them one list, numbers",
    "w = s.tyre if x > 1.0 else s.spare\nw.window = s.now": "w.window = s.now may make them one list, numbers",
    "w = picked(x, s.tyre)\nw.window = s.now": "w.window = s.now may make them one list, numbers",
    "old = s.now[:]": "s.now[:] is a list of its own in plain Python, read its numbers one by one",
    "s.now[:2], x = s.now[1:], 2.0": "s.now[1:] is a list of its own",
    "for x in s.now[:]: s.now[1] = x": "s.now[:] is a list of its own",
    "if s.now: x = 1.0": "s.now is a list, write what is asked of its numbers",
    "x = 1.0 if s.now[:2] else 2.0": "s.now[:2] is a list, write what is asked of its numbers",
    "if s.now == s.old: x = 1.0": "s.now == s.old compares lists as a whole, write a loop over their numbers",
}


@pytest.mark.parametrize("text", TWICE)
def test_what_means_two_things_is_found(text):
    found, _ = of_states("\n".join([HELPERS, function_of("law", "s", "x = 0.0", [text])]))
    assert [each[1][: len(TWICE[text])] for each in found["law"]] == [TWICE[text]]


@pytest.mark.parametrize(
    ("helper", "call", "message"),
    [
        ("w.window = r", "helped(s.tyre, s.now)", "w.window = r may make them one list"),
        ("w.window = r", "helped(r=s.now, w=s.tyre)", "w.window = r may make them one list"),
        (
            "r[0] = 1.0",
            "helped(x, s.now[:2])",
            "r[0] is written, in plain Python a slice that is handed over is a copy",
        ),
        (
            "return r",
            "helped(x, s.now[:2])",
            "a slice is given back, in plain Python that is a copy",
        ),
    ],
)
def test_it_is_found_in_what_the_law_calls(helper, call, message):
    own = function_of("helped", "w, r", "x = 0.0", [helper])
    found, _ = of_states(
        "\n".join([HELPERS, own, function_of("law", "s", "x = 0.0", [f"x = {call}"])])
    )
    assert list(found) == ["helped"] and found["helped"][0][1].startswith(message)
