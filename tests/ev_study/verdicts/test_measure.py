"""A measure of a published number is an expression over a run, or a function with its words."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ev_core.vehicle.description import Vehicle
from ev_stack.measures.metric import NotMeasured
from ev_stack.recording.recording import Recording
from ev_study.verdicts.measure import Call, Expression, compared, measured_by
from ev_study.verdicts.need import ScenarioNeed, ScenarioRuns

ANY = ScenarioNeed("ge_ni2005")


def runs(**yaw_rates: float) -> ScenarioRuns:
    """Runs of three samples by name, each with a yaw rate [rad/s] at the end."""
    time = np.array([0.0, 1.0, 2.0])
    recordings = {
        name: Recording(time, {"imu.yaw_rate": np.array([0.0, value / 2, value])})
        for name, value in yaw_rates.items()
    }
    return ScenarioRuns(recordings, Vehicle(mass=1500.0), {})


def test_the_name_of_a_run_stands_in_front_of_its_expression():
    driven = runs(rate=0.3, offset=0.4)
    assert measured_by("rate: last(imu.yaw_rate)", {}, [ANY])([driven]) == 0.3
    assert (
        measured_by("offset: last(imu.yaw_rate) / vehicle.mass", {}, [ANY])([driven])
        == 0.4 / 1500.0
    )


def test_the_only_run_needs_no_name():
    assert measured_by("last(imu.yaw_rate)", {}, [ANY])([runs(only=0.3)]) == 0.3


def test_of_several_runs_that_which_is_driven_alone_needs_no_name():
    """A report has all runs of a scenario at hand, also for a number of one of them."""
    alone = replace(ANY, runs=("offset",))
    assert measured_by("last(imu.yaw_rate)", {}, [alone])([runs(rate=0.3, offset=0.4)]) == 0.4


def test_a_run_is_not_guessed():
    with pytest.raises(
        NotMeasured,
        match="no run is named, expected one of rate, offset in front of the expression",
    ):
        measured_by("last(imu.yaw_rate)", {}, [ANY])([runs(rate=0.3, offset=0.4)])
    with pytest.raises(NotMeasured, match="there is no run increment"):
        measured_by("increment: last(imu.yaw_rate)", {}, [ANY])([runs(rate=0.3, offset=0.4)])


def test_of_two_needs_an_expression_is_the_ratio():
    ratio = measured_by("last(imu.yaw_rate)", {}, [ANY, ANY])
    assert ratio([runs(a=0.3), runs(b=0.4)]) == 0.3 / 0.4
    with pytest.raises(NotMeasured, match="the number that it is divided by is 0"):
        ratio([runs(a=0.3), runs(b=0.0)])


def test_another_run_takes_the_place_of_the_named_one():
    """The report of Ge & Ni holds the same claims on runs of other cars."""
    other = measured_by("rate: last(imu.yaw_rate)", {}, [ANY]).renamed(
        {"rate": "offset", "last": "first"}
    )
    assert other([runs(rate=0.3, offset=0.4)]) == 0.4


def test_a_function_of_that_name_goes_before_an_expression():
    assert isinstance(measured_by("distance", {"distance": lambda driven: 1.0}, [ANY]), Call)
    assert isinstance(measured_by("distance", {}, [ANY]), Expression)


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("a 1 < b 2", ("a 1", "<", "b 2")),
        ("mean(x[time > 1]) > y", ("mean(x[time > 1])", ">", "y")),
        ("mean(x[time > 1])", ("mean(x[time > 1])", "", "")),
        ("angle<2", ("angle<2", "", "")),
        ("", ("", "", "")),
    ],
)
def test_a_sign_in_brackets_does_not_compare(text: str, parts: tuple[str, str, str]):
    assert compared(text) == parts
