"""Sampled tests: three of many cases, all of them on demand, and a case that is named always."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
FILE = "tests/ev_doors/export/test_on_processor.py"
CASE = "test_a_law_of_each_source_leaves_the_signals_as_they_are"
SOURCES = ["shchur2019", "ge_ni2005", "tatar_chudzik", "urban_mixed", "zhileykin2018"]


@pytest.mark.parametrize(
    ("words", "kept"),
    [
        ([FILE], SOURCES[::2]),
        pytest.param([FILE, "--all-cases"], SOURCES, marks=pytest.mark.weekly),
        pytest.param([f"{FILE}::{CASE}[{SOURCES[1]}]"], [SOURCES[1]], marks=pytest.mark.weekly),
    ],
)
def test_first_middle_and_last_case_are_kept(words: list[str], kept: list[str]):
    command = [sys.executable, "-m", "pytest", "--collect-only", "--quiet", *words]
    output = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert [line.partition("[")[2][:-1] for line in output.splitlines() if CASE in line] == kept
