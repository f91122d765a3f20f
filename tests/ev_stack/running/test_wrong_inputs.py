"""Wrong inputs get one clear line and the right status, and nothing of an earlier run is lost."""

from __future__ import annotations

import io
import os
import re
import shutil
import subprocess
from importlib.metadata import EntryPoint
from pathlib import Path

import pytest

import ev_stack
from ev_core.methods import register
from ev_core.methods.register import method
from ev_core.parameters.data_file import find_in_config
from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.run_scenario import main
from ev_stack.recording.outcome import progress_bar

ROOT = Path(__file__).parents[3]


def refused(*words: str, out: Path) -> str:
    """Last line of a refused command; an earlier result in its folder stays as it is."""
    out.mkdir()
    (out / "summary.json").write_text("earlier")
    with pytest.raises(SystemExit) as ended:
        main([*words, "--out", str(out)])
    assert (out / "summary.json").read_text() == "earlier"
    assert "\n" not in ended.value.code
    return ended.value.code


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (
            ["ge_ni2005", "--offline", "--method", "electronic_differential=power_steering"],
            "electronic_differential: electronic_differential method power_steering needs front_left and front_right",
        ),
        (
            ["compare", "--duration", "0"],
            "none of 16 runs can be driven; adaptive: duration: 0.0 is refused, expected",
        ),
        (
            ["compare", "--duration", "-1"],
            "none of 16 runs can be driven; adaptive: duration: -1.0 is refused, expected",
        ),
        (
            ["compare", "--methods", "slip_target"],
            "none of 1 runs can be driven; slip_target: electronic_differential: ",
        ),
        (
            ["double_lane_change", "--offline", "--set", "*.vehicle.tyre.curve=magic_formula"],
            "driver: vehicle.tyre.coefficients [0.0, 0.0, 0.0, 0.0] give no friction: curve magic_formula needs",
        ),
        (
            ["shchur2019", "--offline", "--set", "vehicle.mass=1000"],
            "unknown node 'vehicle'; known: asr, driver, electronic_differential, inverter_gateway, plant, "
            "rear_steering, steering_column, test_bench; the car is that of all nodes: '*.vehicle.mass'",
        ),
        (
            [
                "shchur2019",
                "--offline",
                "--set",
                "*.vehicle.driven_wheels=[front_left, front_left]",
            ],
            "driver: vehicle.driven_wheels names a wheel twice: front_left, front_left",
        ),
        (
            ["shchur2019", "--offline", "--set", "*.vehicle.maximum_road_wheel_angle=1.4"],
            "driver: vehicle.maximum_road_wheel_angle: 1.4 is refused, expected below 1.276, where by "
            "steering_geometry ackermann the inner front wheel stands across the car",
        ),
        (
            ["shchur2019", "--offline", "--set", "driver.seed=2147483648"],
            "driver: parameter seed: 2147483648 is refused, expected 0 to 2147483647",
        ),
    ],
)
def test_one_line_and_nothing_is_lost(words, message, tmp_path):
    assert refused(*words, out=tmp_path / "out").startswith(f"error: {message}")


def test_what_a_file_says_wrong_is_found_in_the_file(tmp_path):
    path = tmp_path / "mine.yaml"
    for text, message in (
        (
            "{sed: 1}",
            f"error: driver: unknown parameter of driver 'sed'; did you mean seed\\? \\({path}\\)",
        ),
        (
            "{seed: -1}",
            f"error: driver: parameter seed: -1 is refused, expected 0 to 2147483647 \\({path}\\)",
        ),
        (
            "{seed: 1, method: pulse, seed: 2}",
            f"error: {path}: not readable as YAML in line 2: seed is listed twice",
        ),
    ):
        path.write_text(f"/**/driver:\n  ros__parameters: {text}\n")
        shutil.rmtree(tmp_path / "out", ignore_errors=True)
        line = refused("shchur2019", "--offline", "--params", str(path), out=tmp_path / "out")
        assert re.fullmatch(message, line), line


@pytest.fixture
def offered(monkeypatch):
    """Entry points as if a package had brought them."""

    def offer(name: str, module: str) -> None:
        real = register.entry_points

        def found(**wanted: str):
            own = EntryPoint(name, module, "ev_stack.methods")
            return [*real(**wanted), *([own] if wanted.get("name", name) == name else [])]

        monkeypatch.setattr(register, "entry_points", found)
        register.load_installed_methods.cache_clear()

    yield offer
    monkeypatch.undo()
    register.load_installed_methods.cache_clear()


def test_a_broken_plug_in_harms_its_users_only(offered, tmp_path, capsys):
    offered("asr", "no_such_module_of_mine")
    assert ev_stack.run("shchur2019", duration=0.05).hash
    message = "not loaded: no_such_module_of_mine: ModuleNotFoundError: No module named 'no_such_module_of_mine'"
    assert refused(
        "shchur2019", "--offline", "--method", "asr=mine", out=tmp_path / "out"
    ).endswith(f"; {message}")
    main(["--list"])
    assert message in capsys.readouterr().out.splitlines()


def test_a_misspelt_role_is_named(offered, capsys):
    offered("asrr", "ev_control.methods.asr")
    main(["--list"])
    assert (
        "not loaded: ev_control.methods.asr: offered for 'asrr', which is no role: plant, "
        in capsys.readouterr().out
    )
    with pytest.raises(
        TypeError, match=r"^method mine: 'asrr' is no role, expected one of plant, "
    ):
        method("asrr", "mine")


def test_no_number_says_when(monkeypatch):
    """A law of one's own that divides zero by zero after a while."""
    from ev_control.electronic_differential import mechanical as law
    from ev_core.lockstep.finding import find_method

    factory = find_method("electronic_differential", "equal_torque").factory
    calls = []

    def broken(p, car, driver):
        calls.append(driver)
        return law.split(p.brake, car, driver, float("nan") if len(calls) == 5 else 0.0)

    monkeypatch.setattr("ev_core.methods.law.Law.is_compilable", False)
    monkeypatch.setitem(vars(factory), "function", broken)
    with pytest.raises(
        SignalError,
        match=r"^at 0\.04 s: electronic_differential: WheelTorqueRequest\.drive\.front_left is",
    ):
        ev_stack.run("shchur2019", method={"electronic_differential": "equal_torque"}, duration=0.1)


def test_a_terminal_that_knows_ascii_only_is_answered(monkeypatch):
    """A dash in a study's table is no error there, least of all behind the driving."""
    terminal = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
    monkeypatch.setattr("sys.stdout", terminal)
    monkeypatch.setattr("ev_stack.commands.run_scenario.print_list", lambda: print("0.5 ± 0.1 –"))
    main(["--list"])
    assert terminal.buffer.getvalue() == b"0.5 ? 0.1 ?\n"


def test_another_law_than_that_of_the_source_is_not_judged():
    """No number is (not) reproduced by a law, car or node that the source does not know."""
    method_of_mine = {"electronic_differential": "equal_torque"}
    found = ev_stack.run("shchur2019", method=method_of_mine, duration=0.1).metrics
    judged = {metric.judgement for metric in found.values()}
    assert judged <= {"not judged", "not measured", "measured"}
    assert "not judged" in judged
    why = "not judged: plant.duration, electronic_differential.method differ from the source's"
    assert why in {metric.verdict for metric in found.values()}


def test_another_gain_than_that_of_the_source_is_not_judged():
    """8 numbers of gamma = 8 stayed "reproduced"."""
    found = ev_stack.run("shchur2019", set={"electronic_differential.gamma": 8.0}).metrics.values()
    # what is only shown beside is `measured`
    judged = {each.verdict for each in found if each.reference}
    assert judged == {"not judged: electronic_differential.gamma differs from the source's"}


@pytest.mark.parametrize(
    "place",
    [
        "electronic_differential.gamma=8.0",
        "plant.sensors.wheel_speed.noise=0.1",
        "*.control_period=0.005",
    ],
)
def test_whatever_is_not_as_the_source_has_it_is_not_judged(place):
    """An assistance of eight times is not "reproduced" as if it were that of five."""
    name, value = place.split("=")
    found = ev_stack.run("shchur2019", set={name: float(value)}).metrics
    judged = {
        metric.verdict for metric in found.values() if metric.reference and metric.value is not None
    }
    name = name.replace("*", "every node")
    assert judged and all(
        re.fullmatch(rf"not judged: .*{re.escape(name)}.* from the source's", each)
        for each in judged
    )


def test_a_seed_or_how_fast_it_is_run_changes_no_verdict():
    own = ev_stack.run("shchur2019")
    other = ev_stack.run("shchur2019", seed=7, set={"plant.real_time_factor": 1000.0})
    assert {n: m.verdict for n, m in own.metrics.items()} == {
        n: m.verdict for n, m in other.metrics.items()
    }
    assert "reproduced" in {metric.judgement for metric in own.metrics.values()}


def test_a_copy_of_a_source_that_says_something_else_is_not_judged(tmp_path):
    """A report is borrowed by `report:`, or by the name of the file."""
    shchur2019 = find_in_config("scenarios/shchur2019.yaml").read_text()
    for name, text in (
        ("shchur2019", shchur2019),
        ("mine", shchur2019.replace("about:", "report: shchur2019\n    about:")),
    ):
        file = tmp_path / f"{name}.yaml"
        file.write_text(
            text.replace("method: power_steering", "method: power_steering\n    gamma: 8.0")
        )
        judged = {
            m.verdict
            for m in ev_stack.run(file).metrics.values()
            if m.reference and m.value is not None
        }
        assert judged == {f"not judged: scenario {file} differs from the source's"}


def test_the_bar_shows_no_factor_before_it_knows_one(monkeypatch):
    """The first looks lie a microsecond apart: their factor, such as 39440 x, is not shown."""
    shown = io.StringIO()
    monkeypatch.setattr("sys.stderr", shown)
    with progress_bar("run", 100.0) as progress:
        for time in (0.0, 1.0, 50.0, 100.0):
            progress(time)
    assert "simulated, - x real time" in shown.getvalue() or not shown.getvalue()


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a file away")
def test_the_environment_of_another_user_is_left_alone(tmp_path):
    (tmp_path / "scripts").mkdir()
    (tmp_path / ".venv").mkdir()
    (tmp_path / "requirements.txt").touch()
    (tmp_path / "requirements.lock").touch()
    shutil.copy(ROOT / "scripts" / "prepare.sh", tmp_path / "scripts")
    os.chown(tmp_path / ".venv", 65534, 65534)
    ended = subprocess.run([tmp_path / "scripts" / "prepare.sh"], capture_output=True, text=True)
    assert (ended.returncode, ended.stdout) == (1, "")
    assert ended.stderr.startswith(
        f"{tmp_path}/.venv belongs to nobody and is not ready for root: let nobody run"
    )
    assert (tmp_path / ".venv").exists()


def test_files_of_vehicles_refuse_what_no_car_is(tmp_path):
    path = tmp_path / "car.yaml"
    path.write_text("/**:\n  ros__parameters: {vehicle: {mass: 1.0e3, mass: 2.0e3}}\n")
    with pytest.raises(
        ParameterError, match=rf"^{path}: not readable as YAML in line 2: mass is listed twice$"
    ):
        ev_stack.run("shchur2019", vehicle=path)
