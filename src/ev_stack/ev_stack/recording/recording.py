"""Files of a run: whole ones, its signals as arrays, and the hash that proves two runs equal."""

from __future__ import annotations

import errno
import hashlib
import os
import secrets
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path
from typing import IO
from zipfile import ZipFile

import numpy as np

from ev_core.parameters.data_file import TIME, RecordingError, read_arrays
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.topics import Topic
from ev_msgs_py.refusal import ParameterError

# of a file system without hard links, such as FAT
_NO_LINKS = (errno.EPERM, errno.ENOTSUP, errno.ENOSYS)
BAG = "bag"
SIGNALS = "signals.npz"
PARAMETERS = "parameters.yaml"
LOG = "log"
SUMMARY = "summary.json"
PAGE = "report.html"
_LITTLE_ENDIAN = np.dtype("<f8")
# instants that are turned over at once: they fit into the cache, as frames and as series
_BLOCK = 256
_MAGIC = b"\x89MCAP0\r\n"  # a whole MCAP file begins and ends with it


@contextmanager
def atomic_file(path: Path | str, replaces: bool = False) -> Iterator[IO[bytes]]:
    """A binary file that takes its name only when everything is written.

    A failure leaves what was there before.

    FileExistsError if something has this name by then, unless it `replaces` that; OSError names the
    file.
    """
    path = Path(path)
    # In the same folder, for only within a file system is renaming one step.
    unfinished = path.with_name(f".{path.name}.{secrets.token_hex(4)}")
    with naming(path), unfinished.open("xb") as file:
        try:
            yield file
            # Before it gets its name: a full disk may show only when the file is closed.
            file.close()
            if replaces or not _linked(unfinished, path):
                unfinished.replace(path)
        finally:
            unfinished.unlink(missing_ok=True)


@contextmanager
def naming(path: Path) -> Iterator[None]:
    """Let an OSError of the block name the file that is written: a full disk gives no name."""
    try:
        yield
    except OSError as error:
        if error.errno is None or error.filename is not None:
            raise
        raise OSError(error.errno, error.strerror, str(path)) from None


def _linked(unfinished: Path, path: Path) -> bool:
    """Give a file its name if nothing has it, else FileExistsError.

    A process that is killed leaves no empty one.

    False where the file system has no links: the name is then taken by an empty file, to be
    replaced.
    """
    try:
        os.link(unfinished, path)
    except OSError as error:
        if error.errno not in _NO_LINKS:
            raise OSError(error.errno, error.strerror, str(path)) from None
        # unlike a test for existence this leaves no gap for another process
        path.touch(exist_ok=False)
        return False
    return True


def free_path(path: Path) -> Path:
    """The first one of PATH1, PATH2, ... that is free."""
    return next(
        each
        for each in (Path(f"{path}{number}") for number in count(1))
        if not os.path.lexists(each)
    )


@dataclass(frozen=True, eq=False, repr=False)
class Recording:
    """Everything that was sent in one run, sampled at the instants of the steps.

    `time`: (n,) float64 [s]. `channels`: TOPIC.FIELD.NAME -> (n,) float64 in the unit of the field,
    where the slashes of a topic are dots (`steering_column.state.angle`).

    In a true motion (`recording.offline.true_motion`), `shown` is what was sent, and `unknown` are
    channels without a known truth.
    """

    time: np.ndarray
    channels: Mapping[str, np.ndarray]
    shown: Recording | None = None
    unknown: frozenset[str] = frozenset()

    def __post_init__(self) -> None:
        if TIME in self.channels:
            raise ValueError(f"no channel may be called {TIME!r}")
        for name, values in {TIME: self.time, **self.channels}.items():
            if values.dtype != np.float64 or values.shape != (len(self.time),):
                raise ValueError(
                    f"{name} must be float64 of shape ({len(self.time)},), not {values.dtype} of"
                    f" shape {values.shape}"
                )

    def __repr__(self) -> str:
        return (
            f"Recording of {len(self.channels)} channels at {len(self.time)} instants in"
            f" {self.duration:g} s"
        )

    @property
    def duration(self) -> float:
        """Time from the first to the last sample [s]."""
        return float(self.time[-1] - self.time[0]) if len(self.time) else 0.0

    def part(self, begin: int) -> Recording:
        """The samples from one on, as views."""
        shown = self.shown.part(begin) if self.shown else None
        channels = {name: values[begin:] for name, values in self.channels.items()}
        return Recording(self.time[begin:], channels, shown, self.unknown)


def recording_of(frames: np.ndarray, topics: Iterable[Topic]) -> Recording:
    """The channels of some topics in a stack of frames (instants, frame size), each in one piece of memory.

    Reading one channel would otherwise fetch all the others with it.
    """
    series = np.empty(frames.shape[::-1])
    for begin in range(0, len(frames), _BLOCK):
        series[:, begin : begin + _BLOCK] = frames[begin : begin + _BLOCK].T
    return recording_of_series(series, topics)


def recording_of_series(series: np.ndarray, topics: Iterable[Topic]) -> Recording:
    """The channels of some topics in the series of all numbers of the frame (frame size, instants)."""
    channels = {
        name: series[place]
        for topic in topics
        for name, place in zip(topic.channels, frame.places(topic.signal), strict=True)
    }
    return Recording(series[frame.TIME], channels)


def save(recording: Recording, path: Path | str, replaces: bool = False) -> None:
    """Write signals.npz: one array per channel under its name, plus `time`."""
    write_signals(path, chain([(TIME, recording.time)], recording.channels.items()), replaces)


def write_signals(
    path: Path | str, series: Iterable[tuple[str, np.ndarray]], replaces: bool = False
) -> None:
    """The same from names and arrays that come one by one: the bytes of `numpy.savez`, which would need all at once.

    `replaces` is that of `atomic_file`. Not compressed: deflating takes five times as long and
    saves half of a few megabytes.
    """
    with atomic_file(path, replaces) as file, ZipFile(file, "w") as archive:
        for name, values in series:
            with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
                np.lib.format.write_array(entry, values, allow_pickle=False)


def load(path: Path | str) -> Recording:
    """Read signals.npz, bit for bit what was saved.

    Raises OSError if it is not there, RecordingError if it is damaged.
    """
    channels = read_arrays(path)
    try:
        return Recording(channels.pop(TIME), channels)
    except (KeyError, ValueError) as error:
        raise RecordingError(f"{path} holds no signals: {error}") from None


def refuse_unfinished(bag: Path) -> None:
    """ParameterError for a bag that was not closed, given as its folder or as its storage file."""
    if bag.is_dir():
        files = sorted(bag.glob("*.mcap"))
        is_unfinished = bool(files) and not (bag / "metadata.yaml").exists()
    else:
        files = [bag]
        is_unfinished = bag.is_file() and _has_no_end(bag)
    if is_unfinished:
        raise ParameterError(
            f"{bag}: the bag has no index, as its recorder was killed or found no room: "
            f"`mcap recover {files[0].name} -o WHOLE.mcap` makes a file that can be read"
        )


def _has_no_end(path: Path) -> bool:
    """Return whether a file is the beginning of an MCAP file, without its end."""
    try:
        with path.open("rb") as file:
            begin = file.read(len(_MAGIC))
            size = file.seek(0, os.SEEK_END)
            file.seek(max(size - len(_MAGIC), len(begin)))
            end = file.read()
    except OSError:  # whoever reads it gets the reason
        return False
    return begin == _MAGIC and end != _MAGIC


def signal_hash(recording: Recording) -> str:
    """SHA-256 over `time` and all channels by sorted name, as hexadecimal digits.

    Each array counts with its name, its length and its little-endian float64 bytes, so one flipped
    bit (also the sign of a zero) changes the hash and the order of the channels does not.
    """
    digest = hashlib.sha256()
    _add(digest, TIME, recording.time)
    for name in sorted(recording.channels):
        _add(digest, name, recording.channels[name])
    return digest.hexdigest()


def _add(digest: hashlib._Hash, name: str, values: np.ndarray) -> None:
    digest.update(f"{name}\0{len(values)}\0".encode())
    # The same bytes on every processor.
    digest.update(np.ascontiguousarray(values, dtype=_LITTLE_ENDIAN))


def combined_hash(signal_hashes: Mapping[str, str]) -> str:
    """The hash of a scenario: that of its only run, whatever it is called, else SHA-256 over names and hashes of runs.

    The only run of a scenario has the name of its file, which is none of its signals.
    """
    if len(signal_hashes) == 1:
        return next(iter(signal_hashes.values()))
    lines = (f"{name}\0{signal_hashes[name]}\n" for name in sorted(signal_hashes))
    return hashlib.sha256("".join(lines).encode()).hexdigest()
