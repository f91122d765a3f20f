"""Every touch of numba's inside can be switched off: another numba costs time alone."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

import ev_stack
from ev_core.compiling import inside_numba
from ev_msgs_py.refusal import ParameterError

ROOT = Path(__file__).parents[3]
TOOL = ROOT / "tools" / "newest_numba.py"


@pytest.fixture(autouse=True)
def forgets():
    """Forget which touches are switched off: each process asks once."""
    yield
    inside_numba.switched_off.cache_clear()
    inside_numba.is_used.cache_clear()


@pytest.mark.weekly
@pytest.mark.slow
def test_a_graph_that_is_compiled_in_the_plain_way_has_the_same_signal_hash(tmp_path: Path):
    """Driver, law, ASR, column and plant, in a process with an empty cache; and the tool starts."""
    done = subprocess.run(
        [sys.executable, TOOL, "--smoke"], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout + done.stderr
    rows = [
        re.split(r" *\| *", line)[1:-1] for line in done.stdout.splitlines() if line.startswith("|")
    ]
    expected = ev_stack.run("shchur2019", duration=0.5).hash[:12]
    assert [(way, shown, verdict) for way, _, _, shown, verdict in rows[2:]] == [
        ("plain", expected, "same bits"),
        ("all touches", expected, "same bits"),
    ]


def test_a_touch_that_is_none_is_refused_in_one_line(monkeypatch: pytest.MonkeyPatch):
    inside_numba.switched_off.cache_clear()
    monkeypatch.setenv(inside_numba.VARIABLE, "stack, stak")
    with pytest.raises(
        ParameterError, match="EV_STACK_PLAIN_NUMBA: 'stak' is refused, expected all, or some of"
    ):
        inside_numba.switched_off()


def test_a_touch_without_its_names_is_not_used(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    """One line says so; all those of the installed numba are there."""
    assert all(map(inside_numba.is_used, inside_numba.TOUCHES))
    inside_numba.is_used.cache_clear()
    monkeypatch.setitem(inside_numba.TOUCHES, "stack", "core.cgutils:alloca_twice")
    assert not inside_numba.is_used("stack")
    output = capsys.readouterr().err
    assert re.fullmatch(
        "numba is another one, so stack goes the plain way, .*alloca_twice.*\n", output
    )


def test_no_other_file_touches_it():
    """Others import what is documented: carray, cfunc, njit, types.

    Symbols of ELF files are not numba's.
    """
    inside = re.compile(
        r"numba\.(core|cpython|np|experimental)|_impl_cache|\._library\b|\._cache\b|c_helpers"
    )
    files = [path for path in (ROOT / "src").rglob("*.py") if inside.search(path.read_text())]
    assert sorted(path.name for path in files) == [
        "inside_numba.py",
        "inside_numba_checks.py",
        "inside_numba_code.py",
    ]
