"""Command line of a study: parameters that its cases set are theirs."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_core.parameters.declaration import Entry
from ev_msgs_py.refusal import ParameterError
from ev_stack.scenarios.files import scenario_names
from ev_stack.scenarios.scenario import load_scenario
from ev_study.studies.run_study import _refuse_what_it_sets, arguments, study_cases
from ev_study.studies.study import Case, run_of, study_named, study_names

CARS = str(Path(__file__).with_name("electric_cars.csv"))  # a car that does not exist
NEEDED = {"energy": (CARS,), "sweep": ("--seeds", "2")}  # words without which a study is refused


def cases_of(name: str, *words: str) -> list[Case]:
    return study_cases(study_named(name), arguments(name, words or NEEDED.get(name, ())))


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            "sweep double_lane_change --vary plant.initial_speed=15,20 --set plant.initial_speed=25",
            "plant.initial_speed is refused: case 'plant.initial_speed=15' sets plant.initial_speed itself",
        ),
        (
            "compare --method electronic_differential=equal_torque",
            "electronic_differential.method is refused: case 'adaptive' sets electronic_differential.method itself",
        ),
        (
            "sweep coast_down --seeds 3 --seed 7",
            "*.seed is refused: case 'seed=0' sets *.seed itself",
        ),
        (
            "five_methods --seeds 2 --set plant.road.seed=9",
            "plant.road.seed is refused: case 'method 1 tracking seed 1' sets plant.road.seed itself",
        ),
        (
            "asr_shootout --set plant.control_period=0.001",
            "plant.control_period is refused: case 'ice: off' sets *.control_period itself",
        ),
        (
            "faults --cycle nedc",
            "driver.speed_profile.file is refused: case 'none: adaptive, off, dry' sets driver.speed_profile.time "
            "itself",
        ),
        (
            "sweep coast_down --vary plant.initial_speed=20,20",
            "case 'plant.initial_speed=20' is there twice",
        ),
        (
            "five_methods --drivers pulse pulse",
            "case 'method 1 pulse seed 1' is there twice, expected once",
        ),
        (
            "sweep coast_down --vary plant.initial_speed=20 --vary plant.initial_speed=30",
            "--vary 'plant.initial_speed=30' is refused: plant.initial_speed varies already, expected once",
        ),
        (
            "sweep coast_down --vary plant.seed=5,6 --seeds 2",
            "--vary 'plant.seed=5,6' is refused: *.seed varies already",
        ),
        (
            "sweep coast_down --vary plant.initial_speed=1:2:0",
            "--vary 'plant.initial_speed=1:2:0' is refused, expected a COUNT from 2",
        ),
        (
            "sweep coast_down --vary plant.road.left=[ice",
            "--vary 'plant.road.left=[ice' is refused, expected x,y,z",
        ),
        (
            f"energy {CARS} --duration 60",
            "--duration 60 is refused: what was measured is of whole cycles",
        ),
        (
            "faults --duration 4",
            "--duration 4 is refused: what this study measures comes later, expected 5 s",
        ),
        (
            "bench_difference --duration 1",
            "--duration 1 is refused: what this study measures comes later",
        ),
        (
            "bench_convergence --duration 1",
            "--duration 1 is refused: what this study measures comes later",
        ),
        (
            "bench_faults --duration 1",
            "--duration 1 is refused: what this study measures comes later",
        ),
        (
            "asr_shootout --duration 0.9",
            "--duration 0.9 is refused: what this study measures comes later",
        ),
    ],
)
def test_what_a_case_sets_itself_is_refused_in_one_line(words, message):
    """Rows never stand under a value, a law or a seed that they do not have."""
    with pytest.raises(ParameterError) as error:
        cases_of(*words.split())
    assert str(error.value).startswith(message) and "\n" not in str(error.value)


def test_a_file_of_parameters_does_not_take_the_place_either(tmp_path):
    file = tmp_path / "more.yaml"
    file.write_text("/**/driver:\n  ros__parameters:\n    speed_profile: {file: cycles/nedc.csv}\n")
    with pytest.raises(ParameterError, match=r"^\*\.speed_profile\.file is refused: case 'none: "):
        cases_of("faults", "--params", str(file))


@pytest.mark.parametrize("name", study_names())
def test_names_differ_and_what_a_case_sets_is_its_own(name):
    """Values of a study's first case are refused for its node and for every node."""
    cases = cases_of(name)
    assert len({case.name for case in cases}) == len(cases) > 0
    for node, parameter, _ in cases[0].values:
        for place in (node, "*"):
            with pytest.raises(ParameterError, match=r"refused: case .* itself$"):
                _refuse_what_it_sets(cases[0], [(place, parameter)])


def test_what_no_case_sets_is_that_of_all():
    cases = cases_of(
        "sweep", "coast_down", "--vary", "plant.initial_speed=20,30", "--set", "plant.step=0.001"
    )
    assert [case.values for case in cases] == [
        (("plant", "initial_speed", speed), ("plant", "step", 0.001)) for speed in (20, 30)
    ]


def test_names_have_all_digits_and_lists_are_values():
    given = ["coast_down", "--vary", "plant.initial_speed=15.00001,15.00002"]
    assert [case.name for case in cases_of("sweep", *given)] == [
        "plant.initial_speed=15.00001",
        "plant.initial_speed=15.00002",
    ]
    lists = cases_of("sweep", "coast_down", "--vary", "plant.road.left=[ice,dry_asphalt],[ice]")
    assert [value for case in lists for *_, value in case.values] == [
        ["ice", "dry_asphalt"],
        ["ice"],
    ]


def assert_driven_as_it_says(case: Case) -> None:
    """Check that the run has the values of its case: setting them again changes nothing."""
    played = run_of(case).configurations
    settings = {
        (role, name): value
        for node, name, value in case.values
        for role in played
        if node in ("*", role)
    }
    for (role, name), value in settings.items():
        if name in (has := played[role].values()):
            assert played[role].changed({name: value}).values() == has, (case.name, role, name)


@pytest.mark.sampled
@pytest.mark.parametrize("name", study_names())
def test_the_cases_of_a_study_are_driven_as_they_say(name):
    cases = cases_of(name)
    for in_order in (cases, reversed(cases)):
        assert_driven_as_it_says(next(case for case in in_order if is_accepted(case)))


def is_accepted(case: Case) -> bool:
    """Return True if the car can be driven by it.

    `compare` offers laws of other cars as well, and lists them as refused.
    """
    try:
        return bool(run_of(case))
    except ParameterError:
        return False


def values_of(entry: Entry) -> Iterator[str]:
    """Some values that are allowed, as words of a command line."""
    low, high = entry.spec.low, entry.spec.high
    if entry.spec.choices:
        yield from entry.spec.choices
    elif entry.type is bool:
        yield from ("true", "false")
    elif entry.type in (int, float) and low is not None and high is not None:
        value = (low + high) / 3.0
        yield f"[{value}]" if entry.is_array else str(entry.type(value))


@settings(max_examples=15)
@given(st.data())
def test_a_row_stands_under_what_was_driven_or_is_refused(data):
    """It holds for any parameter of any scenario, with another car, cycle or file."""
    scenario = data.draw(st.sampled_from(scenario_names()))
    run = load_scenario(scenario).runs[0]
    role = data.draw(st.sampled_from(sorted(run.configurations)))
    common = ("control_period", "duration", "vehicle.", "mode", "sensors.")
    own = [
        e
        for e in run.configurations[role].entries()
        if not e.name.startswith(common) and any(values_of(e))
    ]
    entry = data.draw(st.sampled_from(own))
    value = data.draw(st.sampled_from([*values_of(entry)]))
    more = data.draw(st.sampled_from([(), ("--vehicle", "compact_ev"), ("--cycle", "nedc")]))
    try:
        for case in cases_of("sweep", scenario, "--vary", f"{role}.{entry.name}={value}", *more):
            assert_driven_as_it_says(case)
    except ParameterError as error:
        assert "\n" not in str(error)


def test_an_angle_that_a_study_sets_stays_with_another_car():
    """The slow ramp does not replace it: rows of 1.0 and 2.0 are driven with these."""
    words = ("step_steer", "--vehicle", "compact_ev")
    varied = cases_of("sweep", *words, "--vary", "steering_column.scale=1.0,2.0")
    varied += cases_of("sweep", *words, "--set", "steering_column.scale=3.0", "--seeds", "2")
    assert [run_of(case).configurations["steering_column"].parameters.scale for case in varied] == [
        1.0,
        2.0,
        3.0,
        3.0,
    ]


@pytest.mark.parametrize("words", [("--cycle", "nedc"), ()])
def test_points_under_a_file_are_refused(words, tmp_path):
    """They would do nothing: scenario or command line name the file of the cycle."""
    scenario = "urban_mixed" if words else str(tmp_path / "own.yaml")
    (tmp_path / "p.csv").write_text("t_s,v_mps\n0,1\n10,2\n")
    text = f"/**/driver: {{ros__parameters: {{speed_profile: {{file: {tmp_path / 'p.csv'}}}}}}}\n"
    (tmp_path / "own.yaml").write_text(f"/**/scenario: {{ros__parameters: {{about: a}}}}\n{text}")
    with pytest.raises(ParameterError, match=r"speed_profile\.(file|speed) is refused"):
        for case in cases_of(
            "sweep",
            scenario,
            "--vary",
            "driver.speed_profile.speed=[1.0,2.0,3.0,4.0],[4.0,3.0,2.0,1.0]",
            *words,
        ):
            run_of(case)
