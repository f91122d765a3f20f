"""The journal of a search: what it knows it does not compute, and what is not as it was written it does not know."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from measured.test_doubts import record_of, replay_of

from ev_study.measured.journal import Journal, search_key
from ev_study.measured.records.record import YAW_RATE
from ev_study.measured.replays.open_loop import Windows

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


def test_the_key_of_a_search_changes_with_all_that_its_answers_depend_on():
    """Windows of another length that begin at the same instants, and what of the record is believed, among others."""
    record = record_of()
    valid = record.valid.copy()
    valid[-1] = False
    replays = {"as it is": replay_of(record), "heavier": replay_of(record, inertia=1.1)}
    replays["longer"] = replay_of(record)
    replays["longer"].windows = Windows(replays["as it is"].windows.first, 151)
    replays["masked"] = replay_of(replace(record, valid=valid))
    replays["less noise"] = replay_of(replace(record, noise={}))
    replays["slower sensors"] = replay_of(replace(record, spacing={}))
    replays["of another"] = replay_of(record_of({YAW_RATE: 1.01 * record[YAW_RATE]}))
    keys = {search_key(replay, "choice") for replay in replays.values()} | {search_key(replays["as it is"], "other")}
    assert len(keys) == len(replays) + 1
    assert search_key(replays["as it is"], "choice") == search_key(replay_of(record), "choice")
