"""Needs of verdicts are driven once, and again only where something has changed."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers.judging import drive_here
from helpers.run_script import ROOT

from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.run_scenario import main
from ev_stack.recording.outcome import RunFailed
from ev_study.studies.result_store import ResultStore
from ev_study.studies.study import CaseResult
from ev_study.verdicts.need import ScenarioNeed, StudyNeed, cases_of, drive, kept_by_user, key_of

HOLDING = ScenarioNeed("shchur2019_steps", runs=("hold_manual",), duration=0.1)
SHORT_STUDY = StudyNeed("five_methods", ("--seeds", "1", "--drivers", "pulse"))
CHEAP = cases_of(HOLDING)[0]
LAW = """
from ev_core.law import WheelTorqueCommand, WheelTorqueRequest, compilable, method

@method("asr", "mine")
@compilable
def mine(request: WheelTorqueRequest) -> WheelTorqueCommand:
    return WheelTorqueCommand(request.drive, request.brake)
"""


def store_at(folder: Path) -> ResultStore:
    """Store of an earlier command."""
    return ResultStore("0" * 24, folder)


def counting(driven: list[str]):
    def drive_cases(cases, measures, keep):
        driven.extend(case.run for case in cases)
        return drive_here(cases, measures, keep)

    return drive_cases


def test_a_run_is_driven_once(tmp_path: Path):
    driven: list[str] = []
    first = drive([HOLDING, HOLDING], store_at(tmp_path), counting(driven))[HOLDING]
    again = drive([HOLDING], store_at(tmp_path), counting(driven))[HOLDING]
    assert driven == ["hold_manual"]
    assert list(again.runs) == ["hold_manual"]
    assert np.array_equal(first.runs["hold_manual"].time, again.runs["hold_manual"].time)
    assert again.vehicle.name == "audi_a2"


def test_another_text_outside_of_config_is_another_run(tmp_path: Path):
    """A scenario is named by the path of its file, which stays the same."""
    file, driven = tmp_path / "mine.yaml", list[str]()
    need = ScenarioNeed(str(file), runs=("hold_manual",), duration=0.1)
    text = (ROOT / "config/scenarios/shchur2019_steps.yaml").read_text()
    texts = (text, f"{text}\n/**/steering_column: {{ros__parameters: {{damping: 8.0}}}}\n")
    for each in (*texts, texts[0]):
        file.write_text(each)
        runs = drive([need], store_at(tmp_path / "kept"), counting(driven))[need]
        assert runs.parameters["steering_column"]["damping"] == (8.0 if each == texts[1] else 7.5)
    assert driven == ["hold_manual", "hold_manual"]


@pytest.mark.parametrize("way", ["vehicle", "value", "file"])
def test_a_case_is_kept_by_the_texts_of_the_files_that_it_names(way: str, tmp_path: Path):
    """A car, a law or a parameter file by the path of it."""
    texts, name = {
        "vehicle": ((ROOT / "config/vehicles/audi_a2.yaml").read_text(), "mine.yaml"),
        "value": (LAW, "mine.py"),
        "file": ("/**/steering_column: {ros__parameters: {damping: 8.0}}", "mine.yaml"),
    }[way]
    file = tmp_path / name
    changed = {"vehicle": str(file)} if way == "vehicle" else {"files": (file,)}
    if way == "value":
        changed = {"values": (*CHEAP.values, ("asr", "method", f"{file}:mine"))}
    case = replace(CHEAP, **changed)
    keys = []
    for text in (texts, texts + "\n# another text\n", texts):
        file.write_text(text)
        keys.append(key_of("", case, {}).digest)
    assert keys[0] == keys[2] != keys[1]


def test_another_parameter_is_another_run(tmp_path: Path):
    driven: list[str] = []
    changed = ScenarioNeed(
        "shchur2019_steps", (("steering_column", "damping", 8.0),), ("hold_manual",), 0.1
    )
    drive([HOLDING, changed], store_at(tmp_path), counting(driven))
    assert driven == ["hold_manual", "hold_manual"]
    assert changed.command == "shchur2019_steps --set steering_column.damping=8.0 --duration 0.1"


def measuring(cases, measures, keep):
    """Drive a case that every study can measure in place of each case."""
    return drive_here([CHEAP] * len(cases), [lambda recording, run: {"x": 1.0}] * len(cases), keep)


def refusing(cases, measures, keep):
    """Refuse all cases."""
    for number, case in enumerate(cases):
        keep(number, CaseResult(case.name, {}, refused="no"))


def test_what_a_study_has_measured_is_kept(tmp_path: Path):
    drive([SHORT_STUDY], store_at(tmp_path), measuring)
    again = drive(
        [SHORT_STUDY], store_at(tmp_path), lambda *jobs: pytest.fail("nothing is left to drive")
    )[SHORT_STUDY]
    assert list(again.results) == [case.name for case in cases_of(SHORT_STUDY)]
    assert all(result.measured == {"x": 1.0} for result in again.results.values())


def test_what_was_measured_before_a_stop_is_not_driven_again(tmp_path: Path):
    def stopped(cases, measures, keep):
        measuring(cases[:2], measures[:2], keep)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        drive([SHORT_STUDY], store_at(tmp_path), stopped)
    left: list[str] = []
    drive(
        [SHORT_STUDY],
        store_at(tmp_path),
        lambda cases, *more: left.extend(c.name for c in cases) or measuring(cases, *more),
    )
    assert left == [case.name for case in cases_of(SHORT_STUDY)][2:]


def test_a_refused_case_of_a_study_stays_refused(tmp_path: Path):
    drive([SHORT_STUDY], store_at(tmp_path), refusing)
    again = drive([SHORT_STUDY], store_at(tmp_path), drive_here)[SHORT_STUDY]
    assert {result.refused for result in again.results.values()} == {"no"}


def test_two_may_drive_the_same_and_what_is_cut_off_is_driven_again(tmp_path: Path):
    """The second of two commands takes the file of the first.

    Half a file, of a crash, counts as missing.
    """
    driven: list[str] = []
    store = store_at(tmp_path)

    def both(cases, measures, keep):
        drive_here(cases, measures)
        return counting(driven)(cases, measures, keep)

    drive([HOLDING], store, both)
    (path,) = store.folder.iterdir()
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    drive([HOLDING], store, counting(driven))
    assert len(driven) == 2
    assert path.read_bytes() == whole


@pytest.mark.parametrize("need", [HOLDING, SHORT_STUDY], ids=["signals", "rows"])
def test_nothing_is_kept_of_a_configuration_that_changes_while_it_is_driven(
    need: ScenarioNeed | StudyNeed, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The store is named after the files as they were: it would have numbers of the others."""
    from ev_study.studies import digests

    car = tmp_path / "car.yaml"
    car.write_text("mass: 1\n")
    monkeypatch.setattr(digests, "_config", lambda: [("car.yaml", car)])
    store = store_at(tmp_path / "kept")

    def edited(cases, measures, keep):
        car.write_text("mass: 2\n")
        if need is HOLDING:
            return drive_here(cases, measures, keep)
        return measuring(cases, measures, keep)

    with pytest.raises(RunFailed, match=r"car\.yaml has changed since the runs began"):
        drive([need], store, edited)
    assert list(store.folder.iterdir()) == []


def test_a_changed_configuration_is_driven_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    from ev_study.studies import digests

    kept_by_user(tmp_path)
    before = set(tmp_path.iterdir())
    files = [*digests._config()]
    other = tmp_path / "other.yaml"
    other.write_text("x: 1\n")
    monkeypatch.setattr(digests, "_config", lambda: [*files, ("other.yaml", other)])
    kept_by_user(tmp_path)
    assert [path.is_dir() for path in set(tmp_path.iterdir()) - before - {other}] == [True]


def test_a_run_that_cannot_be_driven_is_one_line(tmp_path: Path):
    with pytest.raises(RunFailed, match=r"^shchur2019_steps --duration 0\.1 hold_manual: no$"):
        drive([HOLDING], store_at(tmp_path), refusing)


def test_command_writes_one_object_for_each_id(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys
):
    monkeypatch.chdir(tmp_path)
    only = (
        "--only",
        "shchur.hold30",
        "shchur.fig2",
        "--only",
        "shchur.fig4.transients",
        "shchur.fig1b.end",
    )
    main(["verdicts", *only])
    output = capsys.readouterr().out
    written = json.loads((tmp_path / "results/verdicts/latest/verdicts.json").read_text())
    assert [each["id"] for each in written] == [
        "shchur.fig1b.end",
        "shchur.hold30.manual",
        "shchur.hold30.assisted",
        "shchur.hold30.dm",
        "shchur.fig4.transients",
        "shchur.fig2",
    ]
    end, manual, assisted, *_ = written
    assert (end["figures"], manual["figures"]) == (["shchur2019_fig_1_b.png"], [])
    assert all(
        {"id", "printed", "ours", "verdict", "assumption", "run"} <= each.keys() for each in written
    )
    assert manual["verdict"] == "reproduced"
    assert assisted["verdict"] == f"reproduced with assumption {assisted['assumption']}"
    assert manual["run"] == "shchur2019_steps"
    assert (
        "all: 6 ids, 3 reproduced with assumption, 1 reproduced, 1 not judgeable, 1 no verdict"
        in output
    )
    assert "shchur.hold30.manual" in (tmp_path / "results/verdicts/latest/verdicts.md").read_text()


@pytest.mark.parametrize("command", ["verdicts", "figures"])
def test_unknown_source_is_one_line(command: str):
    with pytest.raises(SystemExit, match=r"^error: --only 'unknown'"):
        main([command, "--only", "unknown"])


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["--only", "shchur2019", "unknown"], "--only 'unknown': no such id or source"),
        (["--only", "measured"], "--only 'measured': no such id or source"),
        (["--only", "ge.claim.low_speed", "--quick"], "--quick leaves nothing of --only ge.claim"),
        (["--only", "shchur.fig2", "--data", "."], "--data is refused beside --only shchur.fig2"),
    ],
)
def test_no_word_of_what_is_judged_is_passed_over(words: list[str], line: str, tmp_path: Path):
    out = tmp_path / "out"
    with pytest.raises(SystemExit, match=f"^error: {line}"):
        main(["verdicts", *words, "--out", str(out)])
    assert not out.exists()


def test_a_misspelt_parameter_is_refused(tmp_path: Path):
    misspelt = ScenarioNeed("shchur2019_steps", (("steering_column", "dampling", 8.0),))
    with pytest.raises(ParameterError, match="dampling"):
        drive([misspelt], store_at(tmp_path), drive_here)
