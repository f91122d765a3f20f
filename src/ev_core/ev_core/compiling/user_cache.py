"""The cache folder of this user, and files in it that carry a checksum.

Machine code in it is executed. So no other user may write there, and a file that a full disk, a
crash or a hand has changed is made again, never loaded.
"""

from __future__ import annotations

import atexit
import fcntl
import hashlib
import os
import secrets
import shutil
import stat
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

from ev_core.parameters.data_file import SIGNALS, read_data
from ev_msgs_py.refusal import ParameterError

VARIABLE = "EV_STACK_CACHE"
_OTHERS = stat.S_IWGRP | stat.S_IWOTH


@cache
def cache_folder() -> Path:
    """The folder of EV_STACK_CACHE, else `ev_stack` in the user's cache folder.

    That is XDG_CACHE_HOME, or ~/.cache. Where it cannot be written, it is a folder that goes with
    this process, with one line about it. ParameterError if others could put something there.
    """
    named = os.environ.get(VARIABLE)
    folder = Path(named).absolute() if named else _of_user()
    try:
        folder.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK | os.X_OK):
            raise PermissionError(0, "it cannot be written")
    except OSError as error:
        if named:
            raise ParameterError(f"{VARIABLE}: {folder}: {error.strerror}") from None
        return _for_now(folder)
    if danger := _danger(folder):
        raise ParameterError(
            f"what is compiled is not kept in {folder}: {danger}; "
            f"expected a folder of your own (user {os.getuid()}) into which no other user may "
            f"write; {VARIABLE} names another one"
        )
    return folder


def _of_user() -> Path:
    named = os.environ.get("XDG_CACHE_HOME", "")
    # A relative one does not count, by its specification.
    if os.path.isabs(named):
        return Path(named) / "ev_stack"
    return Path(os.path.expanduser("~")) / ".cache" / "ev_stack"


def _for_now(wanted: Path) -> Path:
    folder = Path(tempfile.mkdtemp(prefix="ev_stack-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    os.environ[VARIABLE] = str(folder)  # for the processes that are started from here
    print(
        f"{wanted} cannot be written: what is compiled is kept in {folder} until this ends",
        file=sys.stderr,
    )
    return folder


def _danger(folder: Path) -> str:
    """Why other users could write into a folder, or replace it by another one or a link.

    Empty if they cannot.
    """
    user = os.getuid()
    real = folder.resolve()
    # All folders on the way, by name and behind links: in any of them the next could be replaced.
    for path in dict.fromkeys((*reversed(folder.parents), folder, *reversed(real.parents), real)):
        found = path.lstat()
        is_link_of_others = path.is_symlink() and found.st_uid not in (user, 0)
        if is_link_of_others or (path == real and found.st_uid != user):
            return f"{path} belongs to user {found.st_uid}"
        if path.is_symlink():
            continue
        # With the sticky bit, as /tmp has it, others cannot touch what is not theirs.
        is_everybodys = found.st_mode & (stat.S_IWOTH | stat.S_ISVTX) == stat.S_IWOTH
        if is_everybodys or (path == real and found.st_mode & _OTHERS):
            return f"others may write into {path} (mode {stat.S_IMODE(found.st_mode):04o})"
    return ""


def write_checked(file: Path, content: bytes) -> None:
    """Write a file that other processes, also after a crash, see whole or not at all.

    An OSError names it.
    """
    unfinished = file.with_name(f".{file.name}.{secrets.token_hex(4)}")
    try:
        with unfinished.open("xb") as to:
            to.write(_checksum(content) + content)
            to.flush()
            os.fsync(to.fileno())
        unfinished.replace(file)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(file)) from None
    finally:
        unfinished.unlink(missing_ok=True)


def read_checked(file: Path) -> bytes | None:
    """Content that `write_checked` wrote.

    None without the file, or if its checksum is wrong: then it is removed.
    """
    try:
        written = read_data(file, SIGNALS, is_input=False)
    except FileNotFoundError:
        return None
    content = written[len(_checksum(b"")) :]
    if written == _checksum(content) + content:
        return content
    file.unlink(missing_ok=True)
    print(
        f"{file} does not fit its checksum: it is removed and made again",
        file=sys.stderr,
        flush=True,
    )
    return None


def _checksum(content: bytes) -> bytes:
    return f"{hashlib.sha256(content).hexdigest()}\n".encode()


@contextmanager
def alone(key: str) -> Iterator[None]:
    """Let one process of this user at a time enter the block.

    One that ends within it, in any way, lets others in. Where the file system has no locks, or the
    folder is full, several make the same thing, which is slower.
    """
    file = cache_folder() / f".{key}.lock"
    try:
        descriptor = os.open(file, os.O_CREAT | os.O_RDWR, 0o600)
    except OSError:
        yield
        return
    try:
        with suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        # a process that waits for it, or comes later, looks first for what was made
        file.unlink(missing_ok=True)
        os.close(descriptor)
