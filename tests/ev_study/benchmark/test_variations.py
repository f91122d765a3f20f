"""Control periods and motor faults as variations.

The same draws for all laws, and single runs with the same hash.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from ev_core.parameters.data_file import files_in_config
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.run_scenario import main
from ev_study.benchmark.board import MOTOR_FAULT, TOLD_FRICTION, Board, Cell, Variation, read_board
from ev_study.benchmark.cell_runs import law_of, run_of, values_of
from ev_study.benchmark.draws import drawn, own_draws
from ev_study.benchmark.driving import DrivenCell, drive_cell, laws_in_cell
from ev_study.benchmark.kept_cells import kept_cells
from ev_study.benchmark.ranking.varied import (
    Difference,
    Varied,
    differences_by_variation,
    mantel_haenszel,
)

PERIODS = [0.005, 0.02]
VARIATIONS = [
    {"parameter": "*.control_period", "choice": PERIODS},
    {"parameter": "motor_fault", "value": [0.0, 0.5], "begin": [0.5, 1.0], "probability": 0.5},
]
STEP = "layout_1_8_c:all:step_steer:wet:*"
LAWS = ["equal_torque", "pi"]
YAW_RATE = "plant.sensors.imu_yaw_rate"
DRAWS = 6


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A short board with these variations alone."""
    content = yaml.safe_load(files_in_config("benchmarks")["small"].read_text())
    content |= {"draws": DRAWS, "variations": VARIATIONS}
    content["manoeuvres"]["step_steer"]["duration"] = 2.5
    path = tmp_path_factory.mktemp("board") / "own.yaml"
    path.write_text(yaml.safe_dump(content))
    return path


@pytest.fixture(scope="module")
def board(path: Path) -> Board:
    return read_board(str(path))


@pytest.fixture(scope="module")
def driven(board: Board) -> DrivenCell:
    return drive_cell(board, board.cells(STEP)[0], LAWS)


def stated(driven: DrivenCell, law: str, name: str) -> list[str]:
    """Values that the command of each draw gives a parameter."""
    words = [shlex.split(each) for each in driven.laws[law].commands]
    return [
        word.partition("=")[2] for each in words for word in each if word.startswith(f"{name}=")
    ]


def test_all_laws_have_the_same_periods_and_faults(driven: DrivenCell):
    for name in ("*.control_period", "plant.faults"):
        assert stated(driven, "pi", name) == stated(driven, "equal_torque", name)
        assert 1 < len(set(stated(driven, "pi", name))) <= len(stated(driven, "pi", name)) == DRAWS


def test_a_run_alone_has_the_hash_of_the_board(
    driven: DrivenCell, path: Path, tmp_path: Path, capsys
):
    """One with another control period than the scenario's, and one with a fault."""
    faults = stated(driven, "pi", "plant.faults")
    for draw in {
        next(n for n, each in enumerate(faults) if ("motor" in each) == has)
        for has in (True, False)
    }:
        words = [
            "benchmark",
            str(path),
            "--cells",
            STEP,
            "--drive",
            f"pi:{draw}",
            "--offline",
            "--no-report",
        ]
        main([*words, "--out", str(tmp_path / str(draw))])
        assert f"signal hash {driven.laws['pi'].hashes[draw]}\n" in capsys.readouterr().out


def test_draws_are_within_what_is_declared(board: Board):
    """A thousand of them.

    The frequencies are within four standard deviations of a binomial distribution.
    """
    many = replace(board, draws=1000)
    (cell,) = many.cells(STEP)
    base = run_of(board, cell, values_of(board, cell)).configurations
    values = drawn(many, cell, base).values
    assert set(values["*.control_period"]) == set(PERIODS)
    faults = [each[0] for each in values["plant.faults"] if each]
    assert abs(len(faults) - 500) < 4 * np.sqrt(1000 * 0.25)
    found = [re.fullmatch(r"motor_share (\w+) (\S+) from (\S+)", each) for each in faults]
    wheels, shares, begins = zip(*(each.groups() for each in found if each), strict=True)
    assert set(wheels) == set(board.layouts["all"])
    assert (min(map(float, shares)) >= 0.0) and (max(map(float, shares)) <= 0.5)
    assert (min(map(float, begins)) >= 0.5) and (max(map(float, begins)) <= 1.0)
    others = replace(
        many,
        variations=[*many.variations, Variation("plant.sensors.wheel_speed.noise", value=[0, 1])],
    )
    assert drawn(others, cell, base).values["plant.faults"] == values["plant.faults"]


def counted(board: Board, cell: Cell, drawn_as: np.ndarray) -> dict[str, Varied]:
    """A law that costs nothing but 1 in some runs, and another one that always costs 1."""
    return differences_by_variation(
        board, [cell], {"cost": np.array([[drawn_as], [np.ones(board.draws)]], float)}
    )


@pytest.mark.parametrize(
    ("variation", "least", "most", "is_most"),
    [
        (
            Variation("*.vehicle.mass", factor=[1.0, 1.3]),
            "1 to 1.1",
            "1.2 to 1.3",
            lambda mass, car: mass >= 1.2 * car,
        ),
        (
            Variation(f"{YAW_RATE}.noise", value=[0.0, 0.3]),
            "0 to 0.1",
            "0.2 to 0.3",
            lambda x, _: x >= 0.2,
        ),
        (Variation(f"{YAW_RATE}.delay", count=[0, 2]), "0", "2", lambda x, _: x == 2),
        (Variation(f"{YAW_RATE}.delay", count=[0, 9]), "0 to 3", "6 to 9", lambda x, _: x >= 6),
        (
            Variation("*.control_period", choice=[0.005, 0.01, 0.02]),
            "0.005",
            "0.02",
            lambda x, _: x == 0.02,
        ),
        (
            Variation(MOTOR_FAULT, value=[0, 0.5], begin=[0.5, 1.0], probability=0.2),
            "none",
            "of one motor",
            lambda x, _: x,
        ),
    ],
    ids=["factor", "value", "count", "long count", "choice", "fault"],
)
def test_the_most_of_what_varies_is_found_in_what_is_driven(
    board: Board, variation: Variation, least: str, most: str, is_most: Callable
):
    """A cost of 1 in the runs with the most, and 0 elsewhere, differs by 1 without doubt."""
    many = replace(board, draws=100, variations=[variation])
    (cell,) = many.cells(STEP)
    base = run_of(many, cell, values_of(many, cell)).configurations
    name = "plant.faults" if variation.parameter == MOTOR_FAULT else variation.parameter
    of_car = base["plant"].values().get(name.partition(".")[2], 0.0)
    runs = np.array([bool(is_most(each, of_car)) for each in drawn(many, cell, base).values[name]])
    (found,) = counted(many, cell, runs).values()
    assert (found.least, found.most) == (least, most)
    assert found.differences["cost"] == [Difference(1.0, 0.0), Difference(0.0, 0.0)]


def test_what_a_board_does_not_vary_or_has_too_few_runs_of_makes_no_difference(board: Board):
    one = replace(board, variations=[Variation("*.control_period", choice=[0.005])])
    (cell,) = one.cells(STEP)
    assert counted(one, cell, np.zeros(DRAWS)) == {}
    few = replace(board, draws=1)
    words = [
        of.in_words(1.0, 2)
        for each in counted(few, cell, np.zeros(1)).values()
        for of in each.differences["cost"]
    ]
    assert words == ["-"] * 4


@pytest.mark.parametrize(("cells", "draws", "spread"), [(12, 10, 1.0), (12, 20, 3.0), (1, 10, 1.0)])
def test_differences_are_as_sure_as_they_say(cells: int, draws: int, spread: float):
    """Cells differ in cost, in their number of runs with the most, and in scatter.

    Of 600 boards 95 % within four standard deviations of a binomial distribution, or more of those
    with few runs: the freedom of the fewer runs is the careful choice.
    """
    random, effect, held = np.random.default_rng(1), 0.3, []
    for _ in range(600):
        with_most = random.random((cells, draws)) < 0.3
        noise = np.where(with_most, spread, 1.0) * random.standard_normal((cells, draws))
        values = 5.0 * random.random((cells, 1)) + effect * with_most + 0.5 * noise
        (found,) = mantel_haenszel(values[None], ~with_most, with_most)
        if not np.isnan(found.half):
            held.append(abs(found.value - effect) <= found.half)
    expected, deviation = 0.95 * len(held), np.sqrt(0.95 * 0.05 * len(held))
    assert len(held) > 450
    assert (
        expected - 4 * deviation
        < sum(held)
        < (expected + 4 * deviation if cells > 1 else len(held) + 1)
    )


def test_what_a_law_believes_is_its_own_factor_by_the_drawn_one(board: Board):
    """A law with half the friction as its own factor gets half of each drawn factor."""
    varied = replace(board, variations=[Variation(TOLD_FRICTION, factor=[0.7, 1.3])])
    (cell,) = varied.cells(STEP)
    base = run_of(varied, cell, values_of(varied, cell))
    draws = drawn(varied, cell, base.configurations)
    name = "electronic_differential.known.error_factor"
    for own in (1.0, 0.5):
        laws = {**varied.laws, "pi": {**varied.laws["pi"], "known.error_factor": own}}
        found = own_draws(law_of(replace(varied, laws=laws), "pi", base), draws)
        assert found == {name: [own * each for each in draws.believed]}
    chosen = replace(board, variations=[Variation(TOLD_FRICTION, choice=[0.7, 1.3])])
    assert set(drawn(chosen, cell, base.configurations).believed) == {0.7, 1.3}


def test_a_drawn_fault_comes_beside_those_of_the_run(board: Board):
    step, fault = board.manoeuvres["step_steer"], "motor_share front_left 0.500 from 0.00"
    limps = replace(step, values={**step.values, "plant.faults": [fault]})
    limping = replace(board, manoeuvres={"step_steer": limps})
    (cell,) = limping.cells(STEP)
    faults = drawn(
        limping, cell, run_of(limping, cell, values_of(limping, cell)).configurations
    ).values["plant.faults"]
    assert {each[0] for each in faults} == {fault}
    assert {len(each) for each in faults} == {1, 2}


PERIOD, MASS = "*.control_period", "*.vehicle.mass"


@pytest.mark.parametrize(
    ("variations", "values", "law", "line"),
    [
        (
            [Variation(MASS, factor=[1, 2])] * 2,
            {},
            {},
            f"the board varies {MASS}, and {MASS} is varied already",
        ),
        (
            [Variation("plant.initial_speed", value=[1, 2])],
            {"plant.initial_speed": 3.0},
            {},
            "manoeuvre step_steer sets plant.initial_speed, and plant.initial_speed is varied already",
        ),
        (
            [Variation(PERIOD, choice=PERIODS)],
            {},
            {"control_period": 0.02},
            f"law pi: it states electronic_differential.control_period, and {PERIOD} is varied already",
        ),
        (
            [],
            {},
            {"seed": 3},
            "law pi: it states electronic_differential.seed, and *.seed is varied already",
        ),
    ],
)
def test_nothing_that_is_stated_is_overwritten_by_what_is_drawn(
    board: Board, variations: list, values: dict, law: dict, line: str
):
    manoeuvres = {"step_steer": replace(board.manoeuvres["step_steer"], values=values)}
    laws = {**board.laws, "pi": {**board.laws["pi"], **law}}
    own = replace(board, variations=variations, manoeuvres=manoeuvres, laws=laws)
    (cell,) = own.cells(STEP)
    with pytest.raises(ParameterError, match=re.escape(line)):
        law_of(own, "pi", run_of(own, cell, values_of(own, cell)))


def test_a_manoeuvre_sets_no_parameter_that_a_law_plays_without(board: Board):
    """The law would have its default, and the printed line the manoeuvre's value."""
    step, law = board.manoeuvres["step_steer"], {"method": "equal_torque", "asr.method": "pi_slip"}
    values = {**step.values, "asr.method": "pi_slip", "asr.natural_frequency": 10.0}
    own = replace(
        board,
        manoeuvres={"step_steer": replace(step, values=values)},
        laws={**board.laws, "own": law},
    )
    with pytest.raises(
        ParameterError,
        match=r"step_steer sets asr\.natural_frequency, which law own does not take over",
    ):
        laws_in_cell(own, own.cells(STEP)[0], ["own"])


def test_what_is_searched_is_not_drawn(board: Board):
    searched = replace(board.manoeuvres["step_steer"], entry_speed=[5.0, 10.0])
    own = replace(
        board,
        manoeuvres={"step_steer": searched},
        variations=[Variation("plant.initial_speed", value=[1, 2])],
    )
    with pytest.raises(ParameterError, match=re.escape("the board varies plant.initial_speed")):
        values_of(own, own.cells(STEP)[0])


@pytest.mark.parametrize(
    ("changed", "line"),
    [
        (
            {"value": [0.5, 1.5]},
            "variation of motor_fault needs value and begin, expected two shares within 0 to 1",
        ),
        ({"begin": []}, "variation of motor_fault needs value and begin"),
        ({"probability": 1.5}, "variation of motor_fault has the probability 1.5, expected 0 to 1"),
        (
            {"choice": [0.1]},
            "variation of motor_fault has the bounds [0.0, 0.5], expected two that rise",
        ),
        (
            {"parameter": "friction"},
            "variation of friction has begin or probability, expected for motor_fault alone",
        ),
    ],
)
def test_what_is_wrong_is_one_line(path: Path, tmp_path: Path, changed: dict, line: str):
    content = yaml.safe_load(path.read_text())
    content["variations"] = [VARIATIONS[1] | changed]
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(yaml.safe_dump(content))
    with pytest.raises(ParameterError) as refused:
        read_board(str(wrong))
    assert str(refused.value).startswith(f"{wrong}: {line}")


ED = "electronic_differential"


@pytest.mark.parametrize(
    ("variation", "line"),
    [
        (
            Variation("driver.nothing", value=[0, 1]),
            "driver.nothing by value [0, 1]: unknown parameter of driver",
        ),
        (
            Variation("unknown.mass", value=[0, 1]),
            "unknown.mass by value [0, 1]: unknown role 'unknown'; known: *, asr,",
        ),
        (
            Variation("*.vehicle.masss", factor=[0.9, 1.1]),
            "*.vehicle.masss by factor [0.9, 1.1]: unknown parameter of plant 'vehicle.masss'; did you mean",
        ),
        (
            Variation("*.vehicle.wheelbase", factor=[-1.0, 1.0]),
            "*.vehicle.wheelbase by factor [-1.0, 1.0]: parameter vehicle.wheelbase: -2.6 is refused, expected",
        ),
        (
            Variation(f"{YAW_RATE}.delay", count=[0, 2000]),
            "plant.sensors.imu_yaw_rate.delay by count [0, 2000]: parameter sensors.imu_yaw_rate.delay: 2000 is",
        ),
        (
            Variation(PERIOD, choice=[0.01, 7.0]),
            f"{PERIOD} by choice [0.01, 7.0]: parameter control_period: 7.0 is",
        ),
        (
            Variation(f"{ED}.pi.bandwidth", factor=[0.5, 1.0]),
            f"{ED}.pi.bandwidth by factor [0.5, 1.0]: it is a number of a law, of which each has its own",
        ),
        (
            Variation(f"{ED}.known.error_factor", value=[0.5, 1.0]),
            f"{ED}.known.error_factor by value [0.5, 1.0]: it is what a law believes of the friction, expected told_",
        ),
    ],
)
def test_a_variation_that_does_not_fit_ends_the_board_before_anything_is_driven(
    board: Board, path: Path, variation: Variation, line: str
):
    """One line names the board's file, the variation and what is expected."""
    own = replace(board, variations=[variation])
    with pytest.raises(ParameterError) as refused:
        kept_cells(own, own.cells(STEP), ["pi"], {})
    assert str(refused.value).startswith(f"{path}: variation of {line}")


def test_ends_of_two_variations_that_fit_together_alone_are_driven(board: Board):
    """The mass centre of a car of twice the length is beyond the front axle of the other."""
    names = ("*.vehicle.wheelbase", "*.vehicle.centre_of_mass_to_rear_axle")
    own = replace(board, draws=1, variations=[Variation(name, factor=[2.0, 2.0]) for name in names])
    (cell,) = own.cells(STEP)
    kept_cells(own, [cell], ["pi"], {})
    assert drive_cell(own, cell, ["pi"]).laws["pi"].hashes != [""]
