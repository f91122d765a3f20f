"""Files of data: their folders, and tables in CSV and signals that are read from them.

How it works: a name that is no absolute path is looked for in the config folders, those of the user
before those of packages. A path that stands in a file of others' leads no further than data does. A
file is opened only if it is a regular one of some size at most, so that none blocks or fills the
memory. What is opened can be listened to (`files_read`): results are kept by their inputs.
"""

from __future__ import annotations

import csv
import errno
import hashlib
import os
import stat
import zipfile
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from importlib import metadata
from importlib.util import find_spec
from io import BufferedReader
from pathlib import Path
from typing import IO, Any, TypeVar

import numpy as np
from numpy.lib import format

from ev_core.parameters.csv_text import columns_of
from ev_msgs_py.refusal import ParameterError, quoted

VARIABLE = "EV_STACK_CONFIG"
_GROUP = "ev_stack.config"  # of entry points: packages that have a folder `config`


_all_entry_points: Callable[[], Any] = cache(metadata.entry_points)
MEGABYTE = 2**20
# The largest size of a file, by its kind.
TEXT = 4 * MEGABYTE
TABLE = 64 * MEGABYTE
SIGNALS = 4096 * MEGABYTE
_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISREG, ""),
)
T = TypeVar("T")
TIME = "time"  # [s], what the array of the instants is called


def entry_points(**wanted: str) -> Iterable[metadata.EntryPoint]:
    """Entry points of a `group`, and of a `name` if it is given.

    Packages are searched once, which takes 10 ms.
    """
    points: Iterable[metadata.EntryPoint] = _all_entry_points().select(**wanted)
    return points


def config_folders() -> tuple[Path, ...]:
    """The folders that EV_STACK_CONFIG names, and behind them those of installed packages.

    What stands in several of them is taken from the first. FileNotFoundError, with a message for
    the user, if one that is named is not there.
    """
    named = [Path(text) for text in os.environ.get(VARIABLE, "").split(os.pathsep) if text]
    for folder in named:
        if not folder.is_dir():
            raise FileNotFoundError(
                f"the config folder {folder}, named by {VARIABLE}, is not there"
            )
    return (*named, *_installed())


@cache
def _installed() -> tuple[Path, ...]:
    specs = map(find_spec, sorted({point.value for point in entry_points(group=_GROUP)}))
    found: list[Path] = []
    for spec in specs:
        if spec is not None:
            found += [Path(folder) / "config" for folder in spec.submodule_search_locations or ()]
    return tuple(found)


def find_in_config(name: str) -> Path | None:
    """The file or folder of a name such as cycles/nedc.csv in the config folders.

    The first folder that has it counts; None if none has it.
    """
    for folder in config_folders():
        path = folder / name
        if path.exists():
            return path
    return None


def files_in_config(kind: str) -> Mapping[str, Path]:
    """YAML files of a kind (`scenarios`, `vehicles`, `surfaces`), by name without suffix."""
    found: dict[str, Path] = {}
    for folder in config_folders():
        for path in sorted((folder / kind).glob("*.yaml")):
            found.setdefault(path.stem, path)
    return found


# The dictionaries of `files_read`, for each block around the present place.
_listening: ContextVar[tuple[dict[str, str], ...]] = ContextVar("listening", default=())


class TextOfFile(str):
    """A text from `file`: as a path it leads less far than one from the user."""

    file: Path

    @classmethod
    def of(cls, text: str, file: Path) -> TextOfFile:
        """The same text, marked."""
        made = cls(text)
        made.file = file
        return made


def refuse_outside(name: str, path: Path) -> None:
    """Refuse a path in a file that leads out of all folders of data.

    These are its own folder, the config folders and the working directory.
    """
    if "\0" in name:
        raise ParameterError(f"{quoted(str(name))} is refused, expected the path of a file")
    if isinstance(name, TextOfFile):
        # Links are followed first, for they may lead out as well.
        roots = [root.resolve() for root in (name.file.parent, *config_folders(), Path())]
        if not any(path.resolve().is_relative_to(root) for root in roots):
            raise ParameterError(
                f"{quoted(str(name))} is refused, expected in {name.file} is a file below "
                f"{name.file.parent}, a config folder or the working directory; "
                "further away it is named on the command line"
            )


@contextmanager
def files_read() -> Iterator[dict[str, str]]:
    """SHA-256, by path, of each file of data that this thread opens or reports in the block."""
    read: dict[str, str] = {}
    before = _listening.set((*_listening.get(), read))
    try:
        yield read
    finally:
        _listening.reset(before)


def tell(path: Path | str) -> None:
    """Report that a file is needed, which is not opened each time.

    It is a library, or was read before.
    """
    if _listening.get():
        with Path(path).open("rb") as file:
            _tell(path, file)


def _tell(path: Path | str, file: BufferedReader) -> None:
    digest = hashlib.file_digest(file, "sha256").hexdigest()
    for each in _listening.get():
        each[os.fspath(path)] = digest


def open_data(path: Path | str, most: int, is_input: bool = True) -> IO[bytes]:
    """Open a regular file of at most so many bytes.

    OSError, with the expected kind in its strerror, for another one. `files_read` leaves it out
    unless it `is_input`: a file of a cache would be made again without it.
    """
    if "\0" in os.fspath(path):
        raise OSError(errno.EINVAL, "it has a null byte, expected the path of a file", str(path))
    # Without waiting: opening a pipe would block until something writes into it.
    opened = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY)
    try:
        found = os.fstat(opened)
        what = next((word for holds, word in _KINDS if holds(found.st_mode)), "a device")
        if found.st_size > most:
            what = what or f"of {found.st_size / MEGABYTE:.0f} MB"
        if what:
            allowed = f"it is {what}, expected a regular file of at most {most // MEGABYTE} MB"
            raise OSError(errno.EINVAL, allowed, str(path))
    except BaseException:
        os.close(opened)
        raise
    file = os.fdopen(opened, "rb")
    if _listening.get() and is_input:
        _tell(path, file)
        file.seek(0)
    return file


def read_data(path: Path | str, most: int, is_input: bool = True) -> bytes:
    """The bytes of a file of data.

    OSError as `open_data`, also if it has more of them than its size, as in /proc.
    """
    with open_data(path, most, is_input) as file:
        # One byte more shows that there is more, without reading all of it.
        content = file.read(most + 1)
    if len(content) > most:
        allowed = (
            f"it has more than it says, expected a regular file of at most {most // MEGABYTE} MB"
        )
        raise OSError(errno.EFBIG, allowed, str(path))
    return content


def find_file(name: str) -> Path:
    """The file that a parameter names.

    A relative name counts from the config folders, else from the working directory.
    FileNotFoundError if the name is relative and a config folder that is named is not there;
    ParameterError if another file has named it and it leads further than that file may
    (`data_file`).
    """
    path = Path(name)
    if not path.is_absolute():
        path = find_in_config(name) or path
    refuse_outside(name, path)
    return path


def read_csv(
    parameter: str,
    name: str,
    columns: tuple[Mapping[str, float], ...],
    make: Callable[..., T],
    unread: Collection[str] = (),
) -> T:
    """Call `make` with some columns of the CSV file `name`, each a tuple of numbers in SI units.

    `columns`: for each column the names that it may have, with the factor from its unit to SI. The
    file has a header, with or without # before it; further columns, empty lines and other lines
    that begin with # are passed over, and columns that are `unread` only if they are zero. Raises
    ParameterError, in one line that names `parameter` and file, if the file cannot be read, lacks a
    column or has it twice, or holds something else than finite numbers, and if `make` raises one.
    """
    path: Path | str = name
    try:
        path = find_file(name)
        return make(*columns_of(read_data(path, TABLE).decode("utf-8-sig"), columns, unread))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = (error.strerror or error) if isinstance(error, OSError) else "no CSV text"
        raise ParameterError(f"{parameter}: {path}: {reason}") from None
    except ParameterError as error:
        raise ParameterError(f"{parameter}: {path}: {error}") from None


class RecordingError(ValueError):
    """A file holds no recording; the message names it, in one line."""


def read_arrays(path: Path | str) -> dict[str, np.ndarray]:
    """The arrays of signals.npz by name.

    FileNotFoundError, or RecordingError if they are damaged or too large. Nothing is allocated by
    the sizes in the file before these agree: a few bytes can claim any size.
    """
    try:
        with open_data(path, SIGNALS) as file, zipfile.ZipFile(file) as archive:
            members = archive.infolist()
            if sum(each.file_size for each in members) > SIGNALS:
                raise ValueError(f"its arrays are larger than {SIGNALS // MEGABYTE} MB")
            return {each.filename.removesuffix(".npy"): _array(archive, each) for each in members}
    except FileNotFoundError:
        raise
    except OSError as error:
        raise RecordingError(f"{path} holds no signals: {error.strerror or error}") from None
    except Exception as error:
        # Numpy, zip and zlib raise all kinds of errors for bytes that are none of theirs.
        reason = " ".join(str(error).split())[:200]
        raise RecordingError(f"{path} holds no signals: {reason}") from None


def _array(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> np.ndarray:
    """One array, (n,) of numbers; ValueError if it is something else."""
    with archive.open(member) as file:
        format.read_magic(file)
        shape, _, kind = format.read_array_header_1_0(file)
        is_series = kind.kind in "fiu" and len(shape) == 1
        # The header has to agree with the size of the file before memory is taken for it.
        if not is_series or shape[0] * kind.itemsize != member.file_size - file.tell():
            raise ValueError(f"{quoted(member.filename)} is no series of numbers")
        return np.frombuffer(bytearray(file.read()), kind)
