"""The contract and the laws keep their types, by the rules in setup.cfg, and nothing there is ignored wholesale."""

import configparser
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
WITHOUT_REASON = re.compile(r"# type: ignore(?!\[[\w, -]+\]  # \w)|# mypy:")


def rules() -> configparser.ConfigParser:
    parser = configparser.ConfigParser()
    parser.read(ROOT / "setup.cfg")
    return parser


def test_mypy_finds_nothing():
    found = subprocess.run([sys.executable, "-m", "mypy"], cwd=ROOT, capture_output=True, text=True)
    assert found.returncode == 0, found.stdout + found.stderr


def test_a_wrong_type_in_a_law_is_found(tmp_path: Path):
    """The rules see through `@method` and `@compilable`: a law of equal_torque that answers with a number."""
    law = ROOT / "src/ev_control/ev_control/electronic_differential/mechanical.py"
    wrong = tmp_path / "wrong.py"
    wrong.write_text(law.read_text().replace("return split(p.brake, car, driver, 0.0)", "return driver.drive_torque"))
    command = [sys.executable, "-m", "mypy", "--config-file", str(ROOT / "setup.cfg"), str(wrong)]
    found = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert 'expected "WheelTorqueRequest"' in found.stdout, found.stdout + found.stderr


def test_every_ignored_line_says_which_error_and_why():
    places = [ROOT / path.strip() for path in rules()["mypy"]["files"].split(",")]
    files = [file for place in places for file in place.rglob("*.py")]
    assert len(files) > 100
    assert [file for file in files if WITHOUT_REASON.search(file.read_text())] == []
    assert not any("ignore_errors" in rules()[section] for section in rules().sections())
