"""An index out of range in a compiled law is one line, as in plain Python, no foreign memory."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import wraps
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit

import ev_stack
from ev_control.asr.off import off
from ev_core.check.method import ContractError, check_method
from ev_core.compiled.part import CompiledPart
from ev_core.compiled.part_source import is_checked
from ev_core.law import (
    NO_WHEELS,
    DriverCommand,
    Wheels,
    WheelTorqueCommand,
    WheelTorqueRequest,
    compilable,
    each_wheel,
    entry,
    parameter,
    per_wheel,
    series,
)
from ev_core.lockstep.configuration import configure
from ev_core.lockstep.finding import find_method
from ev_core.lockstep.parts import part_of
from ev_core.methods.law import Law, NoParameters
from ev_core.methods.law_error import LawError
from ev_core.methods.method_record import Method, create
from ev_core.methods.part import PythonPart
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.frame import PLACES as PLACES_OF
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.contract.roles import ROLES

# By place what a law reads or writes there; `number` is any number of the state.
PLACES = (
    "series",
    "written series",
    "added series",
    "per wheel",
    "series of a wheel",
    "record of a wheel",
    "table",
    "constant",
    "signal",
    "helper",
    "jitted",
    "slice",
)
CONSTANT = (1.0, 2.0, 3.0, 4.0, 5.0)


@dataclass(frozen=True, slots=True)
class Parameters:
    at: float = parameter(0.0, unit="1", low=-1e18, high=1e18, about="index")
    kind: str = parameter("series", choices=PLACES, about="of what")


@dataclass(slots=True)
class OfWheel:
    x: float = entry(7.0, unit="1")
    row: list[float] = series(3, 8.0, unit="1")


@dataclass(slots=True)
class State:
    before: float = entry(5.0, unit="1")
    ring: list[float] = series(5, 1.0, unit="1")
    wheel: list[float] = per_wheel(2.0, unit="1")
    wheels: list[OfWheel] = each_wheel(OfWheel)
    behind: float = entry(6.0, unit="1")


class Constants(NamedTuple):
    short: tuple[float, ...]
    long: tuple[float, ...]


@compilable
def helped(row, k):
    return row[k]


@njit
def jitted(row, k):
    return row[k]


@compilable
def law(p, c, s, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Reads, or writes, one number at the place of its parameters."""
    s.before += 1.0
    k, x = int(p.at), 0.0
    if p.kind == 0:
        x = s.ring[k]
    elif p.kind == 1:
        s.ring[k] = 3.0
    elif p.kind == 2:
        s.ring[k] += 3.0
    elif p.kind == 3:
        x = s.wheel[k]
    elif p.kind == 4:
        x = s.wheels[1].row[k]
    elif p.kind == 5:
        x = s.wheels[k].x
    elif p.kind == 6:
        x = c.short[k]
    elif p.kind == 7:
        x = CONSTANT[k]
    elif p.kind == 8:
        x = request.drive[k]
    elif p.kind == 9:
        x = helped(c.long, k)
    elif p.kind == 10:
        x = jitted(s.ring, k)
    else:
        s.ring[1:] = s.ring[:-1]
        x = s.ring[k]
    return WheelTorqueCommand(Wheels(x, s.behind, s.before, 0.0), NO_WHEELS)


METHOD = Method(
    "asr",
    "at_an_index",
    Law(
        law,
        Parameters,
        state=State,
        prepare=lambda p, v, t: Constants((1.0, 2.0, 3.0), (4.0, 5.0, 6.0, 7.0)),
    ),
    (WheelTorqueRequest,),
    Parameters,
)


@compilable
@wraps(off)
def made_around_ours(request: WheelTorqueRequest) -> WheelTorqueCommand:
    return WheelTorqueCommand(request.drive, request.brake)


def test_a_law_that_takes_the_name_of_one_of_ours_is_checked():
    """`functools.wraps` gives it our module, where indices are tested once and not in each run."""
    made = Method(
        "asr", "mine", Law(made_around_ours, NoParameters), (WheelTorqueRequest,), NoParameters
    )
    assert made.package == "ev_control"
    assert is_checked(made)
    assert not is_checked(find_method("asr", "off"))


indices = st.one_of(
    st.integers(-8, 8), st.integers(-(10**6), 10**6), st.integers(-(10**17), 10**17)
)


@pytest.mark.slow
@pytest.mark.filterwarnings(
    "ignore::numba.NumbaPendingDeprecationWarning"
)  # of a list that plain Python gives to numba
@settings(max_examples=300)
@given(kind=st.sampled_from(PLACES), index=indices)
def test_an_index_does_compiled_what_it_does_in_plain_python(kind: str, index: int):
    """Same answer and state, or one line with index and length and the state before the step."""
    made = METHOD, Parameters(float(index), kind), Vehicle(), 0.01
    index = int(float(index))
    compiled, plain, here = CompiledPart(*made), PythonPart(METHOD, create(*made)), Frame()
    before = compiled.state.copy()
    ones, others = Frame(), Frame()
    try:
        plain.step(here, others)
    except LawError:
        with pytest.raises(LawError) as raised:
            compiled.step(here, ones)
        what = rf"\S.*\] is out of range: index {index}, length \d, expected"
        if kind == "jitted":  # of which numba shows neither
            what = "IndexError: getitem out of range"
        assert re.match(
            rf"^at 0 s: {re.escape(__file__)}, line \d+: asr law law: {what}", str(raised.value)
        ), raised.value
        assert np.array_equal(compiled.state, before)
        return
    compiled.step(here, ones)
    assert bytes(ones.numbers) == bytes(others.numbers)
    assert compiled.state.tolist() == plain.state


LATE = '''
from dataclasses import dataclass
from ev_core.law import NO_WHEELS, Wheels, WheelTorqueCommand, WheelTorqueRequest, compilable, method, parameter, series

@dataclass(frozen=True, slots=True)
class P:
    delay: float = parameter(0.03, unit="s", low=0.0, high=1.0, about="of the request")

@dataclass(slots=True)
class S:
    ring: list[float] = series(5, unit="N m")

@method("asr", "late")
@compilable
def late(p: P, s: S, period, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Five samples are enough for the default delay, not for the longest one."""
    s.ring[1:] = s.ring[:-1]
    s.ring[0] = request.drive.front_left
    old = s.ring[int(p.delay / period + 0.5)]
    return WheelTorqueCommand(Wheels(old, old, 0.0, 0.0), request.brake)
'''
LINE = "s.ring[int(p.delay / period + 0.5)] is out of range: index 20, length 5, expected -5 to 4"


@pytest.fixture
def late(tmp_path: Path) -> str:
    (tmp_path / "late.py").write_text(LATE)
    return str(tmp_path / "late.py")


def message_of(late: str) -> str:
    return f"{late}, line {LATE[: LATE.index('old = s')].count(chr(10)) + 1}: asr law late: {LINE}"


@pytest.mark.slow
def test_offline_it_is_one_line(late: str):
    """The index leaves its range at once, or in the middle of a run."""
    with pytest.raises(LawError) as raised:
        ev_stack.run("shchur2019", method={"asr": late}, set={"asr.delay": 0.2}, duration=0.1)
    assert str(raised.value) == f"at 0 s: {message_of(late)}"


@pytest.mark.slow
def test_the_check_finds_it_at_the_end_of_the_range(late: str):
    """The default is right; a delay of 1 s, the end of the range, is not."""
    with pytest.raises(ContractError) as found:
        check_method("asr", late, steps=5)
    message = message_of(late).replace("index 20", "index 100")
    (finding,) = found.value.findings
    assert finding.startswith("with delay at 1, ") and finding.endswith(message)


@pytest.mark.slow
def test_in_a_batch_the_run_stops_alone(late: str):
    """Its neighbours go on; the line stands where that of a number that is not finite does."""
    done = ev_stack.batch(
        "shchur2019",
        method={"asr": late},
        vary={"asr.delay": [0.03, 0.2, 0.04]},
        duration=0.1,
        signals=["time"][:0],
    )
    assert done.failed == {1: f"at 0 s: {message_of(late)}"}


READS_ALL = """
from dataclasses import dataclass

from ev_core.law import *
from ev_msgs_py.contract.signals import *


@dataclass(frozen=True, slots=True)
class P:
    gain: float = parameter(1.0, unit="1", about="of the brakes")


@method("electronic_differential", "reads_all")
@compilable
def reads_all(p: P, {arguments}) -> WheelTorqueRequest:
    return WheelTorqueRequest(NO_WHEELS, Wheels(p.gain * driver.brake_torque, 0.0, 0.0, 0.0))
"""


def test_a_law_may_read_all_that_its_role_may(tmp_path):
    """The compiler follows what may raise by recursion, however many numbers there are."""
    reads = [
        signal
        for signal in ROLES["electronic_differential"].reads
        if signal.__module__.endswith(".signals")
    ]
    names = ["driver", *(f"signal_{n}" for n in range(1, len(reads)))]
    arguments = ", ".join(
        f"{name}: {signal.__name__}" for name, signal in zip(names, reads, strict=True)
    )
    file = tmp_path / "reads_all.py"
    file.write_text(READS_ALL.format(arguments=arguments))
    configuration = configure("electronic_differential", {"method": str(file)})
    part, here = part_of(configuration, compiled=True), Frame()
    assert isinstance(part, CompiledPart)
    here.numbers[PLACES_OF[DriverCommand].start + 1] = 3.0
    part.step(here, here)
    assert here.numbers[PLACES_OF[WheelTorqueRequest].start + 4] == 3.0
