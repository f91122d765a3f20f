"""The key of a search changes with all that its answers depend on."""

from __future__ import annotations

from dataclasses import replace

from measured.test_doubts import record_of, replay_of

from ev_study.measured.records.record import YAW_RATE
from ev_study.measured.replays.open_loop import Windows
from ev_study.measured.search_key import search_key


def test_the_key_of_a_search_changes_with_all_that_its_answers_depend_on():
    """Lengths of windows and believed parts of the record count, among others."""
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
    keys = {search_key(replay, "choice") for replay in replays.values()} | {
        search_key(replays["as it is"], "other")
    }
    assert len(keys) == len(replays) + 1
    assert search_key(replays["as it is"], "choice") == search_key(replay_of(record), "choice")
