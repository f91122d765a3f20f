"""Arguments of a law: records of signals, choices, and truth values."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from ev_core.check.method import check_method
from ev_core.law import (
    NO_WHEELS,
    Choice,
    Instant,
    Vehicle,
    Wheels,
    WheelStates,
    WheelTorqueRequest,
    group,
    parameter,
)
from ev_core.lockstep.finding import find_method
from ev_core.methods.method_record import create
from ev_core.parameters.declaration import entries, flatten, number_tree
from ev_core.parameters.values import build
from ev_msgs_py.refusal import ParameterError

LAW = '''
from dataclasses import dataclass
from enum import auto
from typing import NamedTuple

from ev_core.law import *


class Side(Choice):
    BOTH = auto()
    LEFT = auto()


@dataclass(frozen=True, slots=True)
class P:
    side: Side = parameter(Side.LEFT, about="which wheels are limited")
    limit: float = parameter(100.0, unit="N m", low=0.0, high=1e4, about="largest torque")
    is_soft: bool = setting(False, about="whether the limit is halved once a wheel has turned")


@dataclass(slots=True)
class S:
    has_turned: bool = entry(False, unit="1", about="whether a wheel has turned")


class Asked(NamedTuple):
    request: WheelTorqueRequest
    wheels: WheelStates


class Seen(NamedTuple):
    now: Instant
    asked: Asked


@method("asr", "mine")
@compilable
def mine(p: P, s: S, seen: Seen) -> WheelTorqueCommand:
    """Limit torques [N m]."""
    if seen.asked.wheels.velocity[0] > 1.0:
        s.has_turned = True
    limit = p.limit / 2.0 if p.is_soft and s.has_turned else p.limit
    a, b, c, d = seen.asked.request.drive
    left = Wheels(min(a, limit), b, min(c, limit), d)
    drive = Wheels(left[0], min(b, limit), left[2], min(d, limit)) if p.side == Side.BOTH else left
    return WheelTorqueCommand(drive, seen.asked.request.brake)
'''


REQUEST = WheelTorqueRequest(Wheels(300.0, 300.0, 300.0, 300.0), NO_WHEELS)


def wheels(speed: float) -> WheelStates:
    return WheelStates(NO_WHEELS, Wheels(speed, 0.0, 0.0, 0.0), NO_WHEELS)


def made_of(law: str, **values: Any) -> Any:
    """The law in plain Python; `check_method` compares its compiled form with this one."""
    found = find_method("asr", law)
    return create(found, build(found.parameters, values), Vehicle(), 0.005)


@pytest.fixture
def law(tmp_path: Path) -> str:
    file = tmp_path / "my_law.py"
    file.write_text(LAW)
    return str(file)


def test_a_record_of_signals_is_read_as_the_signals_themselves(law):
    """The order is that of the fields, records within records in their place."""
    assert find_method("asr", law).reads == (Instant, WheelTorqueRequest, WheelStates)


def test_records_choices_and_truth_values_keep_the_contract(law):
    check_method("asr", law)


def test_a_class_takes_single_signals(tmp_path):
    file = tmp_path / "my_law.py"
    begin = LAW.index('@method("asr"')
    text = """
@method("asr", "mine")
class Mine:
    parameters = P
    state = None

    def __init__(self, parameters, vehicle, period):
        pass

    def step(self, seen: Seen) -> WheelTorqueCommand:
        return WheelTorqueCommand(seen.asked.request.drive, seen.asked.request.brake)
"""
    file.write_text(LAW[:begin] + text)
    with pytest.raises(ParameterError, match="a asr does not read Seen"):
        find_method("asr", str(file))


@pytest.mark.parametrize(("side", "right"), [("left", 300.0), ("both", 100.0)])
def test_a_choice_is_compared_with_its_member(law, side, right):
    """300 N m are asked of each wheel, 100 N m are the limit."""
    made = made_of(law, side=side)
    drive = made.step(Instant(0.0), REQUEST, wheels(0.0)).drive
    assert (drive.front_left, drive.front_right) == (100.0, right)


def test_a_truth_value_lasts_between_steps(law):
    """Once a wheel has turned the limit is half, also when it stands again.

    In a row of the state true is 1.
    """
    made = made_of(law, is_soft=True)
    limits = [
        made.step(Instant(0.0), REQUEST, wheels(speed)).drive.front_left
        for speed in (0.0, 2.0, 0.0)
    ]
    assert limits == [100.0, 50.0, 50.0]
    assert made.state == [1.0]


class Kind(Choice):
    """Two kinds."""

    SMALL = 0
    LARGE_ONE = 1


@dataclass(frozen=True, slots=True)
class Inner:
    kind: Kind = parameter(Kind.SMALL, about="size")


@dataclass(frozen=True, slots=True)
class Outer:
    inner: Inner = group(Inner)


def test_a_choice_is_a_text_outside_and_a_number_for_laws():
    made = build(Outer, {"inner.kind": "large_one"})
    assert made.inner.kind is Kind.LARGE_ONE
    assert flatten(made) == {"inner.kind": "large_one"}
    assert number_tree(made) == {"inner": {"kind": 1.0}}
    (entry,) = entries(Outer)
    assert (entry.type, entry.default, entry.spec.choices) == (str, "small", ("small", "large_one"))
    with pytest.raises(
        ParameterError, match=r"inner\.kind: 'huge' is refused, expected one of small, large_one"
    ):
        build(Outer, {"inner.kind": "huge"})
