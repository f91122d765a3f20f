"""Results come back as long as nothing of theirs has changed; damaged ones never do."""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np
import pytest

from ev_stack.recording.outcome import RunFailed
from ev_study.studies.result_store import Answers, ResultStore

SOURCES = f"{7:024x}"
DAY = 86400.0
POINTS = [np.full((2, 3), float(n)) for n in range(3)]


def test_a_content_comes_back_for_the_same_sources_alone(tmp_path: Path):
    store = ResultStore(SOURCES, tmp_path)
    store["a.row"] = b"content"
    assert store.get("a.row") == b"content"
    assert store.get("b.row") is None
    assert ResultStore(SOURCES, tmp_path).get("a.row") == b"content"
    assert ResultStore(f"{8:024x}", tmp_path).get("a.row") is None


def test_a_content_with_another_byte_or_without_its_end_is_missing(tmp_path: Path, capsys):
    random = np.random.default_rng(1)
    store = ResultStore(SOURCES, tmp_path)
    store["a.row"] = bytes(range(200))
    written = store.path("a.row").read_bytes()
    for place in random.integers(len(written), size=100).tolist():
        flipped = bytearray(written)
        flipped[place] ^= int(random.integers(1, 256))
        for content in (flipped, written[:place]):
            store.path("a.row").write_bytes(content)
            assert store.get("a.row") is None
            assert not store.path("a.row").exists()
    assert "does not fit its checksum" in capsys.readouterr().err


def age(folder: Path, days: float) -> None:
    os.utime(folder, (time.time() - days * DAY,) * 2)


def test_results_of_other_sources_stay_for_a_month_and_recordings_of_the_last_few(tmp_path: Path):
    """A folder that is not named as ours stays, whatever its age."""
    days = [1.0, 2.0, 3.0, 4.0, 40.0]
    folders = [tmp_path / f"{number:024x}" for number in range(len(days))]
    for folder, old in zip(folders, days, strict=True):
        folder.mkdir()
        for name in ("of_a_run.npz", "of_a_case.row"):
            (folder / name).touch()
        age(folder, old)
    (tmp_path / "thesis").mkdir()
    age(tmp_path / "thesis", 400.0)
    ResultStore(SOURCES, tmp_path)
    assert [folder.exists() for folder in folders] == [True, True, True, True, False]
    assert [(folder / "of_a_run.npz").exists() for folder in folders[:4]] == [
        True,
        True,
        False,
        False,
    ]
    assert all((folder / "of_a_case.row").exists() for folder in folders[:4])
    assert (tmp_path / "thesis").exists()


def test_the_folder_is_that_of_the_variable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("EV_STACK_RESULTS", str(tmp_path / "ours"))
    assert ResultStore(SOURCES).folder == tmp_path / "ours" / SOURCES


def taken(store: ResultStore, key: str) -> int:
    """Check three answers and count those that an earlier command has computed."""
    answers = Answers(store, key)
    for points in POINTS:
        assert np.array_equal(
            answers.answer("sum", points, lambda points: points.sum(axis=1)), points.sum(axis=1)
        )
    return answers.taken


def test_an_answer_is_computed_once_for_a_key_and_its_points(tmp_path: Path):
    store = ResultStore(SOURCES, tmp_path)
    assert [taken(store, key) for key in ("one", "one", "other")] == [0, 3, 0]


def test_an_answer_that_one_search_asks_for_twice_was_not_computed_before(tmp_path: Path):
    answers = Answers(ResultStore(SOURCES, tmp_path), "one")
    for _ in range(2):
        answers.answer("sum", POINTS[1], lambda points: points.sum(axis=1))
    assert answers.taken == 0


def test_two_functions_that_a_search_asks_at_one_point_have_answers_of_their_own(tmp_path: Path):
    """The errors of a fit by other weights, and the runs of other cars at the same number."""
    answers = Answers(ResultStore(SOURCES, tmp_path), "one")
    for factor in (1.0, 2.0, 1.0):
        found = answers.answer(
            {"weight": factor}, POINTS[1], lambda points, factor=factor: factor * points
        )
        assert np.array_equal(found, factor * POINTS[1])


def test_an_answer_of_files_that_have_changed_since_is_not_kept(tmp_path: Path):
    store = ResultStore(SOURCES, tmp_path)

    def changed() -> None:
        raise RunFailed("car.yaml has changed")

    with pytest.raises(RunFailed):
        Answers(store, "one", changed).answer("sum", POINTS[0], lambda points: points)
    assert taken(store, "one") == 0
