"""Folder that a command writes into: a new one for each run, so that nothing is ever overwritten.

How it works: without --out a run gets results/NAME/TIME. `mkdir` makes it and fails if it exists,
so two runs of one second get two folders. The link results/NAME/latest leads to the last run that
has come to its end. It is made under another name and then renamed, so a run that is killed leaves
the link of the run before. A folder of --out must be new or empty.
"""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from datetime import datetime
from pathlib import Path

from ev_msgs_py.refusal import ParameterError, quoted
from ev_stack.recording.outcome import announce
from ev_stack.scenarios.records import Run

LATEST = "latest"


@contextmanager
def output_folder(given: Path | None, name: str) -> Iterator[Path]:
    """Make the folder of a command for the block: the `given` one, or a new one in results/NAME."""
    if given is not None:
        yield new_or_empty(given)
        return
    folder = _named_by_time(Path("results", name).absolute())
    try:
        yield folder
    except BaseException:
        # An empty folder of a run that was refused is not left behind; a full one stays.
        with suppress(OSError):
            folder.rmdir()
        if folder.exists():
            announce(f"note: what was written until then is in {folder}")
        raise
    _lead_latest_to(folder)


def new_or_empty(folder: Path) -> Path:
    """Make a folder; ParameterError, in one line, if that cannot be or if it holds anything."""
    folder = folder.absolute()
    try:
        str(folder).encode()  # bags and pages hold the name as text
        folder.mkdir(parents=True, exist_ok=True)
        held = sorted(os.listdir(folder))
    except (OSError, ValueError) as error:
        raise _refused(folder, getattr(error, "strerror", None) or "no name in UTF-8") from None
    if held:
        raise _refused(folder, f"{quoted(held[0])} is there")
    if not os.access(folder, os.W_OK):  # a study would find it out after hours of driving
        raise _refused(folder, "it is read-only")
    return folder


def new_file(path: Path) -> Path:
    """Make the folder of a file to be written; ParameterError if something has its name."""
    if os.path.lexists(path):
        raise ParameterError(f"{path} exists, expected the name of a new file")
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def folder_of(run: Run, runs: Sequence[Run], folder: Path) -> Path:
    """Make the folder of one of the runs of a command: if it is the only one, that of the command."""
    if len(runs) == 1:
        return folder
    (folder / run.name).mkdir()
    return folder / run.name


def _refused(folder: Path, why: str) -> ParameterError:
    return ParameterError(f"{folder}: {why}, expected a new or an empty folder")


def _named_by_time(parent: Path) -> Path:
    parent.mkdir(parents=True, exist_ok=True)
    time = datetime.now().strftime("%Y-%m-%d_%H-%M-%S")
    folder = parent / time
    number = 1
    while True:
        try:
            folder.mkdir()
            return folder
        except FileExistsError:
            number += 1
            folder = parent / f"{time}_{number}"


def _leads_beside(path: Path) -> bool:
    """Return whether a path is a link to something in its own folder, as ours are."""
    return path.is_symlink() and path.readlink().parent == Path()


def _lead_latest_to(folder: Path) -> None:
    latest = folder.with_name(LATEST)
    link = folder.with_name(f".{folder.name}")
    try:
        # A user's own folder or link of that name is not replaced.
        if os.path.lexists(latest) and not _leads_beside(latest):
            raise FileExistsError(errno.EEXIST, "it is no link of ours")
        # Relative, so that results can be moved as a whole.
        link.symlink_to(folder.name)
        link.replace(latest)
    except OSError as error:  # also a file system without links: the results are there all the same
        announce(f"note: {latest} does not lead to {folder.name}: {error.strerror}")
