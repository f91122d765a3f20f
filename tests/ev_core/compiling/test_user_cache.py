"""Compiled code lies where only this user can write, and is never loaded when it is damaged."""

from __future__ import annotations

import errno
import os
import re
import shutil
import subprocess
import sys
from collections import namedtuple
from collections.abc import Callable
from contextlib import suppress
from enum import IntEnum
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import cfunc, float64, njit, vectorize
from numba.experimental import jitclass

from ev_core.compiled.loop import compiled
from ev_core.compiling import user_cache
from ev_core.compiling.fingerprint import fingerprint
from ev_core.compiling.user_cache import cache_folder, read_checked, write_checked
from ev_core.law import ParameterError, compilable
from ev_core.parameters.data_file import files_read
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import signal_hash
from ev_stack.scenarios.scenario import load_scenario

DRIVE = """
from ev_stack.recording.recording import signal_hash
from ev_stack.recording.offline import run_offline
from ev_stack.scenarios.scenario import load_scenario
print(signal_hash(run_offline(load_scenario("shchur2019").runs[0].configurations, 0.2)))
"""


def folder(monkeypatch, **named: Path) -> Path:
    """The cache folder under this environment, looked up afresh."""
    for name in (user_cache.VARIABLE, "XDG_CACHE_HOME"):
        monkeypatch.setenv(name, "")  # what it is set to by the folder itself is taken back, too
        monkeypatch.delenv(name)
    for name, path in named.items():
        monkeypatch.setenv(name, str(path))
    return cache_folder.__wrapped__()


def test_it_is_the_users_own(tmp_path, monkeypatch):
    """Made with mode 0700.

    A name of its own goes before that of the desktop, and this before the home.
    """
    assert folder(monkeypatch, HOME=tmp_path) == tmp_path / ".cache" / "ev_stack"
    assert (
        folder(monkeypatch, HOME=tmp_path, XDG_CACHE_HOME="relative")
        == tmp_path / ".cache" / "ev_stack"
    )
    assert (
        folder(monkeypatch, HOME=tmp_path, XDG_CACHE_HOME=tmp_path / "xdg")
        == tmp_path / "xdg" / "ev_stack"
    )
    made = folder(monkeypatch, XDG_CACHE_HOME=tmp_path / "xdg", EV_STACK_CACHE=tmp_path / "own")
    assert made == tmp_path / "own"
    assert made.stat().st_mode & 0o777 == 0o700


@pytest.mark.parametrize("mode", [0o770, 0o702, 0o777, 0o1777])
def test_what_others_may_write_into_is_refused(tmp_path, monkeypatch, mode):
    """One line names folder, mode and what is expected."""
    (tmp_path / "own").mkdir()
    (tmp_path / "own").chmod(mode)
    with pytest.raises(
        ParameterError,
        match=rf"^what is compiled .*{tmp_path}/own: others may write into .* {mode:04o}",
    ):
        folder(monkeypatch, EV_STACK_CACHE=tmp_path / "own")


def test_what_lies_in_a_folder_of_everybody_is_refused(tmp_path, monkeypatch):
    """Any user could exchange the folder, unless the sticky bit forbids it, as in /tmp."""
    (tmp_path / "open").mkdir()
    (tmp_path / "open").chmod(0o777)
    (tmp_path / "link").symlink_to(tmp_path / "open")
    for way in ("open", "link"):
        with pytest.raises(
            ParameterError, match=rf"others may write into {tmp_path}/open \(mode 0777\)"
        ):
            folder(monkeypatch, EV_STACK_CACHE=tmp_path / way / "own")
    (tmp_path / "open").chmod(0o1777)
    assert folder(monkeypatch, EV_STACK_CACHE=tmp_path / "link" / "own")


@pytest.mark.parametrize("kind", ["folder", "link"])
def test_what_belongs_to_another_user_is_refused(tmp_path, monkeypatch, kind):
    """A folder, or a link to one of our own."""
    (tmp_path / "own").mkdir(mode=0o700)
    (tmp_path / "link").symlink_to(tmp_path / "own")
    theirs, other = tmp_path / ("own" if kind == "folder" else "link"), os.getuid() + 1
    found = Path.lstat

    def lstat(path: Path) -> os.stat_result:
        real = found(path)
        return os.stat_result((*real[:4], other, *real[5:])) if path == theirs else real

    monkeypatch.setattr(Path, "lstat", lstat)
    with pytest.raises(
        ParameterError, match=rf"{theirs} belongs to user {other}; expected a folder of your own"
    ):
        folder(monkeypatch, EV_STACK_CACHE=tmp_path / "link")


def test_without_a_home_it_goes_with_the_process(tmp_path, monkeypatch, capsys):
    """Processes that it starts share it; the line says which folder it is."""
    (tmp_path / "file").touch()
    made = folder(monkeypatch, HOME=tmp_path / "file")
    try:
        assert made.stat().st_mode & 0o777 == 0o700
        assert os.environ[user_cache.VARIABLE] == str(made)
        message = f"{tmp_path}/file/.cache/ev_stack cannot be written: what is compiled is kept in {made} until this ends\n"
        assert capsys.readouterr().err == message
    finally:
        made.rmdir()
        monkeypatch.delenv(user_cache.VARIABLE)
    with pytest.raises(ParameterError, match=rf"^EV_STACK_CACHE: {tmp_path}/file: File exists$"):
        folder(monkeypatch, EV_STACK_CACHE=tmp_path / "file")


@given(
    content=st.binary(max_size=200),
    at=st.floats(0.0, 1.0, exclude_max=True),
    change=st.integers(0, 255),
)
def test_a_file_is_read_whole_or_not_at_all(tmp_path_factory, content, at, change):
    """Change 0 cuts it off there, any other changes a byte."""
    file = tmp_path_factory.mktemp("files") / "some.code"
    write_checked(file, content)
    with files_read() as inputs:
        assert read_checked(file) == content
    assert not inputs  # else what a run depends on would change with what was compiled before
    written = file.read_bytes()
    place = int(at * len(written))
    rest = bytes([written[place] ^ change]) + written[place + 1 :] if change else b""
    file.write_bytes(written[:place] + rest)
    assert read_checked(file) is None
    assert not file.exists()


@pytest.mark.weekly
@pytest.mark.slow
def test_damaged_files_are_named_and_made_again(tmp_path):
    """Cut off machine code killed the process by SIGSEGV; a changed byte may do anything."""
    configurations = load_scenario("shchur2019").runs[0].configurations
    expected = signal_hash(run_offline(configurations, 0.2))
    copy = tmp_path / "cache"
    copy.mkdir(mode=0o700)
    for file in filter(Path.is_file, cache_folder().iterdir()):
        with suppress(FileNotFoundError):  # another test has forgotten it meanwhile
            shutil.copy2(file, copy)
    damaged = [*copy.glob("powered_steering_column_*.code"), *copy.glob("run_instants_*.code")]
    for file in damaged:
        content = file.read_bytes()
        half = len(content) // 2
        file.write_bytes(
            content[:half]
            + (b"" if "column" in file.name else bytes([content[half] ^ 1]) + content[half + 1 :])
        )
    environment = {**os.environ, user_cache.VARIABLE: str(copy)}
    for again in (False, True):
        done = subprocess.run(
            [sys.executable, "-c", DRIVE], capture_output=True, text=True, env=environment
        )
        assert (done.returncode, done.stdout.strip()) == (0, expected), done.stderr
        named = re.findall(
            r"^(\S+) does not fit its checksum: it is removed and made again$", done.stderr, re.M
        )
        assert bool(named) is not again
        parts = {Path(name).name.rpartition("_")[0] for name in named}
        assert parts == (set() if again else {"powered_steering_column", "run_instants"})


def test_the_fingerprint_changes_with_all_that_is_reached():
    """Defaults and what a module is asked for as well.

    In a folder of all checkouts the old numbers would come back.
    """

    def text(default: float, constant: float, array: object) -> str:
        module = type(sys)("some_tyre")
        module.__file__ = "some_tyre.py"
        exec(f"K = {constant}\ndef curve(x):\n    return K * x", vars(module))
        names = {"some_tyre": module, "TABLE": array}
        exec(f"def law(x, y={default}):\n    return some_tyre.curve(x) + y + TABLE[0]", names)
        return fingerprint(names["law"])

    long = np.arange(2000.0)
    other = long.copy()
    other[1000] = -1.0
    assert text(1.0, 2.0, long) == text(1.0, 2.0, long.copy())
    assert (
        len(
            {
                text(1.0, 2.0, long),
                text(1.5, 2.0, long),
                text(1.0, 2.5, long),
                text(1.0, 2.0, other),
            }
        )
        == 4
    )


def test_the_fingerprint_tells_apart_what_stands_side_by_side():
    """Digits in a row, tuples, modules of modules, members and options differ."""

    def of(text: str, **names: object) -> str:
        exec(f"def law(x, y=A):\n    return {text}", names)
        return fingerprint(names["law"])

    def module(name: str, **names: object) -> ModuleType:
        made = ModuleType(name)
        vars(made).update(names, __file__=name)
        return made

    def plus(number: int) -> Callable[[float], float]:
        return lambda x: x + number

    def counting(number: int) -> type:
        class Counting:
            def __init__(self) -> None:
                self.k = 1.0

            @property
            def grown(self) -> float:
                return self.k + number

        return jitclass([("k", float64)])(Counting)

    row = np.linspace(0.0, 1.0, 5)
    different = (
        ("x * A + B", {"A": 1.0, "B": 10.0}, {"A": 1.01, "B": 0.0}),
        ("x * A[0][1]", {"A": (row,)}, {"A": (row + 1e-12,)}),
        # as one of Python's own is called
        ("x * A.K", *({"A": module("profile", K=k)} for k in (1.0, 2.0))),
        ("x * A.inner.K", *({"A": module("a", inner=module("b", K=k))} for k in (1.0, 2.0))),
        ("x * A.ON", *({"A": IntEnum("A", {"ON": k})} for k in (1, 2))),
        ("A[0](x)", {"A": (plus(1),)}, {"A": (plus(2),)}),
        ("A(x)", *({"A": njit(plus(1), fastmath=fast)} for fast in (False, True))),
        ("A(x)", *({"A": cfunc(float64(float64))(plus(k))} for k in (1, 2))),
        ("A(x)", *({"A": vectorize([float64(float64)])(plus(k))} for k in (1, 2))),
        ("A().grown", *({"A": counting(k)} for k in (1, 2))),
    )
    for text, one, other in different:
        assert of(text, **one) == of(text, **one)
        assert of(text, **one) != of(text, **other), text
    assert of("A[0](x)", A=(plus(1),)) == of("A[0](x)", A=(plus(1),))


def test_the_fingerprint_knows_no_addresses():
    """A decorator named like an attribute of the law adds no address of this process."""
    alive, found = [], set()
    for _ in range(3):
        names = {"mark": partial(lambda: None)}
        exec("def law(x):\n    return x.mark", names)
        alive.append(names)
        found.add(fingerprint(names["law"]))
    assert len(found) == 1


@pytest.mark.parametrize("names", [["a", "b"], ["b", "a"]])
def test_what_is_compiled_for_a_named_tuple_knows_its_order(names):
    """The same names in another order, within another tuple, are another type."""
    inner = namedtuple("Inner", names)
    assert compiled(_first)(namedtuple("Outer", ["inner"])(inner(a=1.0, b=2.0))) == 1.0


@compilable
def _first(outer: Any) -> Any:
    return outer.inner.a


def test_what_cannot_be_written_is_named_and_leaves_nothing(tmp_path, monkeypatch):
    """The line of a full disk names the file, and no half of one stays."""

    def full(descriptor: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match=rf"No space left on device: '{tmp_path}/law\.code'$"):
        write_checked(tmp_path / "law.code", b"code")
    assert not [*tmp_path.iterdir()]
    os.mkfifo(tmp_path / "law.code")
    with pytest.raises(OSError, match="it is a pipe"):
        read_checked(tmp_path / "law.code")
