"""Nothing of the user's is deleted or replaced, whatever he has in the folder and whichever command he gives."""

from __future__ import annotations

import errno
import os
import random
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import ev_stack
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands import program
from ev_stack.recording.recording import OF_ALL_RUNS, atomic_file
from ev_stack.running.folder_content import MANIFEST, read_manifest, write_manifest
from ev_stack.running.output_folder import OutputFolder
from ev_stack.scenarios.scenario import Run

# Empty ones of these names are as good as ours; below them they are his.
FOLDERS = ("bag", "log", "earlier_1", "run [0]", "signals")
FIGURES = ("slip.png", "timing.png")
NAMES = st.sampled_from(
    (
        *(
            *OF_ALL_RUNS,
            *FIGURES,
            MANIFEST,
            "thesis.pdf",
            "signals.npz",
            "parameters.yaml",
            "bag",
            "bag/metadata.yaml",
        ),
        *(
            "bag/bag.mcap",
            "bag/notes.txt",
            "bag_before_reset_1/bag.mcap",
            "log",
            "log/recorder.log",
            "log/diary.txt",
        ),
        *(
            "earlier_1",
            "earlier_1/signals.npz",
            "run [0]",
            "run [0]/signals.npz",
            "run [1]/bag/notes.txt",
            "car.fmu",
        ),
        *("bag/mine", "log/mine/empty", "run [0]/mine", "signals/mine"),
        *(
            "driven.jsonl",
            "signals/a.npz",
            "table.csv",
            "page.html",
            "speed.png",
            "recorded/signals.npz",
        ),
        ".signals.npz.0123abcd",
    )
)
THINGS = st.sampled_from(
    ["file", "file", "link to file", "link to folder", "dangling link", "folder"]
)
PUTS = st.tuples(NAMES, THINGS)
SEEDS = st.integers(0, 2**32)
EDITS = st.tuples(st.sampled_from(["edit", "delete"]), SEEDS)


class Watched:
    """A folder, and what the user has in it and behind its links: what each file holds, or where it leads."""

    def __init__(self, top: Path) -> None:
        self.out, outside = top / "out", top / "outside"
        self.out.mkdir()
        (outside / "bag").mkdir(parents=True)
        self._places = {
            "link to file": outside / "data",
            "link to folder": outside,
            "dangling link": outside / "none",
        }
        for name in ("data", "bag/metadata.yaml", "signals.npz"):
            (outside / name).write_text(f"outside {name}")
        self._his = {path: _held(path) for path in outside.rglob("*") if path.is_file()}
        self._count = 0
        self.was_killed = False

    def put(self, name: str, thing: str) -> None:
        """Put something of the user's in a place, if it is free."""
        path = self.out / name
        if os.path.lexists(path) or any(
            parent.is_symlink() or parent.is_file() for parent in path.parents
        ):
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        self._count += 1
        if thing == "folder":
            path.mkdir()
        elif thing == "file":
            path.write_text(f"his {self._count}")
        else:
            path.symlink_to(self._places[thing])
        if thing != "folder" or name not in FOLDERS:
            self._his[path] = _held(path)

    def change(self, act: str, seed: int) -> None:
        """Let the user edit a file, which is his from then on, or remove one."""
        files = sorted(
            path for path in self.out.rglob("*") if path.is_file() and not path.is_symlink()
        )
        if not files:
            return
        path = random.Random(seed).choice(files)
        if act == "delete":
            path.unlink()
            self._his.pop(path, None)
        else:
            path.write_bytes(path.read_bytes() + b" and more")
            self._his[path] = _held(path)

    def kill(self, writer: str = "") -> None:
        """Leave the manifest as a command leaves it that was killed."""
        with suppress(ValueError):
            written = read_manifest(self.out)
            for each in {writer} & written.keys() or written.keys():
                written[each] = dict.fromkeys(written[each])
                self.was_killed = True
            if written:
                write_manifest(self.out, written)

    def check(self) -> None:
        """Everything is there; what a killed command may have written may be in another folder."""
        earlier = [
            path for path in self.out.glob("earlier_*/**/*") if self.was_killed and path.is_file()
        ]
        moved = {_held(path): path for path in earlier}
        for path, held in list(self._his.items()):
            if not os.path.lexists(path) or _held(path) != held:
                assert held in moved, path
                self._his[moved[held]] = self._his.pop(path)


def _held(path: Path) -> str | bytes:
    if path.is_dir() and not path.is_symlink():
        return "folder"
    return os.readlink(path) if path.is_symlink() else path.read_bytes()


def _write(watched: Watched, seed: int) -> None:
    """Do the work of some command, which comes to its end, fails or is killed."""
    chance = random.Random(seed)
    writer, count = chance.choice(("scenario a", "study b")), chance.randint(0, 2)
    runs = [Run(f"run [{n}]", "", {}, 0.1) for n in range(count)]
    files = [*OF_ALL_RUNS, *(["driven.jsonl", "signals/a.npz"] if not runs else [])]
    keeps = chance.sample(["driven.jsonl", "signals/a.npz"], chance.randint(0, 2))
    with (
        suppress(ParameterError, FileExistsError),
        OutputFolder(watched.out, writer, files, runs, keeps) as folder,
    ):
        folders = [folder.of(run).relative_to(folder.directory) for run in runs]
        files += [
            str(each / name)
            for each in folders
            for name in ("signals.npz", "bag/bag.mcap", "log/recorder.log")
        ]
        folder.claim(FIGURES[:1])
        for name in chance.sample([*files, *FIGURES[:1]], chance.randint(0, len(files))):
            if not (name in keeps and (watched.out / name).exists()):
                (watched.out / name).parent.mkdir(exist_ok=True)
                with atomic_file(watched.out / name) as file:
                    file.write(chance.randbytes(8))
    if chance.random() < 0.3:
        watched.kill(writer)


@settings(max_examples=100, deadline=None)
@given(
    st.lists(PUTS, max_size=3),
    st.lists(st.one_of(SEEDS, SEEDS, PUTS, EDITS), min_size=1, max_size=8),
)
def test_a_folder_keeps_everything_that_no_command_has_written(had: list, acts: list):
    with TemporaryDirectory() as top:
        watched = Watched(Path(top))
        for act in [*had, *acts]:
            if isinstance(act, int):
                _write(watched, act)
            elif act[0] in ("edit", "delete"):
                watched.change(*act)
            else:
                watched.put(*act)
            watched.check()


SHORT = ("--duration", "0.02", "--no-report")
COMMANDS = (
    ("run", "coast_down", "--offline", "--duration", "0.02", "--out", "{out}"),
    ("run", "coast_down", "--offline", "--no-record", *SHORT, "--out", "{out}"),
    (
        "run",
        "sweep",
        "coast_down",
        "--seeds",
        "1",
        "--workers",
        "1",
        "--signals",
        *SHORT,
        "--out",
        "{out}",
    ),
    ("run", "report", "{driven}", "--out", "{out}/page.html"),
    ("run", "replay", "{driven}", "--node", "asr=off", *SHORT, "--out", "{out}"),
    ("parameters", "coast_down", "--out", "{out}"),
    ("fmu", "shchur2019", "--only", "driver", "--target", "x86_64-linux", "--out", "{out}/car.fmu"),
)


@pytest.fixture(scope="module")
def driven() -> ev_stack.Result:
    return ev_stack.run("shchur2019", duration=0.02)


@pytest.fixture(scope="module")
def saved(driven, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("driven")
    driven.save(folder)
    return folder


@settings(
    max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    st.lists(PUTS, max_size=2),
    st.lists(
        st.one_of(st.sampled_from([*COMMANDS, "save", "kill"]), EDITS, PUTS), min_size=3, max_size=8
    ),
)
def test_no_command_deletes_or_replaces_what_is_not_its_own(driven, saved, had: list, acts: list):
    with TemporaryDirectory() as top:
        watched = Watched(Path(top))
        for name, thing in had:
            watched.put(name, thing)
        for act in acts:
            if act == "save":
                with suppress(ParameterError):
                    driven.save(watched.out)
            elif act == "kill":
                watched.kill()
            elif act[0] in ("edit", "delete"):
                watched.change(*act)
            elif len(act) == 2:
                watched.put(*act)
            else:
                try:
                    program.perform([word.format(out=watched.out, driven=saved) for word in act])
                except SystemExit as ended:
                    assert str(ended.code).startswith("error: ") and "\n" not in str(ended.code)
            watched.check()


def test_what_is_in_the_way_is_one_line_before_anything_is_touched(tmp_path: Path):
    """Once a file of the name of ours was proof enough to delete the rest."""
    for name in ("log/diary.txt", "bag/precious.txt", "thesis.pdf", "parameters.yaml"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(name)
    refused = {
        MANIFEST: f"{MANIFEST} there is not a manifest of ours",
        "bag": "bag there is not of an earlier run",
        "log": "log there is not of an earlier run",
        "parameters.yaml": "parameters.yaml there is a link",
    }
    ours = ("run", "double_lane_change", "--offline", *SHORT, "--out", str(tmp_path))
    (tmp_path / "parameters.yaml").rename(tmp_path / "mine.yaml")
    (tmp_path / "parameters.yaml").symlink_to("mine.yaml")
    (tmp_path / MANIFEST).write_text("[]")
    for name in refused:
        before = sorted(tmp_path.rglob("*"))
        with pytest.raises(SystemExit) as ended:
            program.perform(ours)
        assert ended.value.code == f"error: {tmp_path}: {refused[name]}, expected another folder"
        assert sorted(tmp_path.rglob("*")) == before
        (tmp_path / name).rename(tmp_path / f"moved_{name}")
    program.perform(ours)
    program.perform(ours)
    assert (tmp_path / "moved_log" / "diary.txt").read_text() == "log/diary.txt"


def test_a_figure_of_the_users_is_not_replaced(tmp_path: Path):
    """Names of figures are known once they are drawn.

    Results of the run are there then, and can be replaced.
    """
    (tmp_path / "speed.png").write_text("mine")
    with pytest.raises(
        SystemExit, match=r"speed\.png there is not of an earlier run, expected another folder$"
    ):
        program.perform((*COMMANDS[0][:-1], str(tmp_path)))
    assert (tmp_path / "speed.png").read_text() == "mine"
    (tmp_path / "speed.png").rename(tmp_path / "mine.png")
    program.perform((*COMMANDS[0][:-1], str(tmp_path)))


def test_what_comes_while_a_command_drives_is_not_ours(tmp_path: Path):
    """A file of the user's is kept, even under a name that the command is going to write."""
    for _ in range(2):
        with suppress(FileExistsError), OutputFolder(tmp_path, "scenario a", ["summary.json"]):
            (tmp_path / "summary.json").write_text("mine")
            with atomic_file(tmp_path / "summary.json") as file:
                file.write(b"ours")
        assert read_manifest(tmp_path) == {}
        assert (tmp_path / "summary.json").read_text() == "mine"
        with pytest.raises(ParameterError, match=r"summary\.json there is not of an earlier run"):
            OutputFolder(tmp_path, "scenario a", ["summary.json"])
        (tmp_path / "summary.json").unlink()


def test_what_a_killed_run_was_writing_is_moved(tmp_path: Path, capsys: pytest.CaptureFixture):
    """It is not deleted: a bag holds everything up to a second before."""
    run = Run("only", "", {}, 0.1)
    with suppress(ZeroDivisionError), OutputFolder(tmp_path, "scenario a", OF_ALL_RUNS, [run]):
        begun = read_manifest(tmp_path)
        for name in ("bag/metadata.yaml", "signals.npz", ".signals.npz.0123abcd"):
            (tmp_path / name).parent.mkdir(exist_ok=True)
            (tmp_path / name).write_text(name)
    write_manifest(tmp_path, begun)
    (tmp_path / ".notes.txt.0123abcd").touch()  # called as what is written, but not by us
    with OutputFolder(tmp_path, "scenario a", OF_ALL_RUNS, [run]):
        assert sorted(path.name for path in tmp_path.iterdir()) == [
            ".notes.txt.0123abcd",
            "earlier_1",
            MANIFEST,
        ]
    assert sorted(path.name for path in (tmp_path / "earlier_1").rglob("*") if path.is_file()) == [
        ".signals.npz.0123abcd",
        "metadata.yaml",
        "signals.npz",
    ]
    assert capsys.readouterr().err.endswith(
        f"what an earlier run had not finished is in {tmp_path}/earlier_1 now\n"
    )


def test_a_recording_that_is_played_back_is_not_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """A run deleted what it was asked to play back, and a replay what it was asked to replay, by another spelling."""
    monkeypatch.chdir(tmp_path)
    run = ("run", "shchur2019", "--offline", "--no-record", *SHORT, "--out")
    program.perform((*run, "ours"))
    replay = ("run", "replay", "ours", "--node", "asr", "--no-report", "--out")
    program.perform((*replay, "again"))
    (tmp_path / "other").mkdir()
    (tmp_path / "link").symlink_to("ours")
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    for command, message in (
        (
            (*run, "ours", "--method", "driver=ours/signals.npz"),
            r"ours: signals\.npz there is what is played back",
        ),
        (
            (*run, "link", "--method", "driver=other/../ours/signals.npz"),
            r"link: signals\.npz there is what is played",
        ),
        (
            (*replay[:2], "again/recorded", *replay[3:], "other/../again"),
            "the run that is replayed is there",
        ),
    ):
        with pytest.raises(SystemExit, match=message):
            program.perform(command)
        assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before


@pytest.mark.parametrize(
    "spelling", ["out/car.yaml", "link/car.yaml", "other/../out/car.yaml", "out"]
)
def test_what_a_command_reads_is_not_removed_at_its_beginning(
    tmp_path: Path, monkeypatch, spelling: str
):
    """Its own output of before, by whatever path, or the folder with it: stopped, it could not be started again."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "other").mkdir()
    (tmp_path / "link").symlink_to("out")
    with OutputFolder(Path("out"), "identify", ["car.yaml", "kept"]) as folder:
        for name in ("car.yaml", "kept"):
            (folder.directory / name).write_text("mass: 1500.0")
    with pytest.raises(
        ParameterError,
        match=r"out: car\.yaml there is what this command reads, expected another folder",
    ):
        OutputFolder(
            Path("out"), "identify", ["car.yaml", "kept"], keeps=["kept"], reads=[None, spelling]
        )
    assert (tmp_path / "out" / "car.yaml").read_text() == "mass: 1500.0"
    with OutputFolder(
        Path("out"), "identify", ["car.yaml", "kept"], keeps=["kept"], reads=["out/kept", "other"]
    ):
        assert sorted(path.name for path in Path("out").iterdir()) == [MANIFEST, "kept"]


@pytest.mark.parametrize(("command", "option"), [("shchur2019", "--params"), ("sweep", "--params")])
def test_a_run_and_a_study_read_no_file_that_they_remove(
    tmp_path: Path, monkeypatch, command: str, option: str
):
    """Parameters of an earlier run stand where the next one writes its own."""
    monkeypatch.chdir(tmp_path)
    with OutputFolder(
        Path("out"), f"{'study' if command == 'sweep' else 'scenario'} {command}", ["mine.yaml"]
    ):
        Path("out/mine.yaml").write_text("/**/plant:\n  ros__parameters:\n    seed: 1\n")
    more = (
        (*SHORT, "--offline") if command == "shchur2019" else ("shchur2019", "--seeds", "2", *SHORT)
    )
    with pytest.raises(SystemExit, match=r"mine\.yaml there is what this command reads"):
        program.perform(("run", command, *more, option, "out/mine.yaml", "--out", "out"))
    assert Path("out/mine.yaml").exists()


@pytest.mark.parametrize("option", [None, "--vehicle"], ids=["scenario", "car"])
def test_a_folder_may_have_the_name_of_the_scenario_or_car_that_is_driven(
    tmp_path: Path, monkeypatch, option
):
    """These stand in a config folder: the second run replaces the first one."""
    monkeypatch.chdir(tmp_path)
    name = "compact_ev" if option else "shchur2019"
    words = (
        "run",
        "shchur2019",
        *SHORT,
        "--offline",
        *([option, name] if option else []),
        "--out",
        name,
    )
    for _ in range(2):
        program.perform(words)
    assert Path(name, "summary.json").exists()


def test_a_folder_below_one_that_is_read_is_none_that_is_read(tmp_path: Path):
    """A run is validated into a folder of its own, once more as well."""
    for _ in range(2):
        with OutputFolder(
            tmp_path / "run" / "validate", "validate", ["summary.json"], reads=[tmp_path / "run"]
        ) as to:
            (to.directory / "summary.json").write_text("{}")


def test_names_and_manifests_that_nobody_can_read_are_refused(tmp_path: Path):
    """A folder needs a name in UTF-8, and a manifest has a largest size; both before the run."""
    with pytest.raises(
        ParameterError, match=r"is refused, expected the name of a folder in UTF-8$"
    ):
        OutputFolder(tmp_path / os.fsdecode(b"\xff"), "scenario a")
    with (tmp_path / MANIFEST).open("wb") as file:
        file.truncate(2**30)
    with pytest.raises(ParameterError, match=r"expected a regular file of at most 64 MB$"):
        OutputFolder(tmp_path, "scenario a")
    assert [path.name for path in tmp_path.iterdir()] == [MANIFEST]


@pytest.mark.parametrize("links", (True, False))
def test_a_file_that_is_killed_before_it_has_its_name_leaves_no_name(tmp_path, monkeypatch, links):
    """SIGKILL between taking the name and moving the file left an empty signals.npz, seed 786 of the campaign.

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


@pytest.mark.parametrize("holds", [(), ("mine",)])
def test_a_folder_in_the_place_of_a_file_is_refused_and_nothing_is_left_beside_it(holds, tmp_path):
    (tmp_path / "car.fmu").mkdir()
    for name in holds:
        (tmp_path / "car.fmu" / name).touch()
    with pytest.raises(
        ParameterError, match=r"car\.fmu there is a folder, expected another folder"
    ):
        OutputFolder(tmp_path, "fmu car.fmu", ["car.fmu"])
    assert [path.name for path in tmp_path.iterdir()] == ["car.fmu"]
