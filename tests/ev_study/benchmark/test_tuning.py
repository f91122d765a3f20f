"""Tuning: declared bounds, a falling cost, equal bits, a search that can be stopped."""

from __future__ import annotations

import argparse
import csv
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ev_core.parameters.data_file import files_in_config
from ev_core.parameters.declaration import parameter
from ev_msgs_py.refusal import ParameterError
from ev_stack.recording.outcome import RunFailed
from ev_stack.scenarios.scenario import load_scenario
from ev_study.benchmark.board import ROLE, read_board
from ev_study.benchmark.cell_runs import law_of, run_of, values_of
from ev_study.benchmark.driving import drive_cell
from ev_study.commands import tune
from ev_study.commands.benchmark import run_benchmark
from ev_study.commands.tune import run_tune, search_key
from ev_study.tuning.free import Free, free_parameters
from ev_study.tuning.search import chosen, search
from ev_study.tuning.training import Reference, Training, robust_cost

EXAMPLE = Path(__file__).parents[3] / "docs" / "examples" / "yaw_moment.py"
CELL = "layout_1_8_c:all:step_steer:wet:*"
WORDS = ["pi", "--free", "pi.*,wanted.lag", "--cells", CELL, "--draws", "1", "--budget", "9"]
SMALL = read_board("small")
SMALL = replace(
    SMALL, draws=1, laws={**SMALL.laws, "asr": {**SMALL.laws["pi"], "asr.method": "pi_slip"}}
)


@pytest.fixture(scope="module")
def reference() -> list:
    return [drive_cell(SMALL, cell, [SMALL.reference]) for cell in SMALL.cells(CELL)]


@pytest.fixture(scope="module")
def training(reference: list) -> Training:
    return Training(SMALL, "pi", reference, "handling", threads=None)


def configurations(law: str) -> dict:
    """A law by role, for the last car."""
    cell = SMALL.cells()[-1]
    return law_of(SMALL, law, run_of(SMALL, cell, values_of(SMALL, cell)))


def history(folder: Path) -> list[list[str]]:
    """Rows of the history behind its head."""
    with (folder / "pi_history.csv").open() as file:
        return list(csv.reader(file))[1:]


def test_shares_are_values_within_the_bounds():
    """Factors around a positive start, sums around any other one; the start has its own share."""
    by_factors, by_sums = Free("gain", 10.0, 0.1, 1000.0), Free("offset", 0.0, -1.0, 3.0)
    assert (by_factors.share, by_factors.value(0.5)) == (pytest.approx(0.5), pytest.approx(10.0))
    assert (by_factors.value(-1.0), by_factors.value(2.0)) == (0.1, 1000.0)
    assert (by_sums.share, by_sums.value(0.25), by_sums.value(1.0)) == (0.25, 0.0, 3.0)


def test_bounds_are_those_of_the_declaration_and_two_decades():
    """pi.bandwidth: 10, expected 0 to 200; wanted.lag: 0.05, expected 0.001 to 1."""
    lag, bandwidth = free_parameters("pi", configurations("pi"), ["pi.bandwidth", "wanted.lag"])
    assert (bandwidth.low, bandwidth.high) == (pytest.approx(0.1), 200.0)
    assert (lag.low, lag.high) == (0.001, 1.0)
    with pytest.raises(ParameterError, match="unknown number of law pi 'x"):
        free_parameters("pi", configurations("pi"), ["x*"])
    with pytest.raises(ParameterError, match="of law pi mean 1, expected two or more"):
        free_parameters("pi", configurations("pi"), ["wanted.lag"])


def test_a_number_that_does_nothing_without_an_option_is_no_number_to_search():
    """Gains of the speed control do without speed mode what they do at any value."""
    (run,) = load_scenario("double_lane_change").runs
    with pytest.raises(ParameterError, match=r"unknown number of law off 'plant\.speed_control"):
        free_parameters("off", run.configurations, ["plant.speed_control.*"])


def test_a_number_without_bounds_is_searched_around_a_positive_start_and_else_refused():
    """Bounds are optional in a law of one's own; a start of 0 has no scale by itself."""

    @dataclass(frozen=True)
    class Parameters:
        gain: float = parameter(4.0, about="gain")
        lag: float = parameter(0.2, low=0.1, about="lag")
        offset: float = parameter(0.0, about="offset")
        bounded: float = parameter(0.0, low=-1.0, high=1.0, about="bounded offset")
        fixed: float = parameter(1.0, low=1.0, high=1.0, about="that cannot change")

    without_options = SimpleNamespace(is_idle=lambda name: False)
    own = {ROLE: SimpleNamespace(parameters=Parameters(), method=without_options)}
    gain, lag, bounded = free_parameters("own", own, ["gain", "lag", "bounded"])
    assert (gain.low, gain.high, lag.low, lag.high) == (0.04, 400.0, 0.1, 20.0)
    assert (bounded.low, bounded.high, bounded.share) == (-1.0, 1.0, 0.5)
    assert gain.value(gain.share) == pytest.approx(gain.start)
    with pytest.raises(
        ParameterError,
        match=r"^number offset of law own starts at 0 and has no bounds on both sides, ",
    ):
        free_parameters("own", own, ["*"])
    with pytest.raises(
        ParameterError, match=r"^number fixed of law own has nothing between 1 and 1, expected a ra"
    ):
        free_parameters("own", own, ["gain", "lag", "fixed"])


def test_every_law_that_is_tuned_has_the_numbers_that_are_free():
    """All of the closed division are, by the numbers of their controllers."""
    for law, patterns in SMALL.tuned.items():
        free_parameters(law, configurations(law), patterns)
    assert set(SMALL.tuned) >= set(SMALL.closed)


def test_numbers_of_the_traction_control_are_free_as_well(reference: list):
    """Under the name that the board has for them; the bounds are those of its declaration."""
    of_asr = Training(SMALL, "asr", reference, "handling", threads=None)
    free = free_parameters("asr", configurations("asr"), ["asr.natural_frequency", "pi.bandwidth"])
    assert {each.name.partition(".")[0] for each in free} == {"asr", "pi"}
    costs = of_asr.costs([{each.name: each.start for each in free}] * 2)
    assert costs[0] == costs[1] < 3.0


def test_the_cost_is_what_ranks():
    """Middle half 1, worst of eight runs 3, of which a tenth counts.

    No run between them changes it.
    """
    costs = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 2.0, 3.0])
    assert robust_cost(costs) == pytest.approx(1.0 + 0.1 * 3.0)


def test_other_runs_choose_among_the_best(training: Training, monkeypatch: pytest.MonkeyPatch):
    """The start stays unless one of the best candidates is better.

    No other candidates are driven.
    """
    free = free_parameters("pi", configurations("pi"), ["pi.*"])
    monkeypatch.setattr(
        Training, "costs", lambda self, found: np.array([each["pi.bandwidth"] for each in found])
    )
    found = list(search(training, free, 12, 1, lambda shares, compute: compute(shares)))
    asked = []

    def growing(shares: np.ndarray, compute: object) -> np.ndarray:
        asked.extend(shares)
        return np.arange(float(len(shares)))

    best, cost, before = chosen(found, training, free, 3, growing)
    assert (best.values, cost, before, len(asked)) == (found[0].values, 0.0, 0.0, 4)
    best, cost, _ = chosen(
        found, training, free, 3, lambda shares, compute: -np.arange(float(len(shares)))
    )
    assert (best.cost, cost) == (sorted(each.cost for each in found[1:])[2], -3.0)


def test_candidates_are_judged_one_by_one_and_misfits_cost_most(training: Training):
    """first_sideslip above last_sideslip is refused by the law.

    It is not driven, and its neighbours do not notice.
    """
    one, misfit, other = (
        {"wanted.first_sideslip": 0.05},
        {"wanted.first_sideslip": 0.3},
        {"wanted.first_sideslip": 0.03},
    )
    costs = training.costs([one, misfit, other])
    assert costs[1] == pytest.approx(3.3)  # unstable in all runs
    assert training.of_reference == pytest.approx(1.1)  # stable in all runs
    assert costs.tolist() == [*training.costs([one]), costs[1], *training.costs([other])]


@pytest.mark.weekly
def test_a_stopped_search_goes_on_and_gives_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
):
    """Stopped in its second generation.

    The cost falls, and the parameter file brings it onto the board.
    """
    whole, stopped = tmp_path / "whole", tmp_path / "stopped"
    run_tune([*WORDS, "--out", str(whole)])
    assert "\nequal_torque in these 1.1000 and 1.1000\n" in capsys.readouterr().out
    costs, calls = Training.costs, list[int]()

    def interrupted(self: Training, candidates: list) -> np.ndarray:
        calls.append(len(candidates))
        if len(calls) == 2:
            raise KeyboardInterrupt
        return costs(self, candidates)

    monkeypatch.setenv("EV_STACK_RESULTS", str(tmp_path / "results"))
    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(Training, "costs", interrupted)
        run_tune([*WORDS, "--out", str(stopped)])
    with monkeypatch.context() as patch:  # what the reference costs is kept, too
        patch.delattr("ev_study.tuning.training.drive_cell")
        run_tune([*WORDS, "--out", str(stopped)])
    assert "went on behind 1 generations" in capsys.readouterr().out
    rows = history(whole)
    assert history(stopped) == rows
    assert len(rows) == 9
    assert min(float(row[1]) for row in rows) < float(rows[0][1])
    tuned = f"pi={whole / 'pi_tuned.yaml'}"
    words = [
        "--add",
        tuned,
        "--laws",
        "pi",
        "--cells",
        CELL,
        "--draws",
        "1",
        "--no-report",
        "--out",
        str(tmp_path / "b"),
    ]
    run_benchmark(words)
    assert "pi_tuned" in capsys.readouterr().out


def test_candidates_are_held_against_the_reference_in_their_own_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Other cars validate than train.

    The reference is asked for by the numbers of the cells of both.
    """
    made: list[Training] = []

    class Noted(Training):
        def __init__(self, *given: object) -> None:
            super().__init__(*given)
            made.append(self)

    monkeypatch.setattr("ev_study.commands.tune.Training", Noted)
    run_tune([*WORDS, "--budget", "2", "--out", str(tmp_path)])
    assert len(made) == 2
    for each in made:
        for _, of in each._cells:
            (alone,) = Reference(each._board, [of.cell], None).driven(
                lambda points, compute: compute(points)
            )
            for name, values in alone.metrics[SMALL.reference].items():
                assert np.array_equal(values, of.metrics[SMALL.reference][name], equal_nan=True), (
                    of.cell,
                    name,
                )


def test_a_search_goes_on_only_while_no_file_of_its_runs_has_changed(tmp_path: Path):
    """A vehicle and a law file, which only their contents tell apart from what they were."""
    car, law = tmp_path / "car.yaml", tmp_path / "own.py"
    car.write_text(files_in_config("vehicles")["layout_1_8_c"].read_text())
    law.write_text(EXAMPLE.read_text())
    board = replace(SMALL, cars=[f"{car}:all"], laws={**SMALL.laws, "own": {"method": str(law)}})
    reference = Reference(board, board.cells("*:step_steer:wet:*"), threads=None)
    given = argparse.Namespace(cost="handling", seed=1)

    def key() -> str:
        of = search_key([reference], "own", [], given)
        # The second law of a command begins hours later.
        assert {str(car), str(law)} <= set(of.files)
        return of.digest

    keys = [key(), key()]
    for file, old, new in ((car, "mass: 1600.0", "mass: 1700.0"), (law, '"""A law', '"""The law')):
        file.write_text(file.read_text().replace(old, new, 1))
        keys.append(key())
    assert keys[0] == keys[1]
    assert len({*keys}) == 3


def test_a_car_that_is_edited_during_a_search_ends_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The next law would be driven with the other car, and its answers kept as those of this one."""
    car, board = tmp_path / "car.yaml", tmp_path / "board.yaml"
    car.write_text(files_in_config("vehicles")["layout_1_8_c"].read_text())
    text = files_in_config("benchmarks")["small"].read_text()
    board.write_text(text.replace("layout_1_8_c", str(car)))
    words = ["pi", "lqr", "--board", str(board), "--cells", "*:step_steer:wet:*", "--draws", "1"]
    tuned = tune._tune

    def then_edited(*given: object) -> None:
        tuned(*given)
        car.write_text(car.read_text().replace("mass: 1600.0", "mass: 1700.0"))

    monkeypatch.setattr(tune, "_tune", then_edited)
    with pytest.raises(RunFailed, match=r"car\.yaml has changed since the runs began"):
        run_tune([*words, "--budget", "2", "--out", str(tmp_path / "out")])
    assert (tmp_path / "out" / "pi_tuned.yaml").exists()
    assert not (tmp_path / "out" / "lqr_tuned.yaml").exists()


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["none"], "unknown electronic_differential method 'none'"),
        (["pi", "lqr", "--free", "pi.*,none"], "unknown number of law pi 'none'"),
        (["pi", "--free", ""], "unknown number of law pi ''"),
        (["pi", "--board", "full", "--cells", "*:skidpad:dry:*"], "--cells leaves none to tune on"),
    ],
)
def test_what_cannot_be_tuned_is_one_line(words: list[str], line: str, tmp_path: Path):
    with pytest.raises(ParameterError) as refused:
        run_tune([*words, "--out", str(tmp_path)])
    assert line in str(refused.value)


@pytest.mark.parametrize(
    ("command", "words", "expected"),
    [
        (run_tune, ["pi", "--budget", "1"], "--budget: '1' is refused, expected a whole number, 2"),
        (run_tune, ["pi", "--draws", "0"], "--draws: '0' is refused, expected a whole number, 1"),
        (run_benchmark, ["--draws", "0"], "--draws: '0' is refused, expected a whole number, 1"),
        (run_benchmark, ["--held-out", "-1"], "--held-out: '-1' is refused"),
        (run_benchmark, ["--workers", "0"], "--workers: '0' is refused"),
    ],
)
def test_a_number_out_of_bounds_ends_a_command_at_once(command, words, expected, capsys):
    with pytest.raises(SystemExit):
        command(words)
    assert expected in capsys.readouterr().err
