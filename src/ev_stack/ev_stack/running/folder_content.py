"""Content of a folder: names that fit a pattern, its lock, the manifest of earlier commands."""

from __future__ import annotations

import fcntl
import fnmatch
import glob
import hashlib
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path, PurePosixPath

from ev_core.parameters.data_file import TABLE, read_data
from ev_stack.recording.recording import atomic_file

MANIFEST = "ev_stack_manifest.json"
_FORMAT = 1

# Path below the folder -> SHA-256; or the pattern of files that are being written -> None.
Files = dict[str, str | None]


def read_manifest(folder: Path) -> dict[str, Files]:
    """The files of each command by its name; ValueError if there is something else of that name."""
    path = folder / MANIFEST
    if not os.path.lexists(path):
        return {}
    if not is_file(path):
        raise ValueError("not a file")
    content = json.loads(read_data(path, TABLE))
    if not isinstance(content, dict) or content.get("format") != _FORMAT:
        raise ValueError("another format")
    written: dict[str, Files] = content.get("written")
    if not isinstance(written, dict) or not all(map(_is_sound, written.values())):
        raise ValueError("damaged")
    return written


def _is_sound(files: object) -> bool:
    return isinstance(files, dict) and all(
        stays_within(name) and isinstance(digest, str | None) for name, digest in files.items()
    )


def stays_within(name: str) -> bool:
    """Return True if a path can only be below the folder that it begins in."""
    path = PurePosixPath(name)
    return (
        bool(path.parts) and not path.is_absolute() and ".." not in path.parts and str(path) == name
    )


def write_manifest(folder: Path, written: Mapping[str, Files]) -> None:
    """Replace the manifest of a folder."""
    with atomic_file(folder / MANIFEST, replaces=True) as file:
        file.write(json.dumps({"format": _FORMAT, "written": written}, indent=1).encode() + b"\n")


def is_file(path: Path) -> bool:
    """Return True for a regular file that is no link."""
    return path.is_file() and not path.is_symlink()


def is_folder(path: Path) -> bool:
    """Return True for a folder that is no link."""
    return path.is_dir() and not path.is_symlink()


@contextmanager
def locked(folder: Path, how: int) -> Iterator[None]:
    """A lock of a folder, as `fcntl.flock` takes it, for the block, or until this process and its children end."""
    held = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(held, how)
        yield
    finally:
        os.close(held)


def digest_of(path: Path) -> str:
    """SHA-256 of a file, as hexadecimal digits."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def there(folder: Path, pattern: str) -> Iterator[str]:
    """The names below a folder that fit a pattern, or those of what stands in the place of a folder on the way.

    Nothing is looked for behind a link.
    """
    head, _, rest = pattern.partition("/")
    found = sorted(fnmatch.filter(os.listdir(folder), head)) if glob.has_magic(head) else [head]
    for name in found:
        if rest and is_folder(folder / name):
            yield from (f"{name}/{each}" for each in there(folder / name, rest))
        elif os.path.lexists(folder / name):
            yield name


def content(folder: Path, name: str) -> Iterator[str]:
    """The names of all files that are in a folder below, and of empty folders; the name itself if it is none."""
    if is_folder(folder / name):
        for each in sorted(os.listdir(folder / name)):
            inner = f"{name}/{each}"
            is_empty = is_folder(folder / inner) and not os.listdir(folder / inner)
            yield from [inner] if is_empty else content(folder, inner)
    else:
        yield name
