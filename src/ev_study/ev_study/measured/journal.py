"""What a search has computed, on disk while it is under way: one that was stopped goes on, with the same bits."""

from __future__ import annotations

import hashlib
import io
from collections.abc import Callable
from pathlib import Path

import numpy as np

from ev_study.measured.replays.open_loop import OpenLoop
from ev_study.studies.digests import digest_of_sources, text_of_method

_DIGEST, _LENGTH = hashlib.sha256().digest_size, 8  # bytes before each answer


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
        content = self._next()
        if content:
            asked, found = (np.load(content, allow_pickle=False) for _ in range(2))
            if np.array_equal(asked, points):
                self.taken += 1
                return found
        self._file.seek(place)
        self._file.truncate()
        found, content = compute(points), io.BytesIO()
        for each in (points, found):
            np.save(content, each, allow_pickle=False)
        written = content.getvalue()
        self._file.write(hashlib.sha256(written).digest() + len(written).to_bytes(_LENGTH) + written)
        self._file.flush()
        return found

    def _next(self) -> io.BytesIO | None:
        """What stands next in the file, None if it is not whole, or another byte is in it."""
        digest, length = self._file.read(_DIGEST), int.from_bytes(self._file.read(_LENGTH))
        content = self._file.read(min(length, self._path.stat().st_size))
        return io.BytesIO(content) if hashlib.sha256(content).digest() == digest else None

    def remove(self) -> None:
        """The search has come to its end."""
        self._file.close()
        self._path.unlink()


def search_key(replay: OpenLoop, *choices: object) -> str:
    """A digest of our sources, record, windows, car and what was chosen for a search."""
    roles = {
        role: (each.method.name, text_of_method(each.method), each.values())
        for role, each in replay.configurations.items()
    }
    record = replay.record
    given = (digest_of_sources(), roles, replay.is_imposed, replay.cut_off, record.noise, record.spacing, choices)
    content = hashlib.sha256(repr(given).encode())
    for values in (
        np.array(replay.windows.size),
        replay.windows.first,
        record.valid,
        *(values for _, values in sorted(record.channels.items())),
    ):
        content.update(np.ascontiguousarray(values).tobytes())
    return content.hexdigest()
