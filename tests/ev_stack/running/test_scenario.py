"""Scenarios: files and command line resolved to configured graphs."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

import ev_stack
from ev_core.parameters.data_file import config_folders
from ev_msgs_py.contract.roles import REQUIRED
from ev_msgs_py.refusal import ParameterError
from ev_stack.command_line.options import arguments, overrides
from ev_stack.commands.run_scenario import main
from ev_stack.measures.derived import SERIES
from ev_stack.recording.offline import written_topics
from ev_stack.scenarios.about import describe_scenario
from ev_stack.scenarios.curves import DEFAULT
from ev_stack.scenarios.files import scenario_names
from ev_stack.scenarios.scenario import Overrides, load_scenario
from ev_study.studies.run_study import arguments as study_arguments
from ev_study.studies.run_study import study_cases
from ev_study.studies.study import study_named

CONFIG = config_folders()[-1]
ODD = [
    "../x",
    "a/b",
    "",
    ".",
    "summary.json",
    "x\x1b[31m",
    "1",
    "n" * 101,
    "a\n",
    "é",
]
HEAD = "/**/scenario:\n  ros__parameters: {about: a test, duration: 2.0}\n"


@pytest.fixture
def config(tmp_path, monkeypatch) -> Path:
    """A config folder of its own, in front of the real one."""
    for kind in ("scenarios", "vehicles"):
        (tmp_path / kind).mkdir()
    monkeypatch.setenv("EV_STACK_CONFIG", str(tmp_path))
    return tmp_path


@pytest.fixture
def scenario(config):
    def write(text: str, name: str = "test") -> str:
        (config / "scenarios" / f"{name}.yaml").write_text(text)
        return name

    return write


@pytest.fixture
def more(tmp_path):
    def write(text: str, name: str = "more") -> Path:
        path = tmp_path / f"{name}.yaml"
        path.write_text(text)
        return path

    return write


def refused(name: str, overrides: Overrides | None = None) -> str:
    with pytest.raises(ParameterError) as error:
        load_scenario(name, overrides)
    text = str(error.value)
    assert "\n" not in text
    return text


def section(node: str, text: str) -> str:
    return f"{node}:\n  ros__parameters: {text}\n"


@pytest.mark.parametrize("name", scenario_names())
def test_every_scenario_loads_and_says_what_it_is(name):
    loaded = load_scenario(name)
    assert loaded.name == name
    assert describe_scenario(name) == loaded.parameters.about != ""
    assert loaded.runs
    for run in loaded.runs:
        assert set(run.configurations) >= set(REQUIRED)
        assert not run.realtime
        for configuration in run.configurations.values():
            configuration.create()


def test_one_run_lives_in_ev_and_several_below(scenario):
    """A section can mean the driver of one run, /ev/first/driver."""
    (alone,) = load_scenario(scenario(HEAD)).runs
    assert (alone.name, alone.namespace, alone.duration, alone.period) == (
        "test",
        "/ev",
        2.0,
        10_000_000,
    )
    several = HEAD.replace("about", "runs: [first, second], about")
    text = several + section("/**/driver", "{seed: 1}") + section("/**/second/driver", "{seed: 2}")
    first, second = load_scenario(scenario(text)).runs
    assert (first.namespace, second.namespace) == ("/ev/first", "/ev/second")
    assert first.configurations["driver"].common.seed == 1
    assert second.configurations["driver"].common.seed == 2
    assert second.configurations["plant"].common.seed == 0


def test_later_words_go_before_earlier_ones(scenario, more, config):
    """Vehicle file, scenario, further files in order, command line in order."""
    name = scenario(
        HEAD + section("/**", "{vehicle.mass: 1.0e3, seed: 1}") + section("/**/plant", "{seed: 2}")
    )
    one = more(section("/**", "{seed: 3}"), "one")
    two = more(section("/**", "{seed: 4}"), "two")

    def seed(*files, values=()):
        return (
            load_scenario(name, Overrides(files, values))
            .runs[0]
            .configurations["plant"]
            .common.seed
        )

    assert load_scenario(name).runs[0].configurations["asr"].common.vehicle.mass == 1000.0
    assert seed() == 2
    assert seed(one) == 3
    assert seed(one, two) == 4
    assert seed(two, one) == 3
    assert seed(two, values=[("*", "seed", 5)]) == 5
    assert seed(values=[("*", "seed", 5), ("plant", "seed", 6), ("asr", "seed", 7)]) == 6
    assert seed(values=[("plant", "seed", 6), ("*", "seed", 5)]) == 5


def test_the_vehicle_reaches_every_node(scenario, config):
    text = (CONFIG / "vehicles" / "audi_a2.yaml").read_text().replace("audi_a2", "lorry")
    (config / "vehicles" / "lorry.yaml").write_text(text)
    loaded = load_scenario(scenario(HEAD.replace("about", "vehicle: lorry, about")))
    assert {c.common.vehicle.name for c in loaded.runs[0].configurations.values()} == {"lorry"}


def test_duration_comes_from_the_scenario_or_the_command_line(scenario):
    name = scenario(HEAD)
    (run,) = load_scenario(name, Overrides(duration=0.5)).runs
    assert run.duration == run.configurations["plant"].extra.duration == 0.5
    assert load_scenario(name).runs[0].configurations["plant"].extra.duration == 2.0


@pytest.mark.parametrize("duration", [0.0, -1.0, float("nan"), float("inf"), 1.1e7])
def test_an_impossible_duration_is_refused(scenario, duration):
    assert refused(scenario(HEAD), Overrides(duration=duration)).startswith(
        f"duration: {duration!r} is refused"
    )


def test_a_run_is_at_least_one_step_long(scenario):
    """A recorder that waits for the first step after the end would wait for ever."""
    message = "duration: 0.009 is refused, expected at least one control period, 0.01 s"
    assert refused(scenario(HEAD), Overrides(duration=0.009)) == message
    assert load_scenario("test", Overrides(duration=0.01)).runs[0].duration == 0.01


def test_a_law_brings_the_column_that_it_requires(scenario):
    name = scenario(HEAD)
    chosen = Overrides(values=[("electronic_differential", "method", "steer_by_wire")])
    assert (
        load_scenario(name, chosen).runs[0].configurations["steering_column"].method.name
        == "by_wire"
    )
    assert load_scenario(name).runs[0].configurations["steering_column"].method.name == "powered"


def test_a_bench_behind_a_real_bus_has_other_defaults():
    """Values of the user go before them."""
    bus, clock = ("test_bench", "method", "circuits_on_can"), ("*", "mode", "realtime")
    setting = ("plant", "wheel_speed", "load_machine")
    for values, speed in (
        ((bus,), setting[2]),
        ((bus, clock), "virtual"),
        ((bus, clock, setting), setting[2]),
    ):
        (run,) = load_scenario("urban_mixed_bench", Overrides(values=values)).runs
        assert run.configurations["plant"].parameters.wheel_speed == speed


def test_unknown_scenarios_and_vehicles_list_the_known_ones(scenario):
    scenario(HEAD)
    assert refused("tset").startswith("unknown scenario 'tset'; did you mean test?")
    assert refused("../scenarios/gone.yaml") == "../scenarios/gone.yaml: No such file or directory"
    text = refused(scenario(HEAD.replace("about", "vehicle: audi_a3, about")))
    assert text.startswith("unknown vehicle 'audi_a3'; did you mean audi_a2?")


def test_bad_words_of_a_scenario_about_itself_name_its_file(scenario, config):
    path = config / "scenarios" / "test.yaml"
    assert refused(scenario(HEAD.replace("2.0", "long"))).startswith(
        f"{path}: parameter duration: 'long'"
    )
    message = f"{path}: unknown parameter 'abuot'; did you mean about?"
    assert refused(scenario(HEAD.replace("about", "abuot"))).startswith(message)
    assert refused(scenario("a: [")).startswith(f"{path}: not readable as YAML")


@settings(max_examples=50, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    names=st.lists(
        st.one_of(st.text(max_size=5), st.from_regex(r"\w{1,4}"), st.sampled_from(ODD)),
        min_size=1,
        max_size=3,
    )
)
@example(names=["a", "a"])
def test_names_of_runs_are_those_of_folders_and_namespaces(names: list[str], scenario, config):
    """They are joined to the output folder and to /ev, and are shown on the terminal.

    JSON escapes what is beyond 16 bits as two halves, which YAML does not know.
    """
    about = json.dumps({"runs": names}, ensure_ascii=True)
    name = scenario(f"/**/scenario:\n  ros__parameters: {about}\n")
    if len(set(names)) == len(names) and all(
        re.fullmatch("[A-Za-z_][A-Za-z0-9_]{0,99}", each) for each in names
    ):
        assert [run.name for run in load_scenario(name).runs] == names
    else:
        assert re.match(
            f"{config}/scenarios/test.yaml: ((parameter )?runs: |not readable as YAML)",
            refused(name),
        )


def test_what_a_file_is_called_and_says_of_itself_is_shown_as_text(scenario, capsys):
    name = scenario(section("/**/scenario", json.dumps({"about": "a\x1b[2J\nb"})), "bad\x1b[31m")
    assert load_scenario(name).name == r"bad\x1b[31m"
    main(["--list"])
    assert r"bad\x1b[31m" in (output := capsys.readouterr().out)
    assert "\x1b" not in output


@pytest.mark.parametrize(
    "pattern", ["/**/drivr", "/ev/other/driver", "driver", "/plant", "/*/*/driver"]
)
def test_a_section_that_means_no_node_is_refused(scenario, more, pattern):
    """A mistyped name would else be a silent nothing.

    `driver` alone means the root namespace, as in ROS.
    """
    text = section(pattern, "{seed: 1}")
    known = "known: plant, steering_column, rear_steering, test_bench, driver, electronic_differential, asr, "
    known += "inverter_gateway"
    own = refused(scenario(HEAD + text))
    assert f"section {pattern!r} means no node; {known}" in own
    path = more(text)
    assert (
        refused(scenario(HEAD), Overrides([path]))
        == f"{path}: section {pattern!r} means no node; {known}"
    )


@pytest.mark.parametrize(
    ("value", "message"),
    [
        (("drivr", "seed", 1), "unknown node 'drivr'; did you mean driver? known: asr, "),
        (("driver", "sed", 1), "driver: unknown parameter of driver 'sed'; did you mean seed?"),
        (("driver", "method", "sleep"), "driver: unknown driver method 'sleep'; known: "),
        (("driver", "seed", -1), "driver: parameter seed: -1 is refused, expected 0 to "),
        (
            ("driver", "seed", "x"),
            "driver: parameter seed: 'x' is refused, expected a whole number",
        ),
        (("asr", "control_period", 0.02), "control_period differs between nodes: "),
    ],
)
def test_bad_words_on_the_command_line_name_node_and_parameter(scenario, value, message):
    assert refused(scenario(HEAD), Overrides(values=[value])).startswith(message)


ASR, LAW = "asr", "electronic_differential"


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            [(ASR, "method", "pi_slip"), (ASR, "reference.trust.watch", True)],
            "asr: parameter reference.trust.watch is refused: asr method pi_slip does not have it, its name there is "
            "regulator.reference.trust.watch",
        ),
        (
            [(LAW, "gamma", 3.0)],
            "electronic_differential: parameter gamma is refused: electronic_differential method equal_torque does not "
            "have it, expected with course_stability, power_steering",
        ),
        (
            [("plant", "sensors.tire_load.noise", 1.0)],
            "plant: parameter sensors.tire_load.noise is refused: plant method kinematic does not have it, expected ",
        ),
        (
            [("rear_steering", "gain", 3.0)],
            "rear_steering.gain is refused: no node plays rear_steering, expected with --method rear_steering=NAME",
        ),
    ],
)
def test_what_the_command_line_says_belongs_to_the_chosen_methods(scenario, values, message):
    """A value that would do nothing is refused."""
    assert refused(scenario(HEAD), Overrides(values=values)).startswith(message)
    set_there = {f"{node}.{key}": value for node, key, value in values if key != "method"}
    methods = {node: value for node, key, value in values if key == "method"}
    with pytest.raises(ParameterError, match=f"^{re.escape(message)}"):
        ev_stack.run("test", set=set_there, method=methods)
    words = [f"--set={place}={value}" for place, value in set_there.items()]
    words += [f"--method={node}={name}" for node, name in methods.items()]
    with pytest.raises(ParameterError, match=f"^{re.escape(message)}"):
        load_scenario("test", overrides(arguments(["test", *words])))


@pytest.mark.sampled
@pytest.mark.parametrize("name", scenario_names())
def test_another_cycle_changes_what_is_driven_or_is_refused(name, tmp_path):
    """A driver on pedals from the start on never follows it: `hill_start` refuses `--cycle`."""
    cycle = tmp_path / "cycle.csv"
    cycle.write_text("t_s,v_mps\n0,3\n2,4\n4,1\n")
    run = load_scenario(name).runs[0].name
    given = {"runs": [run] if load_scenario(name).parameters.runs else (), "duration": 4.0}
    try:
        other = ev_stack.run(name, cycle=cycle, **given)
    except ParameterError as error:
        message = "is refused: the driver goes by the pedals from the start on, expected with driver.pedals.begin=false"
        if name == "lap":
            assert (
                str(error)
                == "driver.speed_profile.file is refused: driver method lap follows no speed over time"
            )
            return
        assert str(error) == f"driver.speed_profile.file {message}"
        with pytest.raises(ParameterError, match=f"^driver.speed_profile.time {message}$"):
            ev_stack.run(name, set={"driver.speed_profile.time": [0.0, 1.0, 2.0, 3.0]}, **given)
    else:
        assert other.hash != ev_stack.run(name, **given).hash


def test_a_value_is_used_if_one_of_the_runs_uses_it(scenario):
    """Several runs have a method each."""
    text = HEAD.replace("about", "runs: [first, second], about")
    text += section(f"/**/first/{LAW}", "{method: power_steering}")
    gamma = Overrides(values=[(LAW, "gamma", 3.0)])
    first, second = load_scenario(scenario(text), gamma).runs
    assert (first.configurations[LAW].parameters.gamma, second.configurations[LAW].unused) == (
        3.0,
        ("gamma",),
    )
    with pytest.raises(ParameterError, match="method equal_torque does not have it"):
        load_scenario("test", gamma, only=("second",))


def test_a_file_may_prepare_other_methods_and_what_none_of_them_uses_is_noted(scenario, more):
    """The note is for the methods of the files; another chosen method uses other values."""
    path = more(section(f"/**/{LAW}", "{gamma: 3.0, gain: 2.0}"))
    name = scenario(HEAD)
    message = f"used by no chosen method: {LAW}.gamma, {LAW}.gain of {path}"
    assert load_scenario(name, Overrides([path])).notes == (message,)
    chosen = Overrides([path], [(LAW, "method", "power_steering")])
    loaded = load_scenario(name, chosen)
    assert (loaded.notes, loaded.runs[0].configurations[LAW].parameters.gamma) == ((), 3.0)


def test_a_study_takes_what_one_of_its_methods_has():
    """`compare` drives all laws; what none of them has is refused before anything is driven."""
    study, words = study_named("compare"), ["--set", f"{LAW}.gamma=7"]
    given = study_arguments("compare", words)
    study_cases(study, given)
    given = study_arguments("compare", [*words, "--set", "asr.low=0.1"])
    with pytest.raises(
        ParameterError, match=r"^asr: parameter low is refused: asr method off does not have it"
    ):
        study_cases(study, given)


def test_a_missing_further_file_is_named(scenario, tmp_path):
    path = tmp_path / "nowhere.yaml"
    assert refused(scenario(HEAD), Overrides([path])) == f"{path}: No such file or directory"


def test_runs_that_are_not_named_are_not_resolved():
    assert [
        run.name for run in load_scenario("shchur2019_steps", only=("hold_manual", "object")).runs
    ] == [
        "object",
        "hold_manual",
    ]
    with pytest.raises(
        ParameterError, match=r"^unknown run of shchur2019_steps 'unknown'; known: "
    ):
        load_scenario("shchur2019_steps", only=("unknown",))


def own_car(folder, change=lambda text: text) -> str:
    path = folder / "my_car.yaml"
    path.write_text(
        change((CONFIG / "vehicles" / "audi_a2.yaml").read_text().replace("audi_a2", "my_car"))
    )
    return str(path)


def test_a_scenario_and_a_vehicle_may_be_any_file(scenario, tmp_path):
    """A user's vehicle is the whole car.

    Changes of the scenario to its car are left out, with a note.
    """
    text = HEAD + section("/**", "{vehicle.mass: 1000.0, vehicle.rear_steering_ratio: 0.1}")
    path = tmp_path / "elsewhere.yaml"
    path.write_text(text)
    loaded = load_scenario(str(path), Overrides(vehicle=own_car(tmp_path)))
    car = loaded.runs[0].configurations["asr"].common.vehicle
    assert (loaded.name, car.name, car.mass, car.rear_steering_ratio) == (
        "elsewhere",
        "my_car",
        1400.0,
        0.0,
    )
    message = f"left out for another vehicle: vehicle.mass, vehicle.rear_steering_ratio of {path}"
    assert loaded.notes == (message,)
    on_top = Overrides(vehicle=own_car(tmp_path), values=[("*", "vehicle.mass", 900.0)])
    assert (
        load_scenario(str(path), on_top).runs[0].configurations["asr"].common.vehicle.mass == 900.0
    )


def test_a_vehicle_that_does_not_say_everything_about_itself_is_refused(scenario, tmp_path):
    """It is not silently filled up from another car."""
    path = own_car(
        tmp_path, lambda text: text.replace("mass: 1400.0", "").replace("resistance: 0.1 ", "#")
    )
    message = f"{path}: a vehicle says everything about itself, missing: vehicle.mass, vehicle.battery.resistance"
    assert refused(scenario(HEAD), Overrides(vehicle=path)) == message


PROFILE = "t_s,v_mps\n0,1\n10,2\n"


@pytest.mark.parametrize("level", ["scenario", "file", "command line", "cycle"])
def test_points_that_a_file_gives_are_refused_wherever_the_file_is_named(
    scenario, more, tmp_path, level
):
    """They would do nothing, and rows of a sweep would stand under speeds that were not driven."""
    (tmp_path / "profile.csv").write_text(PROFILE)
    text = section("/**/driver", f"{{speed_profile: {{file: {tmp_path / 'profile.csv'}}}}}")
    name = scenario(HEAD + text if level == "scenario" else HEAD)
    files = [more(text)] if level == "file" else []
    named = [("driver", "speed_profile.file", str(tmp_path / "profile.csv"))]
    speed = [
        ("driver", "speed_profile.speed", [3.0, 4.0]),
        ("driver", "speed_profile.time", [0.0, 5.0]),
    ]
    beside = [*named, *speed] if level == "command line" else speed
    prepared = named if level == "cycle" else []
    message = "driver: parameter speed_profile.time is refused: speed_profile.file has it, expected speed_profile.fi"
    assert refused(name, Overrides(files, beside, prepared=prepared)).startswith(message)
    points = more(
        section("/**/driver", "{speed_profile: {time: [0.0, 5.0], speed: [3.0, 4.0]}}"), "points"
    )
    if level in ("scenario", "file"):
        assert refused(name, Overrides([*files, points])) == f"{message}le '' beside it ({points})"
    instead = Overrides([points, *files], [*speed, ("driver", "speed_profile.file", "")])
    (run,) = load_scenario(name, instead).runs
    assert run.configurations["driver"].parameters.speed_profile.speed == (3.0, 4.0)


def test_a_file_goes_before_points_that_were_given_before_it(scenario, tmp_path):
    """`--cycle` drives another cycle where the scenario lists its own."""
    (tmp_path / "profile.csv").write_text(PROFILE)
    name = scenario(
        HEAD + section("/**/driver", "{speed_profile: {time: [0.0, 5.0], speed: [3.0, 4.0]}}")
    )
    (run,) = load_scenario(
        name, Overrides(prepared=[("driver", "speed_profile.file", str(tmp_path / "profile.csv"))])
    ).runs
    assert run.configurations["driver"].parameters.speed_profile.speed == (1.0, 2.0)


def test_numbers_of_a_tyre_that_its_file_says_are_refused():
    message = "parameter vehicle.tyre.rear_mf is refused: vehicle.tyre.rear_file has it, expected vehicle.tyre.rear_"
    numbers = list(
        load_scenario("coast_down", Overrides(vehicle="compact_ev"))
        .runs[0]
        .configurations["plant"]
        .common.vehicle.tyre.rear_mf
    )
    values = [("*", "vehicle.tyre.rear_mf", [2.0 * each for each in numbers])]
    assert message in refused("coast_down", Overrides(values=values, vehicle="compact_ev"))


def test_a_vehicle_that_says_more_than_a_car_is_refused(scenario, tmp_path):
    """The scenario would overrule it without notice."""
    path = own_car(tmp_path, lambda text: text + section("/**/asr", "{method: 'off'}"))
    message = f"{path}: parameter 'method' is no vehicle's, expected those of vehicle; others stand in a scenario"
    assert refused(scenario(HEAD), Overrides(vehicle=path)) == message


def test_a_scenario_may_borrow_a_report_and_bring_metrics(scenario):
    text = HEAD.replace(
        "about", "report: double_lane_change, metrics: ['end = last(pose.x)'], about"
    )
    assert load_scenario(scenario(text)).parameters.report == "double_lane_change"
    assert "unknown report 'lane_change'; did you mean double_lane_change?" in refused(
        scenario(text.replace("double_lane", "lane"))
    )
    assert "unknown function 'lost'; did you mean last?" in refused(
        scenario(text.replace("= last", "= lost"))
    )
    assert "unknown channel 'pose.q'; did you mean pose." in refused(
        scenario(text.replace("pose.x", "pose.q"))
    )
    assert "or NAME [UNIT] = EXPRESSION, such as" in refused(scenario(text.replace("end =", "")))


@pytest.mark.parametrize("name", scenario_names())
def test_every_scenario_names_five_numbers_of_its_nodes_for_a_lesson(name):
    """A study of their effect is no test.

    Each of them changed the hash of the run when it was chosen.
    """
    loaded = load_scenario(name)
    there = {
        f"{node}.{key}"
        for run in loaded.runs
        for node, each in run.configurations.items()
        for key in each.values()
    }
    assert len({*loaded.parameters.lesson}) == 5 and {*loaded.parameters.lesson} <= there


@pytest.mark.parametrize(
    ("named", "message"),
    [
        ("driverr.band", "lesson: unknown node 'driverr'; did you mean driver?"),
        (
            "asr",
            "lesson: unknown number of asr that changes while it runs 'asr'; did you mean asr.",
        ),
        (
            "asr.bandwith",
            "unknown number of asr that changes while it runs 'asr.bandwith'; did you mean asr.bandwidth",
        ),
        # no number
        (
            "driver.speed_profile.speed",
            "lesson: unknown number of driver that changes while it runs",
        ),
        # fixed
        ("plant.vehicle.mass", "lesson: unknown number of plant that changes while it runs"),
        ("driver.method", "lesson: unknown number of driver that changes while it runs"),
    ],
)
def test_a_lesson_of_what_no_slider_can_change_is_one_line(scenario, named, message):
    assert message in refused(scenario(HEAD.replace("about", f"lesson: [{named}], about")))


@pytest.mark.parametrize("name", scenario_names())
def test_every_scenario_names_four_curves_that_its_runs_record(name):
    """A field of a topic that no node of its runs writes would be an empty plot."""
    loaded = load_scenario(name)
    recorded = {
        channel
        for run in loaded.runs
        for topic in written_topics(run.configurations)
        for channel in topic.channels
    }
    curves = loaded.parameters.curves
    assert len({*curves}) == 4
    for curve in set(curves) - set(SERIES):
        assert any(each == curve or each.startswith(f"{curve}.") for each in recorded), curve


@pytest.mark.parametrize(
    ("named", "message"),
    [
        ("imu.yaw_rat", "curves: unknown curve 'imu.yaw_rat'; did you mean imu.yaw_rate"),
        ("wheel_states", "curves: unknown curve 'wheel_states'; did you mean wheel_states."),
        ("imu.yaw_rate, imu.yaw_rate", "curves: 'imu.yaw_rate' is there twice, expected once"),
        ("", "curves: 0 names, expected 1 to 4"),
        (
            "pose.x, pose.y, imu.yaw_rate, twist.lateral, sideslip_angle",
            "curves: 5 names, expected 1 to 4",
        ),
    ],
)
def test_curves_that_cannot_be_shown_are_one_line(scenario, named, message):
    given = scenario(HEAD.replace("about", f"curves: [{named}], about"))
    assert f"/scenarios/test.yaml: {message}" in refused(given)


def test_a_scenario_that_names_no_curves_has_the_usual_ones(scenario):
    assert load_scenario(scenario(HEAD)).parameters.curves == DEFAULT


@pytest.mark.parametrize("name", ["duration", "manoeuvre_end", "lesson"])
def test_what_the_scenario_states_of_itself_is_not_set_in_the_plant(scenario, name):
    value = "[]" if name == "lesson" else "1.0"
    message = refused(scenario(HEAD + section("/**/plant", f"{{{name}: {value}}}")))
    assert f"plant.{name} is refused, expected in the section /**/scenario" in message
