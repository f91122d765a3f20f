"""A text that means one thing in plain Python and another compiled is refused beforehand."""

from __future__ import annotations

import ast
import inspect
import textwrap
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_core.compiled import part
from ev_core.compiled.lists_of_state import wrong_lists
from ev_core.compiled.part import code_key
from ev_core.compiled.unassigned import unassigned
from ev_core.lockstep.configuration import Configuration, configure
from ev_core.lockstep.parts import compiled_part
from ev_core.methods.law_error import LawError
from ev_core.methods.register import all_methods
from ev_msgs_py.compilable import FUNCTIONS
from ev_msgs_py.packages import OURS

HEAD = '''
from dataclasses import dataclass
from typing import NamedTuple
from ev_core.law import (
    Wheels, WheelTorqueCommand, WheelTorqueRequest, compilable, each_wheel, entry, method, parameter, part, series
)

@dataclass(frozen=True, slots=True)
class P:
    n: float = parameter(1.0, unit="1", low=0.0, high=4.0, about="number")

@dataclass(slots=True)
class Tyre:
    slip: float = entry(unit="1", about="a number")
    window: list[float] = series(2, unit="1", about="numbers")

@dataclass(slots=True)
class S:
    count: float = entry(unit="1", about="a number")
    now: list[float] = series(4, 1.0, unit="N m", about="numbers")
    old: list[float] = series(4, 2.0, unit="N m", about="numbers")
    tyre: Tyre = part(Tyre)
    spare: Tyre = part(Tyre)
    tyres: list[Tyre] = each_wheel(Tyre)

class C(NamedTuple):
    table: tuple[float, ...]

def prepare(parameters, vehicle, period):
    return C((1.0, 2.0, 3.0))

@compilable
def raised_by_one(table):
    table[0] = table[0] + 1.0
    return table[0]

@method("asr", "mine", prepare=prepare)
@compilable
def mine(p: P, c, s: S, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """A law."""
    x = 1.0
'''
TAIL = """
    return WheelTorqueCommand(Wheels(x, x, x, x), request.brake)
"""
REFUSED = {
    "if s.count > 5.0: y = 3.0\n    x = y": "y may have no value here, give it one on every way: compiled it is 0",
    "for i in range(int(p.n)): y = i\n    x = y * 1.0": "y may have no value here",
    "for i in range(int(p.n)): pass\n    x = i * 1.0": "i may have no value here",
    """match int(p.n):
        case 9: y = 3.0
        case 8: y = 4.0
    x = y""": "y may have no value here",
    "for i, y in enumerate(range(int(p.n))): pass\n    x = y * 1.0": "y may have no value here",
    "for y in request.drive[int(p.n):]: pass\n    x = y * 1.0": "y may have no value here",
    "y += x": "y may have no value here",
    "s.spare = s.tyre": "s.spare = s.tyre may make them one record, copy its entries one by one",
    "s.tyre, s.spare = s.spare, s.tyre": "s.tyre = s.spare may make them one record",
    "s.tyres[0] = s.tyres[1]": r"s.tyres\[0\] = s.tyres\[1\] may make them one record",
    "s.tyres[:2] = s.tyres[2:]": r"s.tyres\[:2\] = s.tyres\[2:\] may make them one record",
    "w = s.now; s.old = w": r"s.old = w may make them one list, numbers are copied by s.old\[:\] = w",
    "w = s.tyres[0]; w.window = s.spare.window": "w.window = s.spare.window may make them one list",
    "x = (s.now + s.old)[0]": r"s.now \+ s.old joins lists in plain Python, write a loop over their numbers",
    "x = (s.now[:2] * 3)[0]": r"s.now\[:2\] \* 3 joins lists",
    "s.now += s.old": r"s.now \+= s.old joins lists",
    "s.now[:] = 0.0": "can only assign an iterable",
    "x = raised_by_one(c.table)": "'tuple' object does not support item assignment",
}


@pytest.mark.parametrize("text", REFUSED)
def test_a_text_of_two_meanings_is_refused(text, tmp_path):
    """The line names the law's file and line; nothing is compiled."""
    file = tmp_path / "my_law.py"
    file.write_text(f"{HEAD}    {text}{TAIL}")
    with pytest.raises(LawError, match=rf"^{file}, line \d+: asr law mine: {REFUSED[text]}"):
        compiled_part(configure("asr", {"method": str(file)}))


ACCEPTED = """
    for i in range(4): y = s.now[i]
    for each in s.tyres: each.slip += y
    if p.n > 2.0: z = 1.0
    elif p.n > 1.0: z = 2.0
    else: return WheelTorqueCommand(request.drive, request.brake)
    while True:
        q = z
        if q > 0.5: break
    w = s.tyre
    w.window[:] = s.spare.window
    s.now[0], s.now[1] = s.now[1], s.now[0]
    x = y + z + q + s.now[0] * s.old[1] + each.slip
"""


def test_a_text_of_one_meaning_is_compiled(tmp_path):
    """Loops that run, ways that return, and lists with their numbers in place are compiled."""
    file = tmp_path / "my_law.py"
    file.write_text(f"{HEAD}{ACCEPTED}{TAIL}")
    assert compiled_part(configure("asr", {"method": str(file)})).state.size == 27


def test_what_older_rules_have_let_pass_is_checked_again(tmp_path, monkeypatch):
    """Code on disk is not: that of a law of a user has the rules in its key.

    Ours is looked at by the suite.
    """
    file = tmp_path / "my_law.py"
    file.write_text(f"{HEAD}{ACCEPTED}{TAIL}")
    mine, ours = configure("asr", {"method": str(file)}), configure("asr", {"method": "pi_slip"})
    keys = [code_key(each.method, *_given(each)) for each in (mine, ours)]
    monkeypatch.setattr(part, "_rules", lambda: "of tomorrow")
    assert [
        code_key(each.method, *_given(each)) == key
        for each, key in zip((mine, ours), keys, strict=True)
    ] == [
        False,
        True,
    ]


def _given(configuration: Configuration) -> tuple[Any, Any, float]:
    return configuration.given, configuration.common.vehicle, configuration.common.control_period


def _is_ours(function: Any) -> bool:
    return function.__module__.partition(".")[0] in OURS


@pytest.mark.weekly
def test_functions_of_ours_have_one_meaning():
    laws = [each.law for methods in all_methods().values() for each in methods.values() if each.law]
    for function in filter(_is_ours, FUNCTIONS):
        assert not list(unassigned(_tree(function), function)), function
    for law in laws:
        if _is_ours(law.function):
            own = [each for each in (law.function, law.outputs) if each]
            found = wrong_lists(own, law.state(), _tree)
            assert not [(function, what) for function, each in found.items() for what in each]


def _tree(function: Any) -> ast.AST:
    return ast.parse(textwrap.dedent(inspect.getsource(function)))


NAMES = st.sampled_from("abc")
ROWS = [
    "range(next(way))",
    "range(2)",
    "enumerate(range(next(way)))",
    "zip([1, 2], range(next(way)))",
    "[1, 2][next(way):]",
    "reversed(range(next(way)))",
    "[1]",
    "()",
    "range(len([1, 2][:next(way)]))",
    "rows",
]
HEADS = [
    "if next(way):",
    "while next(way):",
    "rows = range(next(way))\nfor b in rows:",
    "for a in c, b:",
    *(f"for c in {row}:" for row in ROWS),
]
SIMPLE = st.one_of(
    st.builds("seen = [{} for {} in (1, 2)]".format, NAMES, NAMES),
    st.builds("rows = {}".format, st.sampled_from([*ROWS, "[a]"])),
    st.builds("{} = 1".format, NAMES),
    st.builds("seen = {}".format, NAMES),
    st.builds("{} += 1".format, NAMES),
    st.sampled_from(["return", "break", "continue", "pass"]),
)


def _indented(lines: list[str]) -> list[str]:
    return [f"    {line}" for text in lines for line in text.splitlines()]


def _blocks(bodies: st.SearchStrategy[list[str]]) -> st.SearchStrategy[str]:
    one = st.builds(
        lambda head, body: "\n".join([head, *_indented(body)]), st.sampled_from(HEADS), bodies
    )
    other = st.builds(lambda body: "\n".join(["else:", *_indented(body)]), bodies)
    return st.one_of(
        one,
        st.builds("{}\n{}".format, one, other),
        st.lists(_cases(bodies), min_size=1, max_size=3).map(_matched),
    )


def _cases(bodies: st.SearchStrategy[list[str]]) -> st.SearchStrategy[str]:
    heads = [
        "case 0:",
        "case 1 if a:",
        "case b if next(way):",
        "case 1 as a:",
        "case (0, c) | (c, 1):",
        "case _ if b:",
    ]
    return st.builds(
        lambda head, body: "\n".join([head, *_indented(body)]), st.sampled_from(heads), bodies
    )


def _matched(cases: list[str]) -> str:
    """A match statement; its last case takes all if it has a 1 in it."""
    return "\n".join(["match next(way):", *_indented(cases)])


BODIES = st.recursive(
    st.lists(SIMPLE, min_size=1, max_size=4),
    lambda bodies: st.lists(st.one_of(SIMPLE, _blocks(bodies)), min_size=1, max_size=4),
    max_leaves=12,
)


@pytest.mark.weekly
@settings(deadline=None, max_examples=300)
@given(
    body=BODIES,
    ways=st.lists(st.lists(st.integers(0, 1), min_size=30, max_size=30), min_size=8, max_size=8),
)
def test_where_nothing_is_found_every_name_has_a_value(body, ways):
    """Plain Python raises no UnboundLocalError on any tried way through an accepted function."""
    text = "\n".join(["def function(way):", *_indented(body)])
    space: dict[str, Any] = dict.fromkeys("abc", 1) | {
        "rows": [1]
    }  # for those that the function has none of its own of
    try:
        exec(compile(text, "<text>", "exec"), space)
    except SyntaxError:  # a break outside of a loop
        return
    found = list(unassigned(ast.parse(text), space["function"]))
    for way in ways:
        try:
            space["function"](iter(way))
        except NameError:  # UnboundLocalError is one, and that of a comprehension
            assert found, text
        # a loop that goes on and on, or counts with what is no number
        except (StopIteration, RuntimeError, TypeError):
            pass
