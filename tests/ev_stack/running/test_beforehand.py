"""A run compiles its code before it begins: that code only, once, counted, interrupted or not."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from helpers.run_script import ENVIRONMENT, RUN

from ev_core.compiling import user_cache
from ev_stack.running import beforehand
from ev_stack.running.beforehand import Unit, compile_for, compile_units
from ev_stack.scenarios.scenario import load_scenario

METHODS = {
    "plant kinematic",
    "steering_column powered",
    "driver speed_profile",
    "electronic_differential power_steering",
    "asr off",
}
NODES = {"node_steps"}


@pytest.mark.parametrize(
    ("in_nodes", "others", "needed"),
    [
        (True, (), METHODS | NODES),
        (True, ("asr",), METHODS - {"asr off"} | NODES),
        (False, (), METHODS | {"run_instants", "run_through"}),
    ],
)
def test_a_run_compiles_what_it_needs_and_nothing_else(in_nodes, others, needed, monkeypatch):
    """Other installed methods are left out, and roles played by a user's own program."""
    found: list[Unit] = []
    monkeypatch.setattr(beforehand, "compile_units", found.extend)
    compile_for(load_scenario("shchur2019").runs, in_nodes, others)
    assert found[0].name == "plant kinematic", "what takes longest comes first"
    assert {unit.name for unit in found} == needed


def test_without_ros_nothing_is_compiled_for_nodes(monkeypatch):
    monkeypatch.setattr(beforehand, "find_spec", lambda _: None)
    assert beforehand.stepping(in_nodes=True) == []
    assert [unit.name for unit in beforehand.stepping(in_nodes=False)] == [
        "run_instants",
        "run_through",
    ]


def _unit(folder: Path, name: str, make=None) -> Unit:
    file = folder / name
    return Unit(name, file.exists, make or (lambda: file.write_text(str(os.getpid()))), name)


def test_what_is_missing_is_made_on_all_cores_and_counted(tmp_path, monkeypatch, capsys):
    """Present and repeated units are not made.

    An error is one line. A process that is killed takes no other along.
    """
    monkeypatch.setattr(beforehand, "_processes", lambda: 2)
    (tmp_path / "there").touch()

    def fail() -> None:
        raise ZeroDivisionError("no\nway")

    def die() -> None:
        os.kill(os.getpid(), signal.SIGKILL)

    units = [_unit(tmp_path, name) for name in ("one", "two", "there", "two", "three")]
    errors = compile_units([_unit(tmp_path, "lost", die), _unit(tmp_path, "wrong", fail), *units])
    assert sorted(errors) == [
        "lost: the process that compiled it was killed",
        "wrong: ZeroDivisionError: no",
    ]
    makers = {(tmp_path / name).read_text() for name in ("one", "two", "three")}
    assert str(os.getpid()) not in makers
    assert (tmp_path / "there").read_text() == ""
    assert re.search(r"compiling \(once\) 5 of 5 \|#+\|", capsys.readouterr().err)
    assert compile_units(units) == []
    assert capsys.readouterr().err == "", "what is there is only looked for"


def test_beside_other_threads_nothing_is_forked(tmp_path):
    """Locks of a thread would be held for ever in a forked process, as in a notebook."""
    done = threading.Event()
    thread = threading.Thread(target=done.wait)
    thread.start()
    try:
        assert compile_units([_unit(tmp_path, "one"), _unit(tmp_path, "two")]) == []
    finally:
        done.set()
        thread.join()
    assert (tmp_path / "one").read_text() == (tmp_path / "two").read_text() == str(os.getpid())


STEP = """
from ev_core.compiling import machine_code
code = machine_code.Code("seven", '''
from numba import cfunc, types
P = types.voidptr
@cfunc(types.int32(P, P, P, P))
def step(a, b, c, d):
    return 7
''', {})
"""
ADDRESS = "print(machine_code.call(code.address(), 0, 0, 0, 0))"
HOLD = """
import time
machine_code.compiled_address = lambda *_: (print("holding", flush=True), time.sleep(600))
code.address()
"""


def started(text: str, cache: Path) -> subprocess.Popen:
    environment = {**os.environ, user_cache.VARIABLE: str(cache)}
    return subprocess.Popen(
        [sys.executable, "-c", STEP + text],
        env=environment,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )


FUNCTION = """
text = "from numba import njit\\n@njit\\ndef step():\\n    return 7"
print(machine_code.compiled_function("seven", text, {})())
"""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "kind"),
    [(ADDRESS, ".code"), pytest.param(FUNCTION, ".numba", marks=pytest.mark.weekly)],
    ids=["C", "Python"],
)
def test_processes_that_need_the_same_code_at_once_compile_it_once(text, kind, tmp_path):
    """C and Python callers share one compilation."""
    cache = tmp_path / "cache"
    outputs = [process.communicate() for process in [started(text, cache) for _ in range(4)]]
    assert [out for out, _ in outputs] == ["7\n"] * 4
    assert sum(err.count("compiling seven ... (once)") for _, err in outputs) == 1
    assert [file.suffix for file in cache.iterdir()] == [kind]


@pytest.mark.slow
def test_a_process_killed_while_it_compiles_keeps_no_other_from_it(tmp_path):
    """Waiting and later processes compile after a kill."""
    cache = tmp_path / "cache"
    holder = started(HOLD, cache)
    assert holder.stdout.readline() == "holding\n"
    waiting = started(ADDRESS, cache)
    time.sleep(1.0)
    assert waiting.poll() is None
    holder.kill()
    assert waiting.communicate()[0] == "7\n"
    holder.communicate()
    assert started(ADDRESS, cache).communicate()[0] == "7\n"


@pytest.mark.slow
@pytest.mark.weekly
def test_a_run_that_is_stopped_while_it_compiles_ends_at_once_and_the_next_one_goes_on(tmp_path):
    """Ctrl-C reaches all processes, SIGTERM the command alone.

    Nothing is left but what is compiled already.
    """
    words = [
        RUN,
        "shchur2019",
        "--offline",
        "--no-record",
        "--no-report",
        "--out",
        tmp_path / "out",
    ]
    for kind in (signal.SIGINT, signal.SIGTERM):
        cache = tmp_path / kind.name
        environment = {**ENVIRONMENT, user_cache.VARIABLE: str(cache)}
        run = subprocess.Popen(
            words,
            env=environment,
            text=True,
            stderr=subprocess.PIPE,
            start_new_session=True,
            # in the background, too
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        )
        while not cache.exists() or not [*cache.glob(".*.lock")]:
            assert run.poll() is None
            time.sleep(0.02)
        (os.killpg if kind is signal.SIGINT else os.kill)(run.pid, kind)
        output = run.communicate()[1]
        assert run.returncode == 130
        assert output.endswith("stopped\n") and "Traceback" not in output
        with pytest.raises(ProcessLookupError):
            os.killpg(run.pid, 0)
    again = subprocess.run(words, env=environment, text=True, capture_output=True)
    assert again.returncode == 0, again.stderr
    assert "compiling (once)" in again.stderr
    assert not [*cache.glob(".*")]
