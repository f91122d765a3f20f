"""A lack of memory is one line, whatever a library makes of it."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
from helpers.run_script import ENVIRONMENT, RUN

from ev_stack.commands import run_scenario
from ev_stack.commands.run_scenario import main

# What a lack of memory looks like: llvmlite raises an OSError that speaks of permissions, ROS an
# ImportError.
OF_LIBRARIES = [
    OSError("Could not find/load shared object file"),
    ImportError("libfastdds.so: failed to map segment"),
]


def ended_by(error: BaseException, free: float, monkeypatch: pytest.MonkeyPatch) -> str:
    """Last line of a command with so much free memory [bytes]; its run raises an error."""

    def drive(given):
        raise error

    monkeypatch.setattr("ev_stack.commands.drive_scenario.drive_scenario", drive)
    monkeypatch.setattr(run_scenario, "free_memory", lambda: free)
    monkeypatch.setattr(run_scenario, "KEPT", [])
    with pytest.raises(SystemExit) as ended:
        main(["shchur2019", "--offline"])
    return ended.value.code


@pytest.mark.parametrize("error", OF_LIBRARIES, ids=["OSError", "ImportError"])
def test_a_library_that_cannot_be_loaded_where_no_memory_is_left_is_called_that(error, monkeypatch):
    assert ended_by(error, 50e6, monkeypatch) == f"error: out of memory: {error}"


def test_an_error_of_memory_is_called_that(monkeypatch):
    assert ended_by(MemoryError(), 1e9, monkeypatch) == "error: out of memory"


def test_a_missing_file_is_named_where_no_memory_is_left_either(monkeypatch):
    message = ended_by(OSError(2, "No such file or directory", "name"), 50e6, monkeypatch)
    assert message == "error: name: No such file or directory"


def test_other_errors_are_not_called_out_of_memory(monkeypatch):
    message = ended_by(OSError(2, "No such file or directory", "name"), 1e9, monkeypatch)
    assert message == "error: name: No such file or directory"
    with pytest.raises(ImportError, match="no module of this name"):
        ended_by(ImportError("no module of this name"), 1e9, monkeypatch)


@pytest.mark.slow
@pytest.mark.parametrize("megabytes", [190, 400])
def test_a_run_within_a_small_limit_of_memory_ends_in_one_line(megabytes: int, tmp_path: Path):
    """It neither speaks of a broken installation nor crashes when Python ends."""
    words = [RUN, "shchur2019", "--in-process", "--duration", "0.1", "--out", tmp_path]
    limit = f'ulimit -v {megabytes * 1024}; exec "$@"'
    done = subprocess.run(
        ["bash", "-c", limit, "limited", *words], env=ENVIRONMENT, capture_output=True, text=True
    )
    assert done.returncode == 1
    assert re.fullmatch(r"error: out of memory(: .*)?\n", done.stderr), done.stderr
