"""Files are data.

Whatever stands in the place of one is named in one line, and nothing blocks or fills the memory.
"""

from __future__ import annotations

import io
import os
import re
import resource
import zipfile
from collections.abc import Callable
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from ev_bench.bus.parameters import load_database
from ev_core.lockstep.configuration import configure
from ev_core.parameters.data_file import SIGNALS, TABLE, TEXT, RecordingError
from ev_core.vehicle.files import read_tyre
from ev_msgs_py.refusal import ParameterError
from ev_sim.profiles.profile import cycle_values
from ev_stack.commands.report import read_folder
from ev_stack.recording.recording import load
from ev_stack.scenarios.files import vehicle_file
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.scenario import Overrides, load_scenario
from ev_study.replay.recorded import find_recorded

REFUSED = (ParameterError, RecordingError)
# Name, largest size and reader of each kind of file.
READERS: dict[str, tuple[str, int, Callable[[Path], object]]] = {
    "scenario": ("own.yaml", TEXT, lambda path: load_scenario(str(path))),
    "vehicle": ("car.yaml", TEXT, lambda path: vehicle_file(str(path))),
    "parameters": (
        "more.yaml",
        TEXT,
        lambda path: load_scenario("shchur2019", Overrides(files=[path])),
    ),
    "tyre": ("tyre.tir", TEXT, lambda path: read_tyre("vehicle.tyre.front_file", str(path))),
    "cycle": ("cycle.csv", TABLE, lambda path: cycle_values(str(path))),
    "map": ("map.csv", TABLE, lambda path: configure("asr", {"vehicle.motor.map_file": str(path)})),
    "database": ("bus.dbc", TEXT, lambda path: load_database(str(path))),
    "signals": ("signals.npz", SIGNALS, load),
    "playback": ("signals.npz", SIGNALS, lambda path: configure("driver", {"method": str(path)})),
    "summary": ("summary.json", TABLE, lambda path: read_folder("", path.parent)),
    "bag": ("bag.mcap", SIGNALS, find_recorded),
    "metadata": ("metadata.yaml", TEXT, lambda path: find_recorded(path.parent)),
}
WRONG: dict[str, tuple[Callable[[Path, int], object], str]] = {
    "device": (lambda path, most: path.symlink_to("/dev/zero"), "it is a device"),
    "pipe": (lambda path, most: os.mkfifo(path), "it is a pipe"),
    "folder": (lambda path, most: path.mkdir(), "it is a folder"),
    "large": (
        lambda path, most: (path.touch(), os.truncate(path, most + 2**20)),
        r"it is of \d+ MB",
    ),
}


@contextmanager
def little_memory(more: int = 512 * 2**20):
    """Leave so much memory that a larger read within the block is a MemoryError."""
    before = resource.getrlimit(resource.RLIMIT_AS)
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + more, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, before)


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize("kind", READERS)
def test_only_a_regular_file_of_bounded_size_is_read(tmp_path, kind, wrong):
    """/dev/zero has no end, and a pipe without a writer gives none: both are refused."""
    (name, most, read), (make, what) = READERS[kind], WRONG[wrong]
    make(tmp_path / name, most)
    with little_memory(), pytest.raises(REFUSED) as refused:
        read(tmp_path / name)
    message = str(refused.value)
    expected = f"{what}, expected a regular file of at most {most // 2**20} MB|no such bag|is no recorded run"
    assert re.search(expected, message), message
    assert str(tmp_path) in message
    assert "\n" not in message


SECRET = "root:$6$salt$hash:19000:0:99999:7:::\n"


@pytest.mark.parametrize("kind", READERS)
def test_what_stands_in_a_wrong_file_is_not_shown(tmp_path, kind, monkeypatch):
    """A password file as an efficiency map was shown with its first line.

    By a short path: behind a long one, the end of the line that has it may be cut off.
    """
    name, _, read = READERS[kind]
    monkeypatch.chdir(tmp_path)
    Path(name).write_text(SECRET * 3)
    with pytest.raises(REFUSED) as refused:
        read(Path(name))
    assert "salt" not in str(refused.value)


def test_aliases_do_not_unfold(tmp_path):
    """Nine lines that mean a billion values; ROS knows no aliases either."""
    lines = ["a0: &a0 {x: 1.0}"]
    for n in range(1, 10):
        lines.append(f"a{n}: &a{n} {{{', '.join(f'k{i}: *a{n - 1}' for i in range(10))}}}")
    (tmp_path / "bomb.yaml").write_text(
        "/**/asr:\n  ros__parameters:\n" + "".join(f"    {line}\n" for line in lines)
    )
    with (
        little_memory(),
        pytest.raises(ParameterError, match=r"bomb.yaml: not readable as YAML in line 4: an alias"),
    ):
        ParameterFile(tmp_path / "bomb.yaml")


def npy(shape: tuple[int, ...], kind: str = "<f8", data: bytes = b"") -> bytes:
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        header, {"descr": kind, "fortran_order": False, "shape": shape}
    )
    return header.getvalue() + data


@pytest.mark.parametrize(
    "content",
    {
        "a header that claims all": npy((2**50,)),
        "a square": npy((2, 2), data=bytes(32)),
        "objects": npy((1,), "|O", b"\x80\x04N."),
        "texts": npy((1,), "<U4", bytes(16)),
        "nothing": b"",
    }.items(),
    ids=lambda item: item[0],
)
def test_arrays_are_what_they_say(tmp_path, content):
    with zipfile.ZipFile(tmp_path / "signals.npz", "w") as archive:
        archive.writestr("time.npy", content[1])
    with (
        little_memory(),
        pytest.raises(RecordingError, match=r"^\S+signals.npz holds no signals: "),
    ):
        load(tmp_path / "signals.npz")


def test_a_few_compressed_bytes_do_not_unfold(tmp_path):
    """Members that say they are larger than allowed, and one that is larger than it says."""
    with zipfile.ZipFile(tmp_path / "signals.npz", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("time.npy", npy((2**17,), data=bytes(2**20)))
    whole = (tmp_path / "signals.npz").read_bytes()
    real = (len(npy((2**17,))) + 2**20).to_bytes(4, "little")
    assert whole.count(real) == 2
    (tmp_path / "more.npz").write_bytes(whole.replace(real, (2**32 - 2).to_bytes(4, "little")))
    (tmp_path / "less.npz").write_bytes(whole.replace(real, (1000).to_bytes(4, "little")))
    for name in ("more", "less"):
        with little_memory(), pytest.raises(RecordingError, match=r"holds no signals"):
            load(tmp_path / f"{name}.npz")
    assert len(load(tmp_path / "signals.npz").time) == 2**17


def scenario_with(folder: Path, node: str, name: str, value: str) -> Path:
    folder.mkdir(exist_ok=True)
    path = folder / "own.yaml"
    path.write_text(f"/**/{node}:\n  ros__parameters:\n    {name}: {value}\n")
    return path


@pytest.fixture
def elsewhere(tmp_path, monkeypatch) -> Path:
    """A folder with files of all kinds.

    The working directory is another one, and so is that of the scenario.
    """
    (tmp_path / "here").mkdir()
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    for name in ("cycle.csv", "map.csv", "tyre.tir", "bus.dbc", "signals.npz", "car.yaml"):
        (tmp_path / "elsewhere" / name).write_text(SECRET)
    return tmp_path / "elsewhere"


PATHS = (
    ("driver", "speed_profile.file", "cycle.csv"),
    ("plant", "vehicle.motor.map_file", "map.csv"),
    ("plant", "vehicle.tyre.front_file", "tyre.tir"),
    ("plant", "vehicle.tyre.rear_file", "tyre.tir"),
    ("driver", "method", "signals.npz"),
    ("scenario", "vehicle", "car.yaml"),
)


@pytest.mark.parametrize(("node", "name", "file"), PATHS)
@pytest.mark.parametrize("way", ["absolute", "upwards", "link"])
def test_a_path_in_a_file_does_not_lead_out(tmp_path, elsewhere, node, name, file, way):
    """Nothing is read there: what stands in it would be refused in other words."""
    value = str(elsewhere / file) if way == "absolute" else f"../elsewhere/{file}"
    if way == "link":
        value = f"./link{Path(file).suffix}"
        Path(value).symlink_to(elsewhere / file)
    own = scenario_with(tmp_path / "scenarios", node, name, value)
    message = rf"{re.escape(repr(value))} is refused, expected in \S+own.yaml is a file "
    with pytest.raises(ParameterError, match=message):
        load_scenario(str(own))


@pytest.mark.parametrize(
    ("node", "name", "file"), [path for path in PATHS if path[0] != "scenario"]
)
def test_the_same_path_on_the_command_line_and_below_the_file_is_read(
    tmp_path, elsewhere, node, name, file
):
    """It is wrong in itself there, and says so."""
    given = Overrides(values=[(node, name, str(elsewhere / file))])
    own = scenario_with(elsewhere, node, name, str(elsewhere / file))
    for load_it in (lambda: load_scenario("shchur2019", given), lambda: load_scenario(str(own))):
        with pytest.raises(ParameterError, match=re.escape(str(elsewhere / file))) as refused:
            load_it()
        assert "is refused, allowed in" not in str(refused.value)


@pytest.mark.skipif(
    not Path("/proc/self/pagemap").exists(), reason="no file here has more than it says"
)
def test_a_file_that_has_no_end_is_one_line():
    """Files in /proc are regular, of size 0, and have contents."""
    with (
        little_memory(),
        pytest.raises(
            ParameterError, match=r"pagemap: it has more than it says, expected a regular"
        ),
    ):
        cycle_values("/proc/self/pagemap")
