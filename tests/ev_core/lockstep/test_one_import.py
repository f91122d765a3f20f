"""One import gives an author all that a law needs, and costs no more than the parts of it."""

import ast
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import ev_core.law
from ev_core import elementary
from ev_msgs_py.contract.roles import ROLES

SRC = Path(__file__).parents[3] / "src"
DOORS = ("ev_core.law", "ev_control.law")
OF_BUSES = "ev_msgs_py.contract.optional_signals"  # which no law of a car reads


@pytest.mark.parametrize("door", DOORS)
def test_every_name_is_there_and_in_the_docstring_or_its_group(door: str):
    module = import_module(door)
    assert len(set(module.__all__)) == len(module.__all__)
    assert all(hasattr(module, name) for name in module.__all__)
    signals = {signal.__name__ for role in ROLES.values() for signal in (*role.reads, *role.writes)}
    grouped = signals | set(elementary.__all__) | {"FRONT_RIGHT", "REAR_LEFT"}
    assert [
        name for name in module.__all__ if name not in grouped and f"`{name}`" not in module.__doc__
    ] == []


def test_every_signal_of_a_car_can_be_named():
    signals = {signal for role in ROLES.values() for signal in (*role.reads, *role.writes)}
    wanted = {signal.__name__ for signal in signals if signal.__module__ != OF_BUSES}
    assert wanted - {"RecorderProgress"} <= set(ev_core.law.__all__)


@pytest.mark.parametrize("door", DOORS)
def test_it_loads_neither_the_compiler_nor_ros(door: str):
    code = f"import sys, {door}; print(*(name for name in ('numba', 'llvmlite', 'rclpy') if name in sys.modules))"
    assert (
        subprocess.run(
            [sys.executable, "-c", code], capture_output=True, text=True, check=True
        ).stdout
        == "\n"
    )


def test_the_core_does_not_go_in_by_its_own_door():
    for path in (SRC / "ev_core").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            assert not (isinstance(node, ast.ImportFrom) and node.module == "ev_core.law"), path
