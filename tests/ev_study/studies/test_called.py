"""`ev_study.compare` and `ev_study.sweep`: what their commands drive, from Python."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.colors import to_hex

import ev_stack
import ev_study
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.run_scenario import main
from ev_stack.figures.strokes import strokes_of

LAW = '''"""Halves of the drive torque at the front wheels."""

from dataclasses import dataclass

from ev_core.law import NO_WHEELS, DriverCommand, Wheels, WheelTorqueRequest, method, parameter


@dataclass(frozen=True)
class Parameters:
    share: float = parameter(0.5, low=0.0, high=1.0, unit="1", about="share of the left wheel")


@method("electronic_differential", "shares")
def shares(p: Parameters, driver: DriverCommand) -> WheelTorqueRequest:
    """Divide the drive torque between the front wheels, and no brake."""
    left = p.share * driver.drive_torque
    return WheelTorqueRequest(Wheels(left, driver.drive_torque - left, 0.0, 0.0), NO_WHEELS)
'''
SHORT = {"duration": 0.1, "workers": 1}


@pytest.fixture(scope="module")
def law(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("law") / "twist.py"
    path.write_text(LAW)
    return path


def hash_of_command(out: Path, *words: str) -> str:
    main([*words, "--duration", "0.1", "--workers", "1", "--no-report", "--out", str(out)])
    return json.loads((out / "summary.json").read_text())["signal_hash"]


def test_a_law_file_beside_two_others_has_the_hash_of_the_command(law, tmp_path):
    found = ev_study.compare(
        "shchur2019", [law, "equal_torque", "power_steering"], metrics=["final_speed"], **SHORT
    )
    assert found.table.columns == ["method", "final_speed [m/s]"]
    assert [row[0] for row in found.table.rows] == ["twist", "equal_torque", "power_steering"]
    methods = ["--methods", f"{law},equal_torque,power_steering", "--metrics", "final_speed"]
    assert found.hash == hash_of_command(
        tmp_path / "out", "compare", "--scenario", "shchur2019", *methods
    )
    alone = ev_stack.run("shchur2019", method={"electronic_differential": law}, duration=0.1)
    assert found.rows["twist"].signal_hash == alone.hash


def test_a_comparison_draws_all_laws_over_each_other():
    """A law has the colour that it has in every figure."""
    found = ev_study.compare("shchur2019", ["equal_torque", "power_steering"], **SHORT)
    (speed,) = found.plot(panels=["speed"]).axes
    colours = {line.get_label(): to_hex(line.get_color()) for line in speed.lines}
    laws = strokes_of(["equal_torque", "power_steering"])
    assert colours == {
        name: laws[name].colour.lower() for name in ("equal torque", "power steering")
    }
    whole = found.plot()
    abscissae = {axes.get_title(loc="left"): axes.get_xlabel() for axes in whole.axes}
    # The panel above that of the paths has the last abscissa of its column.
    assert abscissae["Speed"] == "time [s]"
    assert found._repr_html_().count("<img ") == 2


def test_a_sweep_over_a_law_file_and_over_its_parameter(law, monkeypatch):
    """Names and values are those of the command; arrays of numpy are values, too."""
    over_laws = ev_study.sweep(
        "shchur2019", {"electronic_differential.method": [str(law), "equal_torque"]}, **SHORT
    )
    assert not any(row.refused for row in over_laws.rows.values())
    with pytest.raises(ParameterError, match=r"^this study has no figure, expected a sweep of one"):
        over_laws.plot()
    found = ev_study.sweep(
        "shchur2019",
        {"electronic_differential.share": np.array([0.4, 0.5])},
        seeds=2,
        metrics=["final_speed"],
        method={"electronic_differential": law},
        **SHORT,
    )
    assert [row[:2] for row in found.table.rows] == [[0.4, 0], [0.4, 1], [0.5, 0], [0.5, 1]]
    assert [axes.get_title(loc="left") for axes in found.plot().axes] == ["final speed"]
    pandas = SimpleNamespace(
        DataFrame=lambda given, index: SimpleNamespace(columns=given, attrs={})
    )
    pandas.Index = None
    monkeypatch.setitem(sys.modules, "pandas", pandas)
    columns = found.data_frame().columns
    assert columns["electronic_differential.share"] == (0.4, 0.4, 0.5, 0.5)
    assert found.metrics["final_speed_least"].value == found.table.rows[0][2]


def test_a_sweep_has_the_hash_of_its_command(tmp_path):
    """Numbers that YAML would read as texts, texts, and switches come through as they are."""
    changed = {"electronic_differential.gamma": 1e-05, "plant.faults": ["lost imu 0.5"]}
    found = ev_study.sweep(
        Path("shchur2019"),
        {"plant.initial_speed": [2.0, 4.0]},
        metrics=["final_speed", "top [m/s] = maximum(twist.longitudinal)"],
        set=changed,
        seed=3,
        **SHORT,
    )
    words = ["--vary", "plant.initial_speed=2.0,4.0", "--seed", "3", "--metrics", "final_speed"]
    for name, text in (
        ("electronic_differential.gamma", "1.0e-05"),
        ("plant.faults", "[lost imu 0.5]"),
    ):
        words += ["--set", f"{name}={text}"]
    assert found.hash == hash_of_command(tmp_path / "out", "sweep", "shchur2019", *words)
    assert found.table.columns[1:] == ["final_speed [m/s]", "top [m/s]"]


@pytest.mark.parametrize(
    ("call", "line"),
    [
        (lambda: ev_study.compare("shchur2019", "pi"), "methods: 'pi' is refused, expected a list"),
        (lambda: ev_study.compare("shchur2019", ["nonesuch"]), "unknown electronic_differential"),
        (lambda: ev_study.compare("--help"), "unknown scenario '--help'"),
        (lambda: ev_study.sweep("--help", seeds=2), "unknown scenario '--help'"),
        (
            lambda: ev_study.sweep("shchur2019", {"plant.initial_speed": 5.0}),
            "vary['plant.initial_speed']: 5.0 is refused, expected a list of values, such as [5.0]",
        ),
        (
            lambda: ev_study.compare("shchur2019", duration="x"),
            "argument --duration: 'x' is refused, expected a number of seconds",
        ),
        (
            lambda: ev_study.compare("shchur2019", workers=0),
            "argument --workers: '0' is refused, expected a whole number, 1 or more",
        ),
        (lambda: ev_study.sweep("shchur2019"), "a sweep of nothing is refused"),
    ],
)
def test_what_is_refused_is_one_line_and_does_not_end_the_program(call, line):
    with pytest.raises(ParameterError) as refused:
        call()
    assert str(refused.value).startswith(line)
    assert "\n" not in str(refused.value)
