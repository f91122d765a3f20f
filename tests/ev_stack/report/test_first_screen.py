"""First screen of the page without a browser: its curves, its metrics, its line of facts."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest
from helpers.pages import CAR, run_on_a_circle, summary_of, two_runs

from ev_stack.report.page.first_screen import curve_plots, judged, series_channels
from ev_stack.report.page.plot_groups import groups_of
from ev_stack.report.page.writing import Page, Signals, signal_data, write_page
from ev_stack.report.summary import Difference
from ev_stack.scenarios.curves import DEFAULT
from ev_stack.scenarios.notes import Remark

CURVES = (
    "wheel_states.velocity",
    "torque_command.drive.front_left",
    "sideslip_angle",
    "imu.yaw_rate",
)


def metric(
    value: float | None, unit: str = "m/s", verdict: str = "measured", reference=None
) -> dict:
    return {"value": value, "unit": unit, "verdict": verdict, "reference": reference}


def facts(tmp_path: Path, summary: dict) -> tuple[str, str]:
    """The first screen as text, and what stands under "How it was driven"."""
    path = tmp_path / "page.html"
    path.unlink(missing_ok=True)
    write_page(Page("a", {"": summary}, (Signals("", two_runs(), CAR),)), path)
    body = path.read_text().split("<body>")[1]
    first, _, rest = body.partition('<section id="driven"')
    return first, rest.partition("</section>")[0]


def test_a_curve_is_a_field_with_its_wheels_a_channel_or_a_series():
    plots = curve_plots(CURVES, groups_of(run_on_a_circle(5.0).channels))
    assert [(plot["title"], plot["unit"], len(plot["curves"])) for plot in plots] == [
        ("wheel: velocity", "rad/s", 4),
        ("torque command: drive front left", "N m", 1),
        ("sideslip angle", "deg", 1),
        ("imu: yaw rate", "rad/s", 1),
    ]


def test_a_curve_that_is_not_recorded_has_an_empty_plot():
    (plot,) = curve_plots(["battery.current"], groups_of(["imu.yaw_rate"]))
    assert plot["title"] == "battery current" and plot["curves"] == []


def test_without_names_the_usual_curves_are_shown_or_the_first_ones():
    usual = curve_plots((), groups_of(run_on_a_circle(5.0).channels))
    assert [plot["curves"][0]["channel"] for plot in usual] == list(DEFAULT)
    names = [f"measured.{letter}" for letter in "abcdef"]
    others = curve_plots((), groups_of(names))
    assert [plot["curves"][0]["channel"] for plot in others] == names[:4]


def test_the_sideslip_angle_has_a_gap_where_the_car_stands():
    """At rest a velocity of rounding errors has any direction."""
    run = run_on_a_circle(5.0)
    run.channels["twist.longitudinal"] = np.where(run.time < 5.0, 5.0, 0.0)
    run.channels["twist.lateral"] = np.where(run.time < 5.0, 0.5, 1e-9)
    (found,) = series_channels(run, ["sideslip_angle", "imu.yaw_rate"]).values()
    assert found[0] == pytest.approx(np.arctan2(0.5, 5.0))
    assert np.isnan(found[-1])
    del run.channels["twist.lateral"]
    assert series_channels(run, ["sideslip_angle"]) == {}


def test_the_series_of_a_curve_is_on_the_page_and_in_no_group():
    index = signal_data([Signals("", two_runs(), None, curves=CURVES)]).index
    assert all("view.sideslip_angle" in run["channels"] for run in index["runs"])
    listed = [c["channel"] for g in index["groups"] for p in g["plots"] for c in p["curves"]]
    assert "view.sideslip_angle" not in listed


def test_metrics_that_failed_stand_first_then_those_with_a_reference():
    metrics = {
        "plain": metric(1.0),
        "right": metric(2.0, verdict="reproduced", reference=2.0),
        "wrong": metric(3.0, verdict="not reproduced: of another car", reference=1.0),
        "lost": metric(None, verdict="not measured: never driven"),
        "angle": metric(np.pi / 2, unit="rad"),
    }
    found = judged({"": {"metrics": metrics}})
    assert [name for name, _ in found.rows] == ["wrong", "right", "plain", "lost", "angle"]
    texts = [(cell.text, cell.failed) for _, (cell,) in found.rows]
    assert texts == [
        ("3 m/s", "not reproduced"),
        ("2 m/s", ""),
        ("1 m/s", ""),
        ("–", ""),
        ("90 deg", ""),
    ]
    assert found.failed == 1


@pytest.mark.parametrize("form", ["{run}_{name}", "{name}_{run}"])
def test_metrics_of_several_runs_stand_side_by_side(form: str):
    """Also of a run whose name begins or ends with that of another one."""
    runs = {"left": 1.0, "far_left": 2.0, "left_far": 3.0}
    metrics = {form.format(run=run, name="peak"): metric(value) for run, value in runs.items()}
    metrics["difference"] = metric(4.0)
    found = judged({"": {"runs": dict.fromkeys(sorted(runs)), "metrics": metrics}})
    assert found.columns == list(runs)
    (_, peaks), (_, differences) = found.rows
    assert [cell.text for cell in peaks] == ["1 m/s", "2 m/s", "3 m/s"]
    assert [cell.text for cell in differences] == ["4 m/s"]


def test_a_metric_that_only_looks_like_one_of_a_run_keeps_its_name():
    """`yaw_rate` is none of a run `rate`, and a difference of two runs is none of the first."""
    names = ["left_peak", "rate_peak", "left_rate_difference", "yaw_rate", "rate_of", "of_rate"]
    metric = {"value": 1.0, "unit": "m", "verdict": "measured", "reference": None}
    found = judged(
        {"": {"runs": {"left": {}, "rate": {}}, "metrics": dict.fromkeys(names, metric)}}
    )
    assert found.columns == ["left", "rate"]
    assert [(name, len(cells)) for name, cells in found.rows] == [
        ("peak", 2),
        ("left_rate_difference", 1),
        ("yaw_rate", 1),
        ("rate_of", 1),
        ("of_rate", 1),
    ]


def test_hash_seed_and_command_are_folded_and_warnings_are_not(tmp_path: Path):
    notes = (Remark("its tyres are an estimate"), "a fault begins after the end")
    summary = dataclasses.replace(summary_of(two_runs()), notes=notes).as_json()
    first, folded = facts(tmp_path, summary)
    assert "a fault begins after the end" in first and "its tyres are an estimate" not in first
    assert "its tyres are an estimate" in folded and "a fault begins" not in folded
    for words in (summary["signal_hash"], "Seed", summary["command"]):
        assert words in folded and words not in first
    assert "<details>" in folded and "<details open" not in folded


def test_another_car_is_its_file_and_not_the_list_of_its_numbers(tmp_path: Path):
    of_car = [
        Difference("command line", "every node", f"vehicle.{name}", 2.0, 1.0, "")
        for name in ("mass", "wheelbase", "front_track")
    ]
    own = Difference("command line", "driver", "preview.preview_time", 0.6, 0.5, "s")
    changed = dataclasses.replace(summary_of(two_runs()), differs=(*of_car, own), car="my_car.yaml")
    first, folded = facts(tmp_path, changed.as_json())
    assert "car: my_car.yaml" in first and "1 parameter changed" in first
    assert re.findall(r"<summary>(.*?)</summary>", folded)[1:] == [
        "Car: my_car.yaml (3 parameters)",
        "Changed from the scenario&#39;s file (1 parameter)",
    ]
    # Of the scenario's own car they are changes like any other.
    first, folded = facts(tmp_path, dataclasses.replace(changed, car="").as_json())
    assert "4 parameters changed" in first and "Car: " not in folded


def test_a_run_from_python_has_no_empty_command(tmp_path: Path):
    summary = dataclasses.replace(summary_of(two_runs()), command="").as_json()
    assert "Do it again" not in facts(tmp_path, summary)[1]


def test_a_run_that_has_spun_and_a_refused_case_are_in_sight(tmp_path: Path):
    summary = summary_of(two_runs()).as_json()
    summary["runs"]["slow"]["spun"] = True
    summary["runs"]["fast_one"]["spun"] = False
    assert "spun: slow</strong>" in facts(tmp_path, summary)[0]
    study = {**summary, "study": "compare", "cases": {"a": {"refused": "no"}, "b": {"spun": False}}}
    for case in study["cases"].values():
        case |= {"scenario": "s", "run": "", "values": [], "signal_hash": ""}
    del study["runs"]
    assert "refused: a</strong>" in facts(tmp_path, study)[0]


@pytest.mark.parametrize(
    ("runs", "names"),
    [(("lap", "lap"), ["a", "b"]), (("lap", "ride"), ["a: lap", "b: ride"])],
)
def test_results_of_the_same_run_are_named_by_their_folders(
    runs: tuple[str, str], names: list[str]
):
    results = [
        Signals(label, {run: run_on_a_circle(5.0)}, CAR)
        for label, run in zip("ab", runs, strict=True)
    ]
    assert [run["name"] for run in signal_data(results).index["runs"]] == names


def test_a_study_without_signals_has_its_table_once_and_no_empty_screen(tmp_path: Path):
    summary = summary_of(two_runs()).as_json()
    write_page(Page("a sweep", {"": summary}, (), {}, "a table"), tmp_path / "page.html")
    body = (tmp_path / "page.html").read_text().split("<body>")[1]
    assert body.count("a table") == 1 and 'class="top"' not in body
