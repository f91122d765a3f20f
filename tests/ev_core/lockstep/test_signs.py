"""A field declared as never negative is so for all readers, wherever it comes from."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ev_stack
from ev_core.check.method import ContractError, check_method
from ev_core.lockstep.configuration import configure
from ev_core.lockstep.parts import part_of
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import NEGLIGIBLE, SignalError
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.refusal import ParameterError

LAWS = '''
from dataclasses import dataclass

from ev_core.law import *
from ev_core.law import {signals}


@dataclass(frozen=True, slots=True)
class P:
    here: float = parameter(0.0, unit="N m", about="given at one place")


@dataclass(slots=True)
class S:
    steps: float = entry(unit="1")


@method("{role}", "compiled")
@compilable
def compiled(p: P, s: S, instant: Instant) -> {signal}:
    s.steps += 1.0
    return {answer}


@method("{role}", "plain")
def plain(p: P, s: S, instant: Instant) -> {signal}:
    s.steps += 1.0
    return {answer}


@method("{role}", "of_class")
class of_class:
    """Gives what its parameter is."""

    parameters = P
    state = None

    def __init__(self, parameters, vehicle, period):
        self.p = parameters

    def step(self, instant: Instant) -> {signal}:
        p = self.p
        return {answer}
'''
WHEELS = "Wheels(-2.0, -2.0, -2.0, -2.0), Wheels(1.0, 0.0, p.here, 0.0)"
ROLES = {  # signal, answer, channel
    "driver": (
        "DriverCommand",
        "DriverCommand(-2.0, p.here, -2.0)",
        "brake_torque",
        "driver.command.brake_torque",
    ),
    "electronic_differential": (
        "WheelTorqueRequest",
        f"WheelTorqueRequest({WHEELS})",
        "brake.rear_left",
        "torque_request.brake.rear_left",
    ),
    "asr": (
        "WheelTorqueCommand",
        f"WheelTorqueCommand({WHEELS})",
        "brake.rear_left",
        "torque_command.brake.rear_left",
    ),
}
FORMS = ("compiled", "plain", "of_class")
NUMBERS = st.floats(allow_nan=False, allow_infinity=False) | st.sampled_from(
    (
        -0.0,
        -5e-324,
        0.1 + 0.2 - 0.3 - 1e-16,
        -NEGLIGIBLE,
        math.nextafter(-NEGLIGIBLE, -1.0),
        -50.0,
        -1.7e308,
    )
)


@cache
def law_file(folder: Path, role: str) -> str:
    signal, answer, *_ = ROLES[role]
    file = folder / f"signs_of_{role}.py"
    file.write_text(
        LAWS.format(role=role, signal=signal, signals="Instant, Wheels, " + signal, answer=answer)
    )
    return str(file)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("signs")


def stepped(folder: Path, role: str, form: str, number: float) -> tuple[Any, Frame]:
    configuration = configure(role, {"method": f"{law_file(folder, role)}:{form}", "here": number})
    part, here = part_of(configuration, form == "compiled"), Frame()
    part.step(here, here)
    return part, here


@settings(deadline=None, max_examples=200)
@given(role=st.sampled_from([*ROLES]), form=st.sampled_from(FORMS), number=NUMBERS)
def test_no_law_gives_a_negative_brake_torque(folder, role, form, number):
    """Leftovers of rounding are 0, lower values are refused with signal, field and value.

    Other numbers keep their bits.
    """
    signal, _, field, channel = ROLES[role]
    if number < -NEGLIGIBLE:
        with pytest.raises(SignalError) as refused:
            stepped(folder, role, form, number)
        assert str(refused.value) == f"{signal}.{field} is {number}, expected 0 or more"
        return
    _, here = stepped(folder, role, form, number)
    given = here.numbers[frame.channels()[channel]]
    assert given.hex() == (number if number >= 0.0 else 0.0).hex()


WAYS: dict[str, Callable[..., Any]] = {
    "offline": lambda law: ev_stack.run(
        "double_lane_change", method={"asr": law}, set={"asr.here": -3.0}, duration=0.05
    ),
    "stepped": lambda law: ev_stack.Simulation(
        "double_lane_change", method={"asr": law}, set={"asr.here": -3.0}
    ),
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("way", WAYS)
def test_a_run_ends_in_one_line(folder, form, way):
    message = r"WheelTorqueCommand\.brake\.rear_left is -3\.0, expected 0 or more$"
    with pytest.raises(SignalError, match=message):
        WAYS[way](f"{law_file(folder, 'asr')}:{form}")


SPEED = "twist.longitudinal"


def test_a_run_of_a_batch_ends_alone(folder):
    law = {"asr": f"{law_file(folder, 'asr')}:compiled"}
    varied = {"asr.here": [0.0, -3.0, -1e-17]}
    found = ev_stack.batch(
        "double_lane_change", vary=varied, method=law, signals=[SPEED], duration=0.5
    )
    assert [*found.failed] == [1]
    assert found.failed[1].endswith(
        "WheelTorqueCommand.brake.rear_left is -3.0, expected 0 or more"
    )
    assert (found.signals[SPEED][0] == found.signals[SPEED][2]).all()


@pytest.mark.parametrize("form", FORMS)
def test_the_check_finds_it(folder, form):
    with pytest.raises(ContractError, match=r"brake\.rear_left is -3\.0, expected 0 or more"):
        check_method("asr", f"{law_file(folder, 'asr')}:{form}", {"here": -3.0})


@pytest.mark.parametrize("form", ["compiled", "plain"])
def test_the_state_is_that_before_the_refused_step(folder, form):
    """Plain Python can take the step again and name what is wrong."""
    part, here = stepped(folder, "asr", form, 0.0)
    wrong = part_of(
        configure("asr", {"method": f"{law_file(folder, 'asr')}:{form}", "here": -3.0}),
        form == "compiled",
    )
    wrong.state = part.state
    with pytest.raises(SignalError):
        wrong.step(here, here)
    if form == "compiled":
        assert wrong.state.tolist() == [1.0]


BRAKE = "driver.command.brake_torque"


@pytest.mark.parametrize("number", [-1e-17, 0.0, 3.0])
def test_a_simulation_is_given_no_negative_brake_torque(number):
    simulation = ev_stack.Simulation("double_lane_change", without=["driver"])
    with pytest.raises(
        ParameterError, match=rf"^input {BRAKE}: '?-0\.5'? is refused, expected 0 or more$"
    ):
        simulation.step({"driver.command.drive_torque": 7.0, BRAKE: -0.5})
    simulation.step({"driver.command.drive_torque": 5.0, BRAKE: number})
    assert simulation.recording.channels[BRAKE].tolist() == [max(number, 0.0)]
    assert simulation.recording.channels["driver.command.drive_torque"].tolist() == [5.0]
