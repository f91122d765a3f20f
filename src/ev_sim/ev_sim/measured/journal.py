"""What a search has computed, on disk while it is under way: one that was stopped goes on, with the same bits."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ev_sim.measured.replays.open_loop import OpenLoop
from ev_sim.study.kept_rows import digest_of_sources


class Journal:
    """Answers of a function at arrays of points, in the order in which a search asks for them.

    As long as the points are those of the file, so are the answers. From the first that differs, or is not whole, the
    file is written anew. `key` is a digest of all else that the answers depend on.
    """

    def __init__(self, file: Path, key: str) -> None:
        self._path, self.taken = file, 0
        self._file = file.open("r+b" if file.exists() else "w+b")
        if self._file.read(len(key)) != key.encode():
            self._file.seek(0)
            self._file.truncate()
            self._file.write(key.encode())

    def answer(self, points: np.ndarray, compute: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """That of the file, if it is the next one there, else the computed one."""
        place = self._file.tell()
        try:
            asked, found = (np.load(self._file, allow_pickle=False) for _ in range(2))
            if np.array_equal(asked, points):
                self.taken += 1
                return found
        except (EOFError, ValueError):  # the end, or a part of an array
            pass
        self._file.seek(place)
        self._file.truncate()
        found = compute(points)
        for each in (points, found):
            np.save(self._file, each, allow_pickle=False)
        self._file.flush()
        return found

    def remove(self) -> None:
        """The search has come to its end."""
        self._file.close()
        self._path.unlink()


def search_key(replay: OpenLoop, *choices: object) -> str:
    """A digest of our sources, record, windows, car and what was chosen for a search."""
    roles = {role: (each.method.name, each.values()) for role, each in replay.configurations.items()}
    content = hashlib.sha256(repr((digest_of_sources(), roles, replay.is_imposed, choices)).encode())
    for values in (replay.windows.first, *(values for _, values in sorted(replay.record.channels.items()))):
        content.update(np.ascontiguousarray(values).tobytes())
    return content.hexdigest()
