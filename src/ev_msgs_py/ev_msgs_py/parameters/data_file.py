"""Files of data: where those that another file names may lie, and opened so that none blocks or fills the memory."""

from __future__ import annotations

import errno
import hashlib
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedReader
from pathlib import Path
from typing import IO

from ev_msgs_py.parameters.config_folders import config_folders
from ev_msgs_py.parameters.declaration import ParameterError
from ev_msgs_py.parameters.shown import quoted

MEGABYTE = 2**20
TEXT, TABLE, SIGNALS = 4 * MEGABYTE, 64 * MEGABYTE, 4096 * MEGABYTE  # the largest size of a file, by its kind
_listening: list[dict[str, str]] = []  # what `files_read` has given to those who still ask
_KINDS = ((stat.S_ISDIR, "a folder"), (stat.S_ISFIFO, "a pipe"), (stat.S_ISSOCK, "a socket"), (stat.S_ISREG, ""))


class TextOfFile(str):
    """A text that `file` says: as a path it leads less far than one that the user says."""

    file: Path

    @classmethod
    def of(cls, text: str, file: Path) -> TextOfFile:
        """The same text, marked."""
        made = cls(text)
        made.file = file
        return made


def refuse_outside(name: str, path: Path) -> None:
    """ParameterError if a file has named a path that leads out of its folder, config folders and working directory."""
    if isinstance(name, TextOfFile):
        roots = [root.resolve() for root in (name.file.parent, *config_folders(), Path())]
        if not any(path.resolve().is_relative_to(root) for root in roots):
            raise ParameterError(
                f"{quoted(str(name))} is refused, allowed in {name.file} is a file below {name.file.parent}, "
                "a config folder or the working directory; further away it is named on the command line"
            )


@contextmanager
def files_read() -> Iterator[dict[str, str]]:
    """By path the SHA-256 of every file of data that is opened, or told to be needed, in the meantime."""
    read: dict[str, str] = {}
    _listening.append(read)
    try:
        yield read
    finally:
        _listening.pop()


def tell(path: Path | str) -> None:
    """Say that a file is needed, which is not opened anew each time: it is a library, or was read before."""
    if _listening:
        with Path(path).open("rb") as file:
            _tell(path, file)


def _tell(path: Path | str, file: BufferedReader) -> None:
    digest = hashlib.file_digest(file, "sha256").hexdigest()
    for each in _listening:
        each[os.fspath(path)] = digest


def open_data(path: Path | str, most: int) -> IO[bytes]:
    """A regular file of at most so many bytes; OSError, whose strerror says what is allowed, for anything else."""
    opened = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY)
    try:
        found = os.fstat(opened)
        what = next((word for holds, word in _KINDS if holds(found.st_mode)), "a device")
        if found.st_size > most:
            what = what or f"of {found.st_size / MEGABYTE:.0f} MB"
        if what:
            allowed = f"it is {what}, allowed is a regular file of at most {most // MEGABYTE} MB"
            raise OSError(errno.EINVAL, allowed, str(path))
    except BaseException:
        os.close(opened)
        raise
    file = os.fdopen(opened, "rb")
    if _listening:
        _tell(path, file)
        file.seek(0)
    return file


def read_data(path: Path | str, most: int) -> bytes:
    """The bytes of a file of data; OSError as `open_data`, also if it has more of them than it says, as in /proc."""
    with open_data(path, most) as file:
        content = file.read(most + 1)
    if len(content) > most:
        allowed = f"it has more than it says, allowed is a regular file of at most {most // MEGABYTE} MB"
        raise OSError(errno.EFBIG, allowed, str(path))
    return content
