"""Met demand weighs all costs of a run: no law ranks above equal torques by doing less."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_core.parameters.data_file import files_in_config
from ev_msgs_py.refusal import ParameterError
from ev_study.benchmark.added import check_laws, with_added
from ev_study.benchmark.board import Board, read_board
from ev_study.benchmark.driving import drive_cell
from ev_study.benchmark.manoeuvre import Manoeuvre
from ev_study.benchmark.ranking.result import BoardResult
from ev_study.benchmark.ranking.scores import LARGEST, costs_of, demand_met

CHEATS = '''
from dataclasses import dataclass

from ev_core.law import Car, DriverCommand, SteeringColumnState, Wheels, WheelTorqueRequest
from ev_core.law import compilable, entry, method, parameter


@dataclass(frozen=True, slots=True)
class Parameters:
    """How a law differs from equal torques."""

    drive: float = parameter(1.0, unit="1", low=0.0, high=1.0, about="share of the drive that it gives")
    brake: float = parameter(1.0, unit="1", low=0.0, high=1.0, about="share of the brakes that it gives")
    alone: float = parameter(0.0, unit="1", low=0.0, high=1.0, about="share of the drive for one wheel alone")
    drag: float = parameter(0.0, unit="N m/rad", low=0.0, high=1e5, about="brakes by the road-wheel angle")
    early: float = parameter(0.0, unit="N m", low=0.0, high=1e5, about="brakes of each wheel in the first second")


@dataclass(slots=True)
class State:
    """How long it has driven."""

    time: float = entry(unit="s", about="since the start")


@method("electronic_differential", "cheats")
@compilable
def cheats(
    p: Parameters, car: Car, s: State, period: float, driver: DriverCommand, column: SteeringColumnState
) -> WheelTorqueRequest:
    """Equal torques, less of them, or elsewhere."""
    s.time += period
    fl, fr, rl, rr = car.driven
    alone = p.alone * p.drive * driver.drive_torque
    each = (p.drive * driver.drive_torque - alone) / car.number_driven
    left = each + alone
    drive = Wheels(left if fl == 1.0 else 0.0, each * fr, each * rl if fl == 1.0 else left * rl, each * rr)
    brake = p.brake * driver.brake_torque
    front = brake * 0.6 / 2.0
    rear = brake / 2.0 - front
    more = p.drag * abs(column.road_wheel_angle)
    if s.time <= 1.0:
        more += p.early
    return WheelTorqueRequest(drive, Wheels(front + more, front + more, rear + more, rear + more))
'''
WAYS = {
    "equal": "{drive: 1.0}",
    "no_brakes": "{brake: 0.0}",
    "no_drive": "{drive: 0.0}",
    "half": "{drive: 0.5, brake: 0.5}",
    "one_wheel": "{alone: 1.0}",
    "nothing": "{drive: 0.0, brake: 0.0}",
    "drags": "{drag: 3000.0}",
    "brakes_early": "{early: 750.0}",
    "brakes_early_a_little": "{early: 60.0}",
}


@pytest.fixture
def with_cheats(tmp_path: Path) -> tuple[Board, list[str]]:
    """The small board with three draws and all laws that cheat."""
    law = tmp_path / "cheats.py"
    law.write_text(CHEATS)
    adding = []
    for name, values in WAYS.items():
        path = tmp_path / f"{name}.yaml"
        path.write_text(f"/**/electronic_differential:\n  ros__parameters: {values}\n")
        adding.append(f"{law}={path}")
    return with_added(replace(read_board("small"), draws=3), adding)


@pytest.mark.weekly
def test_no_law_that_does_less_ranks_above_equal_torques(with_cheats: tuple[Board, list[str]]):
    """It holds in handling, worst tenth and energy.

    Without cheating the law is `equal_torque`. Dropped torques would lead in handling and energy,
    dropped brakes in the worst tenth.
    """
    board, cheats = with_cheats
    laws = ["equal_torque", *cheats]
    result = BoardResult(board, laws, [drive_cell(board, cell, laws) for cell in board.cells()])
    for of, scores in result.scores.items():
        equal, same, *others = scores
        assert (same.value, same.rank) == (equal.value, equal.rank)
        for law, score in zip(laws[2:], others, strict=True):
            assert score.rank >= equal.rank, f"{law} in {of}"
            assert score.value >= equal.value - 1e-12, f"{law} in {of}"
    assert (result.met[1] == 1.0).all()
    assert result.met[laws.index("nothing")].mean() < 0.5


@pytest.mark.parametrize(
    ("law", "pedal"), [("no_brakes", "brake"), ("no_drive", "drive"), ("nothing", "drive")]
)
def test_a_law_under_which_a_pedal_has_no_effect_is_refused(
    with_cheats: tuple[Board, list[str]], law: str, pedal: str
):
    board, _ = with_cheats
    with pytest.raises(
        ParameterError, match=rf"law {law} with .*: .*DriverCommand\.{pedal} has no effect"
    ):
        check_laws(board, [law], [law])


MANOEUVRE = Manoeuvre(
    "s", 1.0, [], ["peak_sideslip", "peak_slip"], [], demand=["way [m] = last(pose.x)"]
)
SCALES = {"peak_sideslip": 0.01, "peak_slip": 0.01, "way": 1.0}


def costs(
    way: list[float], peak_slip: float = 0.2, cost: str = "handling", sideslip: float = 0.05
) -> list[float]:
    """Costs of a law with half the sideslip of the reference, which goes 10 m in each draw."""
    board = replace(read_board("small"), reference="one", scales=SCALES)
    ones = np.ones(len(way))
    metrics = {
        "one": {"peak_sideslip": 0.1 * ones, "peak_slip": 0.2 * ones, "way": 10.0 * ones},
        "law": {
            "peak_sideslip": sideslip * ones,
            "peak_slip": peak_slip * ones,
            "way": np.array(way),
        },
    }
    return costs_of(board, MANOEUVRE, cost, metrics, np.zeros((2, len(way)), bool))[1].tolist()


def test_a_run_pays_for_what_it_misses_of_the_demand():
    """All of it or more: its own cost, 0.75.

    0.8: 0.8*0.75 + 0.2*3 = 1.2; less than a half, or no number: 3.
    """
    assert costs([10.0, 12.0, 8.0, 4.9, np.nan]) == pytest.approx(
        [0.75, 0.75, 1.2, LARGEST, LARGEST]
    )
    assert costs([10.0, 8.0, 4.0], cost="energy") == pytest.approx([1.0, 1.4, LARGEST])


@given(
    sideslip=st.floats(0.0, 1.0),
    slip=st.floats(0.0, 1.0),
    ways=st.tuples(st.floats(-5.0, 15.0), st.floats(-5.0, 15.0)),
)
def test_a_run_that_meets_less_never_costs_less(
    sideslip: float, slip: float, ways: tuple[float, float]
):
    """Other numbers being equal, it costs its own cost at least, and LARGEST at most."""
    more, less, whole = costs([max(ways), min(ways), 10.0], slip, sideslip=sideslip)
    assert 0.0 <= whole <= more <= less <= LARGEST


def test_a_run_that_lacks_one_of_two_numbers_costs_most():
    """The cost is not the mean of 3 and of that of the other number."""
    assert costs([10.0], peak_slip=np.nan) == [LARGEST]


def test_a_demand_near_zero_is_held_against_its_scale():
    """A car that keeps its speed gains 0.01 m/s: 1 m/s less is half of the scale of 2 m/s."""
    board = replace(read_board("small"), reference="one", scales={"gained": 2.0})
    held = replace(
        MANOEUVRE, demand=["gained [m/s] = last(twist.longitudinal) - first(twist.longitudinal)"]
    )
    metrics = {
        "one": {"gained": np.array([0.01, -0.01, np.nan])},
        "law": {"gained": np.array([-0.99, 1.0, 5.0])},
    }
    assert demand_met(board, held, metrics)[1] == pytest.approx([0.5, 1.0, 1.0])


def test_of_several_demands_the_least_share_counts():
    """1 m of 10 m less, 0.5 m/s of the scale of 1 m/s less, both.

    None of the demands makes up for another one.
    """
    board = replace(read_board("small"), reference="one", scales={"way": 1.0, "kept": 1.0})
    two = replace(MANOEUVRE, demand=[*MANOEUVRE.demand, "kept [m/s] = last(twist.longitudinal)"])
    one = {"way": np.full(4, 10.0), "kept": np.zeros(4)}
    law = {"way": np.array([9.0, 10.0, 9.0, 12.0]), "kept": np.array([0.0, -0.5, -0.5, -0.5])}
    assert demand_met(board, two, {"one": one, "law": law})[1] == pytest.approx(
        [0.9, 0.5, 0.5, 0.5]
    )


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (
            '    demand: ["way_gone [m] = last(pose.x)"]\n',
            "",
            "launch lacks demand, expected are metrics of what",
        ),
        (
            '"way_gone [m] = last(pose.x)"',
            "peak_slip",
            "demand of launch is peak_slip, which is better low, expected",
        ),
        ("way_gone: 1.0, ", "", "scales lacks a number above 0 for way_gone of launch"),
    ],
)
def test_what_is_wrong_with_a_demand_is_one_line(tmp_path: Path, old: str, new: str, line: str):
    path, text = tmp_path / "own.yaml", files_in_config("benchmarks")["small"].read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(ParameterError) as refused:
        read_board(str(path))
    assert str(refused.value).startswith(f"{path}: {line}")
