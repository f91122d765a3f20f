"""Results of runs that took long, kept for the user: what was stopped goes on, and nothing is driven twice.

How it works: a result stands under a digest of all that it depends on beside our sources, in a
folder that is named after the digest of these. So a result of which anything has changed is simply
not found. Each file begins with a checksum; what a crash or a full disk has left of it counts as
missing. Folders of other sources stay for a month, since another checkout or branch may come back
to them, but recordings, which are large, only those of the last few and of the last day: a command
that drives on in another checkout still reads them.

A dict serves in its place where nothing shall outlive the command.
"""

from __future__ import annotations

import hashlib
import io
import os
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Protocol

import numpy as np

from ev_core.compiling.user_cache import cache_folder, read_checked, write_checked

VARIABLE = "EV_STACK_RESULTS"  # the folder, such as one that all machines of a cluster see
RECORDING = ".npz"
_FOLDERS = 3  # with recordings that stay
_DAY = 86400.0  # [s]
_MONTH = 30.0 * _DAY
# Only folders with such a name are ours to remove: the user may have chosen any parent.
_DIGEST = "[0-9a-f]" * 24


class Results(Protocol):
    """Contents by name."""

    def get(self, name: str, /) -> bytes | None:
        """The content of a name; None if there is none."""

    def __setitem__(self, name: str, content: bytes, /) -> None:
        """Keep a content."""


class ResultStore:
    """Results of our sources as they are; `folder` is by default in the user's cache folder."""

    def __init__(self, sources: str, folder: Path | None = None) -> None:
        parent = folder or Path(os.environ.get(VARIABLE) or cache_folder() / "results").absolute()
        self.folder = parent / sources
        self.folder.mkdir(parents=True, exist_ok=True)
        os.utime(self.folder)  # each result that is kept later counts as a use as well
        # With each command that opens a store: no process has to clean up.
        _forget_old(parent)

    def path(self, name: str) -> Path:
        """Path of a name, for a recording, which its writer writes by itself."""
        return self.folder / name

    def get(self, name: str) -> bytes | None:
        """The content of a name; None if there is none, or if it is not what was written."""
        return read_checked(self.folder / name)

    def __setitem__(self, name: str, content: bytes) -> None:
        self.folder.mkdir(parents=True, exist_ok=True)  # the user may delete it at any time
        write_checked(self.folder / name, content)


def _forget_old(parent: Path) -> None:
    """Remove what no command has used in a month, and recordings but for those of the last sources."""
    folders = sorted(parent.glob(_DIGEST), key=_last_used, reverse=True)
    for number, folder in enumerate(folders):
        unused = time.time() - _last_used(folder)
        # The order of the folders is by their last use, the latest first.
        if unused > _MONTH:
            shutil.rmtree(folder, ignore_errors=True)
        elif number >= _FOLDERS and unused > _DAY:
            for recording in folder.glob(f"*{RECORDING}"):
                recording.unlink(missing_ok=True)


def _last_used(folder: Path) -> float:
    try:
        return folder.stat().st_mtime
    except OSError:  # another command has just removed it
        return 0.0


class Answers:
    """Answers of functions at arrays of points, computed once.

    `key` is a digest of all else that they depend on. `refuse_changed` raises an error if that is
    no longer so, as when a file has been edited since: such an answer is not kept.
    """

    def __init__(
        self, results: Results, key: str, refuse_changed: Callable[[], None] = lambda: None
    ) -> None:
        self._results = results
        self._key = key
        self._refuse_changed = refuse_changed
        self._own = set[str]()
        self.taken = 0  # that an earlier command has computed

    def answer(
        self, of: object, points: np.ndarray, compute: Callable[[np.ndarray], np.ndarray]
    ) -> np.ndarray:
        """The kept answer, else the computed one, which is kept.

        `of` is what one function differs by from the others of the key, as its text: a search asks
        several at a point.
        """
        asked = f"{self._key} {of!r} {points.dtype.str} {points.shape} ".encode() + points.tobytes()
        name = f"{hashlib.sha256(asked).hexdigest()}.answer"
        kept = self._results.get(name)
        if kept is not None:
            # An answer that this very command has computed is no earlier one.
            self.taken += name not in self._own
            return np.load(io.BytesIO(kept), allow_pickle=False)
        found = compute(points)
        self._refuse_changed()
        np.save(content := io.BytesIO(), found, allow_pickle=False)
        self._results[name] = content.getvalue()
        self._own.add(name)
        return found
