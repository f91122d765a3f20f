"""The launch file starts what scripts/run.sh starts, with the same parameters.

`launch` is not on PyPI: its classes have stand-ins that keep their arguments.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import pytest
import yaml

from ev_stack.commands.descriptions import write_parameters
from ev_stack.running.offline import node_parameters
from ev_stack.scenarios.scenario import Overrides, load_scenario

FILE = Path(__file__).parents[3] / "src" / "ev_stack" / "launch" / "scenario.launch.py"
GIVEN = {"scenario": "shchur2019", "options": "--duration 3 --method asr=pi_slip", "rviz": "false"}


class Kept:
    """Any class of launch: it keeps its arguments."""

    def __init__(self, *words, **named):
        self.words, self.named = words, named

    def perform(self, context) -> str:
        return context[self.words[0]]


@pytest.fixture
def launch_file(monkeypatch):
    names = {
        "launch": ("LaunchDescription",),
        "launch.actions": ("DeclareLaunchArgument", "OpaqueFunction", "Shutdown"),
        "launch.conditions": ("IfCondition",),
        "launch.substitutions": ("LaunchConfiguration",),
        "launch_ros": (),
        "launch_ros.actions": ("Node",),
    }
    for module, classes in names.items():
        made = ModuleType(module)
        for name in classes:
            setattr(made, name, type(name, (Kept,), {}))
        monkeypatch.setitem(sys.modules, module, made)
    spec = importlib.util.spec_from_file_location("scenario_launch", FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_launch_starts_every_node_with_the_parameters_of_the_runner(
    launch_file, monkeypatch, capsys, tmp_path
):
    def check_output(words, text):
        assert words[0].endswith("lib/ev_stack/ev-stack") and words[1] == "parameters"
        write_parameters(words[2:])
        return capsys.readouterr().out

    monkeypatch.setattr(launch_file, "subprocess", SimpleNamespace(check_output=check_output))
    (description,) = launch_file.generate_launch_description().words
    assert [each.words[0] for each in description[:-1]] == list(launch_file.ARGUMENTS)
    actions = description[-1].named["function"]({**GIVEN, "out": str(tmp_path / "out")})
    *nodes, visualization, rviz = [action.named for action in actions]
    run = load_scenario("shchur2019", Overrides((), [("asr", "method", "pi_slip")], 3.0)).runs[0]
    expected = node_parameters(run, tmp_path / "out", bag=True)
    assert [node["executable"] for node in nodes] == list(expected)
    assert {node["package"] for node in nodes} == {"ev_sim", "ev_control", "ev_stack"}
    assert {node["namespace"] for node in nodes} == {"/ev"}
    ends = {node["executable"] for node in nodes if node["on_exit"] is not None}
    assert ends == {"recorder"}  # it is the last one that has something to do
    ((file,),) = {tuple(node["parameters"]) for node in nodes}
    content = yaml.safe_load(Path(file).read_text())
    assert content == {
        f"/**/{name}": {"ros__parameters": values} for name, values in expected.items()
    }
    assert visualization["condition"] is rviz["condition"] is not None
    assert Path(rviz["arguments"][1]).name == "car.rviz" and Path(rviz["arguments"][1]).exists()


def test_a_scenario_that_cannot_be_is_one_line(tmp_path):
    with pytest.raises(SystemExit, match="error: unknown run of tatar_chudzik ''; known: "):
        write_parameters(["tatar_chudzik", "--out", str(tmp_path)])
