"""The journal of a search: what it knows it does not compute, and what is not as it was written it does not know."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ev_sim.measured.journal import Journal

KEY = "key of a search"
POINTS = [np.full((2, 3), float(n)) for n in range(3)]


def answers(path: Path) -> int:
    """How many of three are known; all of them are right."""
    journal = Journal(path, KEY)
    found = [journal.answer(points, lambda points: points.sum(axis=1)) for points in POINTS]
    assert all(np.array_equal(each, points.sum(axis=1)) for each, points in zip(found, POINTS, strict=True))
    return journal.taken


def test_answers_are_right_whichever_byte_is_another_one_and_wherever_the_file_ends(tmp_path: Path):
    """A byte in an array was another answer, one in its head a traceback."""
    path, random = tmp_path / "journal", np.random.default_rng(1)
    assert answers(path) == 0
    written = path.read_bytes()
    assert answers(path) == 3
    for place in random.integers(len(written), size=100).tolist():
        flipped = bytearray(written)
        flipped[place] ^= int(random.integers(1, 256))
        path.write_bytes(flipped)
        assert answers(path) < 3
        assert path.read_bytes() == written
        path.write_bytes(written[:place])
        assert answers(path) < 3
        assert path.read_bytes() == written
