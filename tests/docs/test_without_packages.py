"""A package that nothing else imports can be left out.

What remains drives, and does not offer its commands.
"""

from __future__ import annotations

import subprocess
import sys

import pytest

# Neither its modules nor its entry points are found where its folders are not on the path.
WITHOUT = """
import sys
left_out = sys.argv.pop(1)
sys.path[:] = [folder for folder in sys.path if left_out not in folder]
from ev_stack.commands.program import main
main()
"""


def ev_stack(left_out: str, *words: str) -> subprocess.CompletedProcess[str]:
    """`ev-stack WORDS` where a package is not installed."""
    command = [sys.executable, "-c", WITHOUT, left_out, *words]
    return subprocess.run(command, capture_output=True, text=True)


@pytest.mark.parametrize("left_out", ["ev_bench", "ev_study", "ev_doors", "ev_papers"])
def test_what_remains_drives(left_out: str, tmp_path):
    words = (
        "run",
        "step_steer",
        "--run",
        "left",
        "--duration",
        "1",
        "--offline",
        "--no-record",
        "--no-report",
    )
    driven = ev_stack(left_out, *words, "--out", str(tmp_path))
    assert driven.returncode == 0, driven.stderr
    assert "signal hash" in driven.stdout


def test_commands_of_what_is_left_out_are_not_known():
    refused = ev_stack("ev_doors", "fmu", "step_steer")
    assert refused.returncode == 2
    assert (
        refused.stderr.startswith("ev-stack: unknown command 'fmu'")
        and refused.stderr.count("\n") == 1
    )


def test_no_law_runs_on_another_processor_without_its_programs(tmp_path):
    words = (
        "run",
        "shchur2019",
        "--offline",
        "--no-record",
        "--processor",
        "asr=cortex-m4",
        "--out",
        str(tmp_path),
    )
    refused = ev_stack("ev_doors", *words)
    assert refused.returncode == 1
    assert (
        refused.stderr
        == "error: --processor needs the package ev_doors, which is not installed here\n"
    )
