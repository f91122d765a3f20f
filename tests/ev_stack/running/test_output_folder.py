"""Nothing of the user's is deleted or replaced, whatever is in the folder and the command."""

from __future__ import annotations

import errno
import os
import signal
import subprocess
import sys
from argparse import ArgumentTypeError
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from datetime import datetime
from pathlib import Path

import pytest

import ev_stack
from ev_msgs_py.refusal import ParameterError
from ev_stack.command_line.paths import output_path
from ev_stack.commands import program
from ev_stack.recording.recording import atomic_file
from ev_stack.running import output_folder as module
from ev_stack.running.output_folder import LATEST, new_file, new_or_empty, output_folder

SHORT = ("--duration", "0.02", "--no-report")
OFFLINE = ("run", "coast_down", "--offline", "--no-record", *SHORT)
COMMANDS = (
    (*OFFLINE, "--out", "{out}"),
    ("run", "sweep", "coast_down", "--seeds", "2", "--workers", "1", *SHORT, "--out", "{out}"),
    ("run", "replay", "{driven}", "--node", "asr=off", "--vehicle", "compact_ev", "--out", "{out}"),
    ("run", "report", "{driven}", "--out", "{out}/report.html"),
    ("run", "tune", "pi", "--budget", "2", "--out", "{out}"),
    ("run", "benchmark", "--draws", "1", "--out", "{out}"),
    ("parameters", "coast_down", "--out", "{out}"),
    ("export", "shchur2019", "--only", "driver", "--target", "x86_64-linux", "--out", "{out}"),
    ("fmu", "shchur2019", "--only", "driver", "--target", "x86_64-linux", "--out", "{out}/car.fmu"),
)
# What a user may have there, also under the names of our own files.
NAMES = ("thesis.pdf", "summary.json", "report.html", "bag", "latest", "car.fmu", ".hidden", "x y")
THINGS: dict[str, Callable[[Path], object]] = {
    "file": lambda path: path.write_text("mine"),
    "empty file": lambda path: path.touch(),
    "folder": lambda path: path.mkdir(),
    "link": lambda path: path.symlink_to("/elsewhere/folder"),
}


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> ev_stack.Result:
    return ev_stack.run("shchur2019", duration=0.02)


@pytest.fixture(scope="module")
def saved(driven: ev_stack.Result, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return driven.save(tmp_path_factory.mktemp("driven"))


def content(folder: Path) -> dict[Path, object]:
    """Content of each place below a folder, or the target of its link."""
    found: dict[Path, object] = {}
    for path in folder.rglob("*"):
        if path.is_symlink():
            found[path] = os.readlink(path)
        else:
            found[path] = path.read_bytes() if path.is_file() else "folder"
    return found


@pytest.mark.parametrize("thing", THINGS)
@pytest.mark.parametrize("name", NAMES)
def test_a_folder_that_holds_anything_is_refused(tmp_path: Path, name: str, thing: str):
    """Nothing is proof enough that it is ours to replace; a file is refused for its own name."""
    THINGS[thing](tmp_path / name)
    before = content(tmp_path)
    for refused, path in ((new_or_empty, tmp_path), (new_file, tmp_path / name)):
        with pytest.raises(ParameterError, match=rf"^{tmp_path}.*, expected .* new .*"):
            refused(path)
    assert content(tmp_path) == before


@pytest.mark.sampled
@pytest.mark.parametrize("command", COMMANDS, ids=lambda words: " ".join(words[:2]))
def test_no_command_writes_where_anything_is(saved: Path, tmp_path: Path, command: Sequence[str]):
    """One line says what is there, before hours of driving."""
    name = Path(command[-1]).name if "/" in command[-1] else "summary.json"
    (tmp_path / name).write_text("mine")
    before = content(tmp_path)
    with pytest.raises(SystemExit) as ended:
        program.perform([word.format(out=tmp_path, driven=saved) for word in command])
    line = str(ended.value.code)
    assert line.startswith(f"error: {tmp_path}") and "expected" in line and "\n" not in line
    assert content(tmp_path) == before


def test_a_result_is_not_saved_where_anything_is(saved: Path, driven: ev_stack.Result):
    """A result does not even replace itself."""
    before = content(saved)
    with pytest.raises(ParameterError, match=r"is there, expected a new or an empty folder$"):
        driven.save(saved)
    assert content(saved) == before


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Results go into an empty folder, at one time of day."""

    class StoppedClock(datetime):
        @classmethod
        def now(cls, tz: object = None) -> StoppedClock:
            return cls(2026, 5, 4, 10, 0, 0)

    monkeypatch.setattr(module, "datetime", StoppedClock)
    monkeypatch.chdir(tmp_path)
    return tmp_path


TIME = "2026-05-04_10-00-00"


def write(text: str) -> Path:
    with output_folder(None, "a") as folder:
        (folder / "summary.json").write_text(text)
    return folder


def test_each_run_has_a_folder_of_its_own_and_latest_leads_to_the_last(here: Path):
    """The second one within a second, too."""
    for number, text in enumerate(("first", "second", "third")):
        assert write(text).name == (f"{TIME}_{number + 1}" if number else TIME)
        assert Path("results", "a", LATEST, "summary.json").read_text() == text
    assert Path("results", "a", TIME, "summary.json").read_text() == "first"
    assert len(os.listdir("results/a")) == 4


def test_a_scenario_that_is_driven_twice_keeps_both(here: Path, driven: ev_stack.Result):
    """Command line and Python keep both; commands that read a run can follow the links."""
    program.perform(OFFLINE)
    before = content(here)
    program.perform(OFFLINE)
    assert (
        before.items()
        <= {**content(here), **{p: before[p] for p in before if p.is_symlink()}}.items()
    )
    folder = driven.save()
    assert folder == here / "results" / "shchur2019" / TIME
    program.perform(("run", "report", "results/coast_down/latest", "results/shchur2019/latest"))
    assert Path("results", "report", "latest", "report.html").exists()


def test_runs_at_once_never_share_a_folder(here: Path):
    with ThreadPoolExecutor(8) as pool:
        folders = [*pool.map(write, map(str, range(40)))]
    assert [(folder / "summary.json").read_text() for folder in folders] == [*map(str, range(40))]
    assert {folder.name for folder in folders} == set(os.listdir("results/a")) - {LATEST}


KILLED = """
import os, signal, sys
from ev_stack.running.output_folder import output_folder

def kill(*words):
    os.kill(os.getpid(), signal.SIGKILL)

if sys.argv[1] != "block":
    setattr(os, sys.argv[1], kill)
with output_folder(None, "a") as folder:
    (folder / "signals.npz").touch()
    if sys.argv[1] == "block":
        kill()
"""


@pytest.mark.parametrize("moment", ["block", "symlink", "replace"])
def test_a_run_that_is_killed_leaves_the_link_of_the_run_before(here: Path, moment: str):
    """A kill between making the link and naming it does not hold up the next run."""
    first = write("first")
    code = subprocess.run([sys.executable, "-c", KILLED, moment]).returncode
    assert code == -signal.SIGKILL
    assert Path("results", "a", LATEST).resolve() == first
    assert Path("results", "a", LATEST).resolve() != write("second")
    assert Path("results", "a", LATEST, "summary.json").read_text() == "second"


def test_a_run_that_fails_names_what_it_has_written_and_leaves_no_empty_folder(here: Path, capsys):
    first = write("first")
    with suppress(ZeroDivisionError), output_folder(None, "a"):
        raise ZeroDivisionError
    assert capsys.readouterr().err == ""
    assert sorted(os.listdir("results/a")) == [TIME, LATEST]
    with suppress(ZeroDivisionError), output_folder(None, "a") as folder:
        (folder / "signals.npz").touch()
        raise ZeroDivisionError
    assert capsys.readouterr().err == f"note: what was written until then is in {folder}\n"
    assert (folder / "signals.npz").exists()
    assert Path("results", "a", LATEST).resolve() == first


@pytest.mark.parametrize("thing", ["file", "folder", "link"])
def test_a_users_own_latest_stays(here: Path, capsys: pytest.CaptureFixture, thing: str):
    Path("results", "a").mkdir(parents=True)
    THINGS[thing](Path("results", "a", LATEST))
    before = content(here)
    folder = write("first")
    assert before.items() <= content(here).items()
    assert set(os.listdir("results/a")) == {LATEST, folder.name}
    assert capsys.readouterr().err.endswith(
        "does not lead to 2026-05-04_10-00-00: it is no link of ours\n"
    )


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EROFS, errno.EACCES, errno.EPERM])
def test_a_disk_that_takes_nothing_is_one_line(here: Path, monkeypatch, number: int):
    """The disk is full, read-only, or another user's."""

    def refused(path: object, mode: int = 0o777) -> None:
        raise OSError(number, os.strerror(number), str(path))

    monkeypatch.setattr(os, "mkdir", refused)
    for words in ((), ("--out", "mine")):
        with pytest.raises(SystemExit) as ended:
            program.perform((*OFFLINE, *words))
        line = str(ended.value.code)
        assert line.startswith("error: ") and os.strerror(number) in line and "\n" not in line
    assert not os.listdir(here)


def test_a_disk_without_links_keeps_the_results(here: Path, monkeypatch, capsys):
    def refused(*words: object, **more: object) -> None:
        raise OSError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "symlink", refused)
    assert (write("first") / "summary.json").read_text() == "first"
    assert capsys.readouterr().err.endswith("Operation not permitted\n")


def test_a_folder_that_cannot_be_written_is_refused_before_anything_is_driven(
    tmp_path, monkeypatch
):
    monkeypatch.setattr(os, "access", lambda path, mode: False)  # root may write everywhere else
    with pytest.raises(
        ParameterError, match=r"it is read-only, expected a new or an empty folder$"
    ):
        new_or_empty(tmp_path)


@pytest.mark.parametrize("name", [os.fsdecode(b"\xff"), "a\0b", "file", "file/below"])
def test_what_can_be_no_folder_is_refused(tmp_path: Path, name: str):
    (tmp_path / "file").touch()
    with pytest.raises(ParameterError, match=r", expected a new or an empty folder$"):
        new_or_empty(tmp_path / name)
    assert os.listdir(tmp_path) == ["file"]


@pytest.mark.parametrize("name", ["new", "new/below", "empty", "link"])
def test_a_new_and_an_empty_folder_are_taken(tmp_path: Path, name: str):
    (tmp_path / "empty").mkdir()
    (tmp_path / "link").symlink_to("empty")
    assert new_or_empty(tmp_path / name) == tmp_path / name
    assert (tmp_path / name).is_dir()


def test_a_new_file_may_be_in_a_new_folder(tmp_path: Path):
    assert new_file(tmp_path / "new" / "car.fmu").parent.is_dir()


@pytest.mark.parametrize("links", (True, False))
def test_a_file_that_is_killed_before_it_has_its_name_leaves_no_name(tmp_path, monkeypatch, links):
    """SIGKILL between name and contents leaves no empty file (campaign, seed 786).

    Where the file system has no links the name is taken first; nothing else can keep two writers
    apart there.
    """

    def killed(*names, **more):
        raise KeyboardInterrupt

    def refused(*names, **more):
        raise OSError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "link", killed if links else refused)
    monkeypatch.setattr(Path, "replace", killed)
    with pytest.raises(KeyboardInterrupt), atomic_file(tmp_path / "signals.npz") as file:
        file.write(b"all of it")
    assert [path.name for path in tmp_path.iterdir()] == ([] if links else ["signals.npz"])


def test_a_name_that_is_taken_meanwhile_is_not_replaced(tmp_path):
    file = tmp_path / "summary.json"
    with pytest.raises(FileExistsError, match=r"summary\.json"), atomic_file(file) as ours:
        ours.write(b"ours")
        file.write_bytes(b"of the user")
    assert file.read_bytes() == b"of the user" and list(tmp_path.iterdir()) == [file]


def test_a_tilde_that_the_shell_has_left_means_the_home(tmp_path: Path, monkeypatch):
    """Shells expand `--out ~/x` but not `--out=~/x`."""
    monkeypatch.setenv("HOME", str(tmp_path))
    assert output_path("~/mine") == tmp_path / "mine"


def test_a_home_of_nobody_is_refused():
    with pytest.raises(ArgumentTypeError, match=r"'~no\.such\.user/mine' is refused: no such home"):
        output_path("~no.such.user/mine")
