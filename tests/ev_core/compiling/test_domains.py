"""A number without a result, such as x / 0, ends a compiled law as it ends plain Python."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numba import njit

from ev_core.compiled.part import CompiledPart
from ev_core.compiling import code_store
from ev_core.law import (
    NO_WHEELS,
    Wheels,
    WheelTorqueCommand,
    WheelTorqueRequest,
    compilable,
    entry,
    parameter,
    sqrt,
)
from ev_core.methods.law import Law
from ev_core.methods.law_error import LawError
from ev_core.methods.method_record import Method, create
from ev_core.methods.part import PythonPart
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.frame import Frame

# By place what the law calculates of x and y.
KINDS = (
    "x / y",
    "x // y",
    "x % y",
    "integers: x // y",
    "integers: x % y",
    "x ** y",
    "x ** -2",
    "x ** integer",
    "sqrt of ours",
    "math.sqrt",
    "math.sqrt of an integer",
    "math.log",
    "math.log2",
    "math.log10",
    "math.log1p",
    "math.asin",
    "math.acos",
    "math.acosh",
    "math.atanh",
    "math.exp",
    "math.cosh",
    "math.pow",
    "helper",
    "jitted",
    "int",
)


@dataclass(frozen=True, slots=True)
class Parameters:
    x: float = parameter(1.0, unit="1", low=-1e300, high=1e300, about="a number")
    y: float = parameter(1.0, unit="1", low=-1e300, high=1e300, about="another one")
    kind: str = parameter("x / y", choices=KINDS, about="what is calculated")


@dataclass(slots=True)
class State:
    steps: float = entry(5.0, unit="1")


@compilable
def helped(x, y):
    return math.sqrt(x) / y


@njit
def jitted(x, y):
    """Divide as numba does where plain Python calls it: math.sqrt gives NaN, divisions raise."""
    return x / y


@compilable
def calculated(kind, x, y):
    """Calculate by one of the first kinds.

    There are two halves because the compiler follows branches by recursion.
    """
    if kind == 0:
        return x / y
    if kind == 1:
        return x // y
    if kind == 2:
        return x % y
    if kind == 3:
        return float(int(x) // int(y))
    if kind == 4:
        return float(int(x) % int(y))
    if kind == 5:
        return x**y
    if kind == 6:
        return x**-2
    if kind == 7:
        return x ** int(y)
    if kind == 8:
        return sqrt(x)
    if kind == 9:
        return math.sqrt(x)
    if kind == 10:
        return math.sqrt(int(x))
    return of_math(kind, x, y)


@compilable
def of_math(kind, x, y):
    if kind == 11:
        return math.log(x)
    if kind == 12:
        return math.log2(x)
    if kind == 13:
        return math.log10(x)
    if kind == 14:
        return math.log1p(x)
    if kind == 15:
        return math.asin(x)
    if kind == 16:
        return math.acos(x)
    if kind == 17:
        return math.acosh(x)
    if kind == 18:
        return math.atanh(x)
    if kind == 19:
        return math.exp(x)
    if kind == 20:
        return math.cosh(x)
    if kind == 21:
        return math.pow(x, y)
    if kind == 22:
        return helped(x, y)
    if kind == 23:
        return jitted(x, y)
    return float(int(x * y * 1e20))


@compilable
def law(p, s, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Hides what it calculates.

    Neither infinity nor NaN leaves these limits, in which max and min give 0 for NaN.
    """
    s.steps += 1.0
    x = min(max(0.0, calculated(p.kind, p.x, p.y)), 100.0)
    return WheelTorqueCommand(Wheels(x, s.steps, 0.0, 0.0), NO_WHEELS)


METHOD = Method(
    "asr", "at_a_limit", Law(law, Parameters, state=State), (WheelTorqueRequest,), Parameters
)
# Powers as large as an integer takes, and whole numbers of 64 bits, are the same in both.
numbers = st.one_of(st.sampled_from((0.0, -0.0, 1.0, -1.0, 0.5, -0.5, -8.0)), st.floats(-1e3, 1e3))


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@settings(max_examples=400)
@given(kind=st.sampled_from(KINDS), x=numbers, y=numbers)
@example("x / y", 0.0, 0.0)
@example("math.sqrt", -1.0, 1.0)
@example("integers: x % y", 1.0, 0.0)
@example("x ** y", -8.0, 0.5)
@example("math.exp", 800.0, 1.0)
@example("jitted", 1.0, 0.0)
@example("x ** integer", -8.0, 342.0)
@example("int", 1e300, 1e300)
@example("int", 1e300, 0.0)
@example("int", 1.0, 1.0)
def test_a_law_fails_compiled_where_it_fails_in_plain_python(kind: str, x: float, y: float):
    """The same answer, or the same line of plain Python and the state before the step."""
    made = METHOD, Parameters(x, y, kind), Vehicle(), 0.01
    compiled, plain, here = CompiledPart(*made), PythonPart(METHOD, create(*made)), Frame()
    before = compiled.state.copy()
    ones, others = Frame(), Frame()
    try:
        plain.step(here, others)
    except LawError as expected:
        with pytest.raises(LawError) as raised:
            compiled.step(here, ones)
        assert str(raised.value) == str(expected)
        assert re.match(rf"at 0 s: {re.escape(__file__)}, line \d+: asr law law: ", str(expected))
        assert np.array_equal(compiled.state, before)
        return
    if kind == "int" and abs(x * y * 1e20) >= 2.0**63:
        with pytest.raises(LawError, match="its compiled form fails where plain Python does not"):
            compiled.step(here, ones)
        return
    compiled.step(here, ones)
    # Functions of math are rounded in another way by the compiler's library.
    assert list(ones.numbers) == pytest.approx(list(others.numbers), rel=1e-9)
    assert compiled.state.tolist() == plain.state


@njit
def doubled(x):
    return 2.0 * x


@compilable
def calls_numba_later(p, request: WheelTorqueRequest) -> WheelTorqueCommand:
    x = doubled(p.x) if p.x > 1.0 else 0.0
    return WheelTorqueCommand(Wheels(x, x, 0.0, 0.0), NO_WHEELS)


def test_a_function_of_numba_can_be_called_in_plain_python_after_its_law_was_compiled(
    tmp_path, monkeypatch
):
    """Python need not have called it before.

    It is machine code of its own, not only within its caller.
    """
    monkeypatch.setattr(code_store, "cache_folder", lambda: tmp_path)  # so that it is compiled here
    method = Method(
        "asr", "later", Law(calls_numba_later, Parameters), (WheelTorqueRequest,), Parameters
    )
    CompiledPart(method, Parameters(1.0), Vehicle(), 0.01)
    assert doubled(3.0) == 6.0
