"""Contract, laws and interface keep their types by setup.cfg; nothing is ignored wholesale."""

import ast
import configparser
import re
import subprocess
import sys
from pathlib import Path

import pytest

import ev_stack

ROOT = Path(__file__).parents[2]
RULES = configparser.ConfigParser()
RULES.read(ROOT / "setup.cfg")
WITHOUT_REASON = re.compile(r"# type: ignore(?!\[[\w, -]+\]  # \w)|# mypy:")
CALLS = """
import ev_stack

result = ev_stack.run("shchur2019", seed=2, set={"driver.seed": 3})
reveal_type(result.metrics)
reveal_type(ev_stack.batch("shchur2019").failed)
ev_stack.run("shchur2019", seed="two")
ev_stack.Simulation("shchur2019", veihcle="audi_a2")
"""


def test_mypy_finds_nothing():
    found = subprocess.run([sys.executable, "-m", "mypy"], cwd=ROOT, capture_output=True, text=True)
    assert found.returncode == 0, found.stdout + found.stderr


def test_a_wrong_type_in_a_law_is_found(tmp_path: Path):
    """The rules see through `@method` and `@compilable`.

    A law of equal_torque that answers with a number.
    """
    law = ROOT / "src/ev_control/ev_control/electronic_differential/mechanical.py"
    wrong = tmp_path / "wrong.py"
    wrong.write_text(
        law.read_text().replace(
            "return split(p.brake, car, driver, 0.0)", "return driver.drive_torque"
        )
    )
    command = [sys.executable, "-m", "mypy", "--config-file", str(ROOT / "setup.cfg"), str(wrong)]
    found = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert 'expected "WheelTorqueRequest"' in found.stdout, found.stdout + found.stderr


@pytest.mark.weekly
@pytest.mark.slow
def test_a_program_that_calls_the_packages_gets_their_types(tmp_path: Path):
    """A checker that knows only what is installed finds py.typed.

    Its cache is its own, as its rules are.
    """
    program = tmp_path / "program.py"
    program.write_text(CALLS)
    command = [
        sys.executable,
        "-m",
        "mypy",
        "--cache-dir",
        str(ROOT / ".mypy_cache" / "program"),
        str(program),
    ]
    found = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True).stdout
    assert re.findall(r"program.py:\d+: (.*)", found)[:4] == [
        'note: Revealed type is "typing.Mapping[str, ev_stack.measures.metric.Metric]"',
        'note: Revealed type is "typing.Mapping[int, str]"',
        'error: Argument "seed" to "run" has incompatible type "str"; expected "int | None"  [arg-type]',
        'error: Unexpected keyword argument "veihcle" for "Simulation"; did you mean "vehicle"?  [call-arg]',
    ]


def test_the_types_of_the_interface_are_those_of_what_is_imported():
    """The stub beside `__init__.py` names the same modules: a checker sees what a program gets."""
    stub = ast.parse(Path(ev_stack.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    imports = [node for node in stub.body if isinstance(node, ast.ImportFrom)]
    assert {each.name: node.module for node in imports for each in node.names} == ev_stack._MODULES
    (listed,) = (node.value for node in stub.body if isinstance(node, ast.Assign))
    assert ast.literal_eval(listed) == ev_stack.__all__


def test_every_ignored_line_says_which_error_and_why():
    places = [ROOT / path.strip() for path in RULES["mypy"]["files"].split(",")]
    files = [
        file for place in places for file in (place.rglob("*.py") if place.is_dir() else [place])
    ]
    assert len(files) > 100
    assert [file for file in files if WITHOUT_REASON.search(file.read_text())] == []
    assert not any("ignore_errors" in rules for rules in RULES.values())
