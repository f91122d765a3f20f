"""report.html without a browser.

What is packed comes back, its content is complete, closed and well ordered.
"""

from __future__ import annotations

import base64
import dataclasses
import hashlib
import json
import re
import zlib
from html.parser import HTMLParser
from importlib.resources import files
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from helpers.pages import CAR, GAP, HOSTILE, page_of, run_on_a_circle, summary_of, two_runs

from ev_stack.commands.run_scenario import main
from ev_stack.measures.metric import Metric
from ev_stack.recording.recording import Recording, save
from ev_stack.report import page as package
from ev_stack.report.page.parameter_units import unit_of
from ev_stack.report.page.plot_groups import groups_of
from ev_stack.report.page.writing import (
    Packed,
    Page,
    Signals,
    envelope,
    measured_signals,
    pack,
    signal_data,
    write_page,
)
from ev_stack.report.summary import EVERY_NODE, differences, write_summary
from ev_stack.scenarios.scenario import Overrides, load_scenario

EMPTY = ("meta", "link", "img", "input", "br")


class Outline(HTMLParser):
    """Tags with their attributes, headings, and the tags that were left open."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in EMPTY:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def all(self, *tags: str) -> list[dict[str, str | None]]:
        return [attributes for tag, attributes in self.tags if tag in tags]


def unpack(packed: Packed) -> np.ndarray:
    """The values (count,), NaN where there is a gap, as the page computes them."""
    raw = np.frombuffer(zlib.decompress(base64.b64decode(packed.text)), np.uint8)
    rows = raw.reshape(packed.planes, packed.count).astype(np.int64)
    codes = np.cumsum(sum(row << 8 * plane for plane, row in enumerate(rows))) & (
        256**packed.planes - 1
    )
    return np.where(codes == 0, np.nan, packed.low + (codes - 1) * packed.step)


@pytest.fixture(scope="module")
def text(tmp_path_factory: pytest.TempPathFactory) -> str:
    return page_of(tmp_path_factory.mktemp("page"), two_runs()).read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def outline(text: str) -> Outline:
    parser = Outline()
    parser.feed(text)
    assert not parser.open
    return parser


@pytest.mark.parametrize("planes", [3, 2])
def test_packed_samples_come_back_within_half_a_step(planes: int):
    values = np.random.default_rng(1).normal(0.0, 300.0, 500)
    values[[0, 7, 499]] = np.nan, np.inf, np.nan
    packed = pack(values, planes)
    ours = unpack(packed)
    finite = np.isfinite(values)
    assert np.array_equal(np.isfinite(ours), finite)
    assert packed.step == pytest.approx(np.ptp(values[finite]) / 256**planes, rel=1e-4)
    # Half a step, and the rounding of a float64 of this size
    assert np.abs(ours - values)[finite].max() <= packed.step / 2 + 1e-12


def test_a_zero_stays_a_zero():
    values = np.array([-79.3, 0.0, 1e-9, 0.0, 41.7])
    assert np.array_equal(unpack(pack(values, 2))[[1, 3]], [0.0, 0.0])


def test_a_constant_and_a_gap_alone_can_be_packed():
    assert np.array_equal(unpack(pack(np.full(9, 3.7), 3)), np.full(9, 3.7))
    assert np.isnan(unpack(pack(np.full(9, np.nan), 3))).all()


def test_instants_are_multiples_of_the_period():
    time = np.arange(116001) * 0.005
    assert np.abs(unpack(pack(time, 3, step=0.005)) - time).max() < 1e-9


def test_an_envelope_keeps_the_extremes_of_every_stretch():
    run = run_on_a_circle(5.0)
    values = run.channels["imu.yaw_rate"]
    values[333] = 1e6
    shorter = envelope(run, 8)
    whole = len(run.time) // 16 * 16
    assert len(shorter.time) == 2 * (len(run.time) // 16) + min(len(run.time) - whole, 2)
    kept = shorter.channels["imu.yaw_rate"][: whole // 8].reshape(-1, 2)
    assert np.array_equal(kept.max(axis=1), values[:whole].reshape(-1, 16).max(axis=1))
    assert np.array_equal(kept.min(axis=1), values[:whole].reshape(-1, 16).min(axis=1))
    at_spike = shorter.time[np.argmax(shorter.channels["imu.yaw_rate"])]
    assert abs(at_spike - run.time[333]) <= 16 * 0.01


@pytest.mark.parametrize("instants", range(33, 49))
def test_an_envelope_lasts_as_long_as_its_run(instants):
    """The last samples of a run, up to 2 `every` - 1, are in it."""
    values = np.zeros(instants)
    values[-1] = 7.0
    shorter = envelope(Recording(np.arange(instants) * 0.01, {"x": values}), 8)
    assert shorter.channels["x"].max() == 7.0 and len(shorter.time) == len(shorter.channels["x"])
    assert abs(shorter.time[-1] - (instants - 1) * 0.01) <= 8 * 0.01
    assert np.all(np.diff(shorter.time) > 0.0)
    assert np.abs(unpack(pack(shorter.time, 3, step=0.01)) - shorter.time).max() < 1e-9


def test_signals_get_coarser_until_they_fit_and_the_page_says_so():
    results = [Signals("", two_runs(), CAR)]
    fine = signal_data(results)
    size = sum(map(len, fine.blocks))
    coarse, coarsest = signal_data(results, size - 1), signal_data(results, size // 5)
    assert "every sample is there" in fine.precision and "16\u202f777\u202f212" in fine.precision
    assert "every sample is there" in coarse.precision and "65\u202f532" in coarse.precision
    assert "lowest and the highest" in coarsest.precision
    assert sum(map(len, coarsest.blocks)) <= size // 5


def test_signals_that_never_fit_come_as_coarse_as_they_can():
    """Halving the samples ends with one character for all."""
    results = [Signals("", two_runs(), CAR)]
    data = signal_data(results, 1)
    assert sum(map(len, data.blocks)) < 0.1 * sum(map(len, signal_data(results).blocks))


def test_every_channel_is_plotted_once_also_one_of_no_topic():
    names = [*run_on_a_circle(5.0).channels, "stranger.voltage"]
    groups = groups_of(names)
    plotted = [
        curve["channel"] for group in groups for plot in group["plots"] for curve in plot["curves"]
    ]
    assert sorted(plotted) == sorted(names)
    assert [group["title"] for group in groups][-1] == "stranger"


def test_what_the_page_holds_are_the_signals(text: str):
    index = json.loads(re.search(r'id="index">(.*?)</script>', text, re.DOTALL).group(1))
    fast = index["runs"][1]
    assert fast["name"] == "fast_one"

    def values(of: dict) -> np.ndarray:
        block = re.search(rf'id="block-{of["block"]}">(.*?)</script>', text, re.DOTALL).group(1)
        return unpack(Packed(block, of["low"], of["step"], of["count"], of["planes"]))

    run = two_runs()["fast_one"]
    for name, truth in run.channels.items():
        of = fast["channels"][name]
        assert np.allclose(
            values(of), truth, rtol=1e-12, atol=0.5 * of["step"] + 1e-12, equal_nan=True
        )
    assert np.isnan(values(fast["channels"]["imu.yaw_rate"])[slice(*GAP)]).all()


def test_hash_command_differences_and_verdicts_stand_there(text: str):
    summary = summary_of(two_runs()).as_json()
    for words in (
        summary["signal_hash"],
        "scripts/run.sh circles --offline",
        "averaged",
        "reproduced",
        "never driven",
    ):
        assert words in text


def test_text_of_others_cannot_become_part_of_the_page(text: str):
    assert HOSTILE not in text
    assert "&lt;/script&gt;&lt;img src=x" in text


def test_nothing_is_loaded_from_anywhere(outline: Outline, text: str):
    for attributes in outline.all("script", "link", "img", "a", "iframe"):
        for place in (attributes.get("src"), attributes.get("href")):
            assert place is None or place.startswith(("data:", "#"))
    styles = re.search(r"<style>(.*?)</style>", text, re.DOTALL).group(1)
    assert "url(" not in styles and "@import" not in styles


def test_a_blind_reader_finds_the_way(outline: Outline):
    assert outline.all("html")[0]["lang"] == "en"
    levels = [int(tag[1]) for tag, _ in outline.tags if re.fullmatch("h[1-6]", tag)]
    assert levels.count(1) == 1
    assert all(after <= before + 1 for before, after in pairwise(levels))
    assert all(attributes["alt"] for attributes in outline.all("img"))
    assert all(attributes["scope"] in ("row", "col") for attributes in outline.all("th"))
    ids = [attributes["id"] for _, attributes in outline.tags if attributes.get("id")]
    assert len(ids) == len(set(ids))


@pytest.mark.parametrize("samples", [0, 1, 2])
def test_a_run_that_hardly_was_one_has_a_page_too(tmp_path: Path, samples: int):
    run = run_on_a_circle(5.0)
    short = Recording(
        run.time[:samples], {name: values[:samples] for name, values in run.channels.items()}
    )
    assert "</html>" in page_of(tmp_path, {"short": short}).read_text(encoding="utf-8")


def test_several_results_stand_on_one_page_side_by_side(tmp_path: Path):
    runs = two_runs()
    for name, (key, run), speed in zip("ab", runs.items(), (5.0, 7.5), strict=True):
        (tmp_path / name).mkdir()
        save(run, tmp_path / name / "signals.npz")
        metrics = {"speed": Metric(speed, "m/s")}
        write_summary(
            tmp_path / name / "summary.json",
            dataclasses.replace(
                summary_of({key: run}), metrics=metrics, command=f"run {name}"
            ).as_json(),
        )
    main(["report", str(tmp_path / "a"), str(tmp_path / "b"), "--out", str(tmp_path / "both.html")])
    text = (tmp_path / "both.html").read_text(encoding="utf-8")
    index = json.loads(re.search(r'id="index">(.*?)</script>', text, re.DOTALL).group(1))
    assert [run["name"] for run in index["runs"]] == ["a: slow", "b: fast_one"]
    assert "run a" in text and "run b" in text
    rows = re.findall(r"<tr><th scope=\"row\">speed</th>(.*?)</tr>", text, re.DOTALL)
    values = [re.findall(r'class="value">(.*?)</td>', row) for row in rows]
    assert values == [["5 m/s", "7.5 m/s"], ["5", "7.5", "2.5"]]  # in short, in full


@pytest.mark.parametrize(
    "content", [None, '{"study": "compare"}', '{"scenario": "a", "runs": {"../x": {}, "y": {}}}']
)
def test_a_folder_of_no_scenario_is_refused_in_one_line(tmp_path: Path, content: str | None):
    if content:
        (tmp_path / "summary.json").write_text(content)
    with pytest.raises(SystemExit) as ended:
        main(["report", str(tmp_path)])
    assert str(ended.value).startswith(f"error: {tmp_path}") and "\n" not in str(ended.value)


def test_series_of_a_study_are_signals_without_a_car(tmp_path: Path):
    time = np.arange(5.0)
    measured = {"a": {"time": time, "x": 2 * time, "peak": 3.0, "other": np.zeros(2)}, "b": {}}
    (signals,) = measured_signals(measured, {"x": "m"}, ["a"])
    assert list(signals.runs) == ["a"] and list(signals.runs["a"].channels) == ["x"]
    data = signal_data([signals])
    assert data.index["runs"][0]["car"] is None
    assert [group["title"] for group in data.index["groups"]] == ["measured"]
    assert [plot["unit"] for plot in data.index["groups"][0]["plots"]] == ["m"]
    assert data.index["runs"][0]["spun"]
    assert data.index["runs"][0]["stroke"] is None  # alone it needs no colour of its own
    assert measured_signals({"a": {"peak": 3.0}}, {}, ()) == ()


def test_there_is_a_way_to_the_car_only_where_there_is_a_car(tmp_path: Path):
    time = np.arange(5.0)
    for car in (CAR, None):
        page = tmp_path / f"{car is not None}.html"
        write_page(
            Page("a page", {}, (Signals("", {"a": Recording(time, {"pose.x": time})}, car),)), page
        )
        assert ('<a href="#view">' in page.read_text()) == (car is not None)


def test_every_parameter_of_a_node_stands_with_its_unit(text: str):
    cells = re.findall(
        r'<th scope="row">(drive|sensors.wheel_speed.noise|step)</th><td>[^<]*</td><td>([^<]*)</td>',
        text,
    )
    assert ("drive", "") in cells
    assert [
        unit_of("plant", name) for name in ("step", "sensors.wheel_speed.noise", "nothing")
    ] == ["s", "rad/s", ""]
    assert [unit_of("a_node", "step"), unit_of("*", "vehicle.mass")] == ["", "kg"]
    gains = {
        method: unit_of("electronic_differential", "gain", method)
        for method in ("steering_correction", "")
    }
    assert gains == {"steering_correction": "1/rad", "": ""}  # of another law it is in N m/rad


def test_what_is_vendored_is_what_its_readme_says():
    vendor = files(package).joinpath("vendor")
    sums = re.findall(r"\| (\S+) \| (\w{64}) \|", vendor.joinpath("README.md").read_text())
    assert len(sums) == 2
    for name, expected in sums:
        assert hashlib.sha256(vendor.joinpath(name).read_bytes()).hexdigest() == expected
    assert "MIT License" in vendor.joinpath("LICENSE.uPlot").read_text()
    version = re.search(r"uPlot ([\d.]+) by", vendor.joinpath("README.md").read_text()).group(1)
    assert f"(v{version})" in vendor.joinpath("uPlot.iife.min.js").read_text(encoding="utf-8")[:80]
    assert f"uPlot {version} " in files(package).joinpath("templates/details.html").read_text()


def test_differences_name_their_cause():
    values = (
        ("electronic_differential", "gamma", 6.0), ("*", "control_period", 0.005), ("*", "vehicle.mass", 1500.0)
    )  # fmt: skip
    found = differences(
        load_scenario("shchur2019", Overrides(values=values)), load_scenario("shchur2019")
    )
    ours = {
        (each.node, each.parameter): (each.value, each.instead_of)
        for each in found
        if each.by == "command line"
    }
    assert ours == {
        ("electronic_differential", "gamma"): (6.0, 5.0),
        (EVERY_NODE, "control_period"): (0.005, 0.01),
        (EVERY_NODE, "vehicle.mass"): (1500.0, 1400.0),
    }
    theirs = {(each.node, each.parameter) for each in found if each.by == "scenario"}
    assert ("electronic_differential", "method") in theirs and not any(
        "vehicle" in name for _, name in theirs
    )


def test_a_scenario_as_its_file_says_it_has_no_difference_of_the_command_line(tmp_path: Path):
    own = load_scenario("zhileykin2018")
    assert not [each for each in differences(own, own) if each.by == "command line"]
