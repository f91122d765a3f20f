"""The full board beyond the small one.

Entry speeds by bisection, steering angles of each car, friction jumps.
"""

from __future__ import annotations

import shlex
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from ev_core.parameters.data_file import files_in_config
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError
from ev_stack.batches.by_period import batch_by_period
from ev_stack.command_line.options import arguments, overrides
from ev_stack.measures import motion
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording, signal_hash
from ev_stack.scenarios.scenario import load_scenario
from ev_study.benchmark import entry_speed
from ev_study.benchmark.added import check_laws
from ev_study.benchmark.board import CASES, Board, read_board
from ev_study.benchmark.cell_runs import run_of, values_of
from ev_study.benchmark.draws import drawn
from ev_study.benchmark.driving import drive_cell, drive_law, laws_in_cell
from ev_study.benchmark.entry_speed import CLEAN, END, HASH, at_speeds, clean, last_true
from ev_study.benchmark.held_out import with_cases
from ev_study.benchmark.ranking.law_pages import overview
from ev_study.benchmark.ranking.result import BoardResult

CAR = "layout_1_8_c:all"
HALVINGS = 3
RESOLUTION = (32.0 - 12.0) / 2**HALVINGS  # m/s


@pytest.fixture(scope="module")
def board() -> Board:
    """The full board with few draws and few halvings."""
    full = read_board("full")
    lanes = replace(full.manoeuvres["double_lane_change"], halvings=HALVINGS)
    return replace(full, draws=2, manoeuvres={**full.manoeuvres, "double_lane_change": lanes})


def driven(board: Board, pattern: str) -> Recording:
    """The nominal car of a cell with equal torques."""
    (cell,) = board.cells(f"{CAR}:{pattern}:handling:*")
    run = run_of(board, cell, values_of(board, cell))
    return run_offline(run.configurations, run.duration)


def test_every_cell_has_a_graph_and_draws(board: Board):
    cells = board.cells("*:handling:*")
    assert len(cells) == 5 * 36 - 11
    assert {cell.manoeuvre for cell in cells if cell.car == "racing_car:all"}.isdisjoint(
        {"launch", "brake"}
    )
    for cell in cells[::11]:  # names and values do not depend on the car and the road alone
        assert drawn(board, cell, run_of(board, cell, values_of(board, cell)).configurations).values


@pytest.mark.parametrize("entry", CASES)
def test_every_law_suits_the_cars_of_all_cases(board: Board, entry: str):
    """No case has a differential in a driven axle, which no yaw moment control drives."""
    check_laws(with_cases(board, entry, 7), list(board.laws), [])


def test_the_entry_speed_is_clean_and_the_next_one_is_not(board: Board):
    """The metric is the speed at which the run of the board begins, for each draw and law.

    Here runs go on to 14 s whatever happens, so that nothing hangs on when a run ends.
    """
    (cell,) = board.cells(f"{CAR}:double_lane_change:dry:handling:*")
    found = drive_cell(board, cell, ["equal_torque", "pi"])
    for law, runs in laws_in_cell(board, cell, ["equal_torque", "pi"]).items():
        speeds = found.metrics[law]["entry_speed"]
        assert found.laws[law].clean.all()
        assert ((speeds > 12.0) & (speeds < 32.0)).all()
        for more, are_clean in ((0.0, 1.0), (RESOLUTION, 0.0)):
            vary = {**runs.vary, **at_speeds(speeds + more)}
            driven = batch_by_period(
                runs.run.configurations, 14.0, vary, metrics=[clean(board, runs.run)]
            )
            assert (driven.metrics[CLEAN] == are_clean).all()


def test_a_run_that_ended_early_is_driven_again_by_its_command(board: Board):
    """Bits agree up to the whole second at which the car is behind the last cone, rear included."""
    (cell,) = board.cells(f"{CAR}:double_lane_change:dry:handling:*")
    found = drive_cell(board, cell, ["pi"])
    given = arguments([*shlex.split(found.laws["pi"].commands[1])[1:], "--offline"])
    run = load_scenario(given.scenario, overrides(given), given.run).runs[0]
    signals = run_offline(run.configurations, run.duration)
    assert signal_hash(signals) == found.laws["pi"].hashes[1]
    assert run.duration == signals.time[-1] < 14.0
    x = signals.channels["pose.x"]
    rear = (
        run.configurations["plant"].common.vehicle.centre_of_mass_to_rear_axle + run.course.overhang
    )
    assert x[-1] - rear >= run.course.end[-1] > x[signals.time <= run.duration - 1.0][-1] - rear
    words, alone = drive_law(
        replace(board, draws=1), cell, laws_in_cell(board, cell, ["pi"])["pi"].only(1)
    )
    assert shlex.join(words[0]) == found.laws["pi"].commands[1]
    assert alone[HASH].tolist() == [signal_hash(signals)]


@pytest.mark.parametrize(
    "path", sorted(files_in_config("benchmarks/tuned").values()), ids=lambda path: path.stem
)
def test_its_laws_have_the_tuned_numbers(board: Board, path: Path):
    """They agree to four digits."""
    tuned = yaml.safe_load(path.read_text())["/**/electronic_differential"]["ros__parameters"]
    law = board.laws[path.stem.removesuffix("_tuned")]
    assert {name: law[name] for name in tuned} == pytest.approx(tuned, rel=5e-4)


def test_both_laws_that_know_all_differ_in_their_reference_alone(board: Board):
    assert board.laws["all_known_neutral"] == {
        **board.laws["lqr_all_known"],
        "reference": "neutral",
    }


@pytest.mark.parametrize("count", [2, 4, 64])
@pytest.mark.parametrize("start", [0, 1, 31, 63, 64])
def test_the_last_place_is_found_from_any_start(count: int, start: int):
    """Whatever is true up to it, each place between the ends is asked for once."""
    last, asked = np.arange(count), []

    def is_true(rows: np.ndarray, places: np.ndarray) -> np.ndarray:
        asked.extend(zip(rows.tolist(), places.tolist(), strict=True))
        return places <= last[rows]

    assert last_true(count, np.full(count, start), is_true).tolist() == last.tolist()
    assert len(asked) == len(set(asked))
    assert all(0 < place < count for _, place in asked)


def test_all_that_is_kept_of_a_search_is_of_the_run_at_the_speed_it_found(
    board: Board, monkeypatch
):
    """Metrics, hash and end.

    Of a draw that is clean nowhere those of the lowest speed, also where that run failed.
    """
    limits, fails = np.array([31.0, 25.3, 14.6, 11.0, 5.0]), np.array([99.0, 26.0, 14.7, 99.0, 0.0])
    runs = np.zeros(5)

    def drive(_board, _manoeuvre, _run, vary, _threads) -> dict[str, np.ndarray]:
        speeds, draws = np.array(vary[f"{MASTER}.initial_speed"]), np.array(vary.get("draw", [0]))
        runs[draws] += "draw" in vary  # the nominal car is no draw
        number = np.where(speeds > fails[draws], np.nan, speeds)
        hashes = np.array([str(speed) for speed in number.tolist()], object)
        return {"entry_speed": number, CLEAN: number <= limits[draws], HASH: hashes, END: number}

    monkeypatch.setattr(entry_speed, "drive", drive)
    lanes = replace(board.manoeuvres["double_lane_change"], halvings=6)
    at, found = entry_speed.at_highest_clean(
        replace(board, draws=5), lanes, None, {"draw": [*range(5)]}, None
    )
    speeds = at[f"{MASTER}.initial_speed"]
    assert speeds == [30.75, 25.125, 14.5, 12.0, 12.0]  # 12 m/s and multiples of 20/64 m/s
    assert found[CLEAN].tolist() == [True, True, True, False, False]
    assert found[HASH].tolist() == [*map(str, speeds[:4]), "nan"]
    for name in ("entry_speed", END):
        assert np.array_equal(found[name], [*speeds[:4], np.nan], equal_nan=True)
    assert found[entry_speed.DRIVEN].tolist() == runs.tolist()


def test_a_car_that_is_clean_at_no_speed_counts_as_unstable(board: Board):
    """Too fast at the lowest speed: its run is driven all the same, and is not clean."""
    lanes = replace(board.manoeuvres["double_lane_change"], entry_speed=[42.0, 44.0], halvings=1)
    hard = replace(board, draws=1, manoeuvres={**board.manoeuvres, "double_lane_change": lanes})
    (cell,) = hard.cells(f"{CAR}:double_lane_change:wet:handling:*")
    assert drive_cell(hard, cell, ["equal_torque"]).laws["equal_torque"].clean.tolist() == [False]


def test_a_run_is_held_against_the_road_of_its_own_driver(board: Board):
    """Skidpad at 8.5 m/s, 0.5 m off the middle: clean on a road of 1.5 m, not on one of 0.8 m."""
    (cell,) = board.cells(f"{CAR}:skidpad:dry:handling:*")
    runs, manoeuvre = (
        laws_in_cell(board, cell, ["equal_torque"])["equal_torque"],
        board.manoeuvres["skidpad"],
    )
    vary = at_speeds(np.full(2, 8.5)) | {"driver.path.width": [0.8, 1.5]}
    found = entry_speed.drive(board, manoeuvre, runs.run, vary, None)
    assert found[CLEAN].tolist() == [0.0, 1.0]
    assert found[END][0] < found[END][1] == manoeuvre.duration


def test_a_lap_is_driven_with_its_highest_clean_scale(board: Board):
    """0.825 is faster than 0.7: less than 59 s; 0.7 takes 60 s."""
    quick = replace(board.manoeuvres["lap"], speed_scale=[0.7, 0.95], halvings=1, duration=65.0)
    few = replace(board, draws=1, variations=[], manoeuvres={**board.manoeuvres, "lap": quick})
    (cell,) = few.cells(f"{CAR}:lap:dry:handling:*")
    found = drive_cell(few, cell, ["equal_torque"])
    assert found.laws["equal_torque"].clean.all()
    assert 45.0 < found.metrics["equal_torque"]["lap_time"][0] < 59.0


def test_what_is_recorded_counts_in_no_cost(board: Board):
    """Understeer as designed takes more angle than that of the car with equal torques.

    Its medians are written.
    """
    # which a ramp does not have
    ramp, more = board.manoeuvres["slow_ramp"], ["way [m] = last(pose.x)", "lap_time"]
    ramp = replace(ramp, recorded=[*ramp.recorded, *more])
    one = replace(board, draws=1, variations=[], manoeuvres={"slow_ramp": ramp})
    (cell,) = one.cells(f"{CAR}:slow_ramp:dry:handling:*")
    result = BoardResult(
        one, ["equal_torque", "pi"], [drive_cell(one, cell, ["equal_torque", "pi"])]
    )
    plain, designed = result.recorded["understeer_gradient"]
    assert designed > 2.0 * plain > 0.0
    assert result.as_json()["recorded"]["pi"]["understeer_gradient"] == designed
    assert any(
        line.startswith("| pi |") and f"{designed:.3g}" in line
        for line in overview(result).splitlines()
    )
    assert set(result.recorded) == {
        "understeer_gradient",
        "torque_activity",
        "high_friction_use",
        "way",
        "lap_time",
    }
    assert result.recorded["way"][0] > 0.0
    assert result.as_json()["recorded"]["pi"]["lap_time"] is None
    unrecorded = replace(one, manoeuvres={"slow_ramp": replace(ramp, recorded=[])})
    again = BoardResult(unrecorded, result.laws, result.cells)
    assert {cost: of.tolist() for cost, of in again.costs.items()} == {
        c: of.tolist() for c, of in result.costs.items()
    }


def test_the_step_is_that_of_the_very_car(board: Board):
    """4 m/s^2 in the end (ISO 7401): 5 % for what is not steady yet 3 s after the step."""
    run = driven(board, "step_steer:dry")
    assert motion.lateral_acceleration_on_path(run)[-1] == pytest.approx(4.0, rel=0.05)


def test_the_friction_jumps_where_the_road_has_it(board: Board):
    """Dry to wet asphalt after 100 m, at all wheels: the peaks of the curves are as 1 to 0.67."""
    run = driven(board, "friction_jump_in_bend:dry_to_wet")
    friction = run.channels["tire_forces.friction_coefficient.front_left"]
    assert friction[-1] / friction[0] == pytest.approx(0.670, abs=0.001)
    jump = motion.distance_on_path(run)[np.flatnonzero(np.diff(friction))]
    assert jump == pytest.approx([100.0], abs=3.0)  # the wheel is before the centre of mass


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        (
            "entry_speed: [12.0, 32.0]",
            "entry_speed: [32.0, 12.0]",
            "entry_speed of double_lane_change is [32.0, 12.0]",
        ),
        (
            "entry_speed: [12.0, 32.0]",
            "halvings: 4",
            "entry_speed of double_lane_change is measured, expected with",
        ),
        ("steering_on: dry ", "steering_on: mud ", "unknown road of step_steer 'mud'"),
        (
            'without: ["racing_car:all"]',
            "without: [kart]",
            "unknown car of power_on_in_bend 'kart'",
        ),
        (
            "speed_scale: [0.5, 1.1]",
            "speed_scale: [0.5]",
            "speed_scale of lap is [0.5], expected two numbers that rise",
        ),
        ("length: [100.0]", "length: []", "road dry_to_wet needs as many surfaces left as right"),
    ],
)
def test_what_is_wrong_is_one_line(tmp_path: Path, old: str, new: str, line: str):
    path, text = tmp_path / "own.yaml", files_in_config("benchmarks")["full"].read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(ParameterError) as refused:
        read_board(str(path))
    assert str(refused.value).startswith(f"{path}: {line}")
