"""Sampled tests: three of many cases, all of them on demand, and a case that is named always."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SETUP = "tests/docs/test_setup.py"
CASE = "test_beside_a_distribution_only_what_it_lacks_is_installed"


@pytest.mark.parametrize(
    ("words", "distributions"),
    [
        ([SETUP], ["jazzy", "lyrical", "rolling"]),
        ([SETUP, "--all-cases"], ["jazzy", "kilted", "lyrical", "rolling"]),
        ([f"{SETUP}::{CASE}[kilted]"], ["kilted"]),
    ],
)
def test_first_middle_and_last_case_are_kept(words: list[str], distributions: list[str]):
    command = [sys.executable, "-m", "pytest", "--collect-only", "--quiet", *words]
    said = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert [line.partition("[")[2][:-1] for line in said.splitlines() if CASE in line] == distributions
