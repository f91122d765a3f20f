"""report.html in a headless Chromium.

It draws, obeys pointer and keyboard, plays, and says nothing is wrong.
"""

from __future__ import annotations

import dataclasses
import re
import subprocess
import zlib
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers.accessibility import CONTROLS_WITHOUT_NAME, TEXT_OF_POOR_CONTRAST
from helpers.pages import CAR, GAP, RADIUS, page_of, run_on_a_circle, summary_of, two_runs
from pictures.browser import FOUND, Browser

from ev_stack.figures.strokes import strokes_of
from ev_stack.measures.metric import Metric, Reference, within
from ev_stack.recording.recording import Recording
from ev_stack.report.page.writing import Page, Signals, write_page

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(FOUND is None, reason="no Chromium on this machine: apt install chromium"),
]

HELPERS = """
const holderOf = (channel) => [...plots.values()].find((plot) => plot.curves[0].channel === channel);
const sightOf = (channel) => { holderOf(channel).holder.scrollIntoView({ block: "center" }); };
const shown = (channel) => holderOf(channel).chart;
const legendOf = (channel) => [...shown(channel).root.querySelectorAll(".u-value")].map((cell) => cell.textContent);
"""
WIDER_BY_LONG_NAMES = """(() => {
  const added = [...document.querySelectorAll("h1, h2, h3, h4, p, dd, summary, figcaption")].map(
    (each) => each.appendChild(new Text("parameters_of_a_run_whose_name_is_longer_than_a_phone_is_wide")));
  const { scrollWidth, clientWidth } = document.documentElement;
  for (const each of added) each.remove();
  return scrollWidth - clientWidth;
})()"""
CHANNELS = 20  # of the page that is printed: more than are in sight
BLUE = rb"\b0 \.447\d* \.698\d* RG"  # the first stroke of plots.js, #0072B2, in a PDF
TORQUE, YAW_RATE, WHEEL = (
    "driver.command.drive_torque",
    "imu.yaw_rate",
    "wheel_states.velocity.front_left",
)


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    browser = Browser()
    try:
        browser.open(page_of(tmp_path_factory.mktemp("page"), two_runs()))
        browser.wait_for("document.body && document.body.dataset.ready")
        browser.run(HELPERS)
        yield browser
    finally:
        browser.close()


def look_at(browser: Browser, channel: str) -> None:
    browser.run(f"sightOf('{channel}')")
    browser.wait_for(f"shown('{channel}')")


def show(browser: Browser, first: int, second: int, how: str) -> None:
    browser.run(
        f"bar.first.value = {first}; bar.second.value = {second}; bar.how.value = '{how}'; show()"
    )


def strokes_on(browser: Browser, channel: str) -> list[list[str]]:
    """Colour and dashes of each curve in the plot of a channel, as they were drawn."""
    assert browser.run(
        f"shown('{channel}').series.slice(1).every((series, n) => {{"
        f"const [c, d] = holderOf('{channel}').curves[n].stroke;"
        "return series.stroke() === c && series.dash.join() === DASHES[d].join(); })"
    )
    return browser.run(f"holderOf('{channel}').curves.map((curve) => curve.stroke)")


def place_on(browser: Browser, channel: str, time: float) -> dict[str, Any]:
    """Place of an instant on the screen, in the plot of a channel."""
    return browser.run(
        f"(() => {{ const chart = shown('{channel}'), box = chart.over.getBoundingClientRect();"
        f"return {{ x: box.left + chart.valToPos({time}, 'x'), y: box.top + box.height / 2 }}; }})()"
    )


def test_the_cursor_of_one_plot_is_that_of_all_and_of_the_cars(browser: Browser):
    show(browser, 0, 1, "beside")
    look_at(browser, TORQUE)
    browser.mouse("mouseMoved", **place_on(browser, TORQUE, 6.0))
    now = browser.run("clock.now")
    assert now == pytest.approx(6.0, abs=0.03)  # a pixel is 10 s by 500
    time, torque = browser.run(f"legendOf('{TORQUE}')")
    assert float(time.split()[0]) == pytest.approx(now, abs=0.01)
    assert float(torque) == pytest.approx(5.0 * float(time.split()[0]), rel=1e-4)
    # The other run is drawn beside it with the same ordinate
    limits = browser.run(
        f"[...plots.values()].filter((plot) => plot.curves[0].channel === '{TORQUE}')"
        ".map((plot) => [plot.chart.scales.y.min, plot.chart.scales.y.max])"
    )
    assert len(limits) == 2 and limits[0] == limits[1] and limits[0][1] > 70.0
    browser.wait_for("!waiting")
    where = browser.run("views[0].where.textContent")
    heading = 5.0 / RADIUS * round(now, 2)
    assert f"x {RADIUS * np.sin(heading):.1f}" in where


def test_dragging_zooms_all_plots_and_two_clicks_show_all(browser: Browser):
    show(browser, 0, -1, "beside")
    look_at(browser, TORQUE)
    begin, end = place_on(browser, TORQUE, 2.0), place_on(browser, TORQUE, 4.0)
    browser.mouse("mouseMoved", **begin)
    browser.mouse("mousePressed", **begin, button="left", buttons=1, clickCount=1)
    browser.mouse("mouseMoved", **end, button="left", buttons=1)
    browser.mouse("mouseReleased", **end, button="left", buttons=0, clickCount=1)
    assert browser.run("clock.range") == pytest.approx([2.0, 4.0], abs=0.03)
    look_at(browser, YAW_RATE)  # which was not drawn then
    browser.wait_for(f"Math.abs(shown('{YAW_RATE}').scales.x.min - 2) < 0.03")
    browser.run("clock.all()")
    browser.wait_for(f"shown('{YAW_RATE}').scales.x.max === clock.end")


def test_a_gap_is_a_gap(browser: Browser):
    show(browser, 1, -1, "beside")
    look_at(browser, YAW_RATE)
    nulls = browser.run(
        f"shown('{YAW_RATE}').data[1].flatMap((value, n) => value === null ? [n] : [])"
    )
    assert nulls == [*range(*GAP)]
    browser.run("clock.set(4.5)")
    assert browser.run(f"legendOf('{YAW_RATE}')[1]") == "–"


def test_the_difference_is_second_minus_first(browser: Browser):
    show(browser, 0, 1, "difference")
    look_at(browser, TORQUE)
    ours = browser.run(f"Array.from(shown('{TORQUE}').data[1])")
    # (7 - 5) t, each rounded to 70 N m over 2^24
    assert np.abs(np.array(ours) - 2.0 * two_runs()["slow"].time).max() < 1e-5


def test_over_each_other_both_runs_are_in_one_plot_each_in_its_colour(browser: Browser):
    """That of the figures.

    Wheels of one run have the colours of their places, those of two runs only their dashes.
    """
    of_runs = [list(stroke) for name, stroke in strokes_of(["slow", "fast one"]).items() if name]
    assert browser.run("INDEX.runs.map((run) => run.stroke)") == of_runs
    colours = [colour for colour, _ in of_runs]
    show(browser, 0, 1, "over")
    look_at(browser, TORQUE)
    assert browser.run(f"shown('{TORQUE}').series.map((series) => series.label)") == [
        "time",
        "slow",
        "fast one",
    ]
    assert strokes_on(browser, TORQUE) == of_runs
    look_at(browser, WHEEL)
    over = strokes_on(browser, WHEEL)
    assert [colour for colour, _ in over] == [colours[0]] * 4 + [colours[1]] * 4
    assert [dashes for _, dashes in over] == ["-", "--", ":", "-."] * 2
    show(browser, 1, -1, "beside")
    look_at(browser, TORQUE)
    look_at(browser, WHEEL)
    assert strokes_on(browser, TORQUE) == of_runs[1:]
    assert strokes_on(browser, WHEEL) == browser.run("STROKES")


def test_wheels_of_one_run_have_dashes_and_those_of_two_also_colours(tmp_path: Path):
    """One legend names both."""
    curves = ("wheel_states.velocity", "imu.yaw_rate")
    for count in (1, 2):
        runs = dict(list(two_runs().items())[:count])
        page = tmp_path / f"{count}.html"
        write_page(Page("wheels", {}, (Signals("", runs, None, curves=curves),)), page)
        first = Browser()
        try:
            first.open(page)
            first.wait_for("document.body && document.body.dataset.ready")
            of_wheels, alone = first.run(
                "[...plots.values()].filter((plot) => plot.small).map((plot) => plot.curves.map((curve) => curve.stroke))"
            )
            legend = first.run(
                "[...document.querySelectorAll('#legend li')].map((each) => each.textContent.trim())"
            )
            strokes = first.run("STROKES")
        finally:
            first.close()
        assert len(alone) == count and legend[-4:] == [
            "front left",
            "front right",
            "rear left",
            "rear right",
        ]
        assert [dashes for _, dashes in of_wheels] == ["-", "--", ":", "-."] * count
        if count == 1:
            assert of_wheels == strokes
        else:
            colours = [colour for colour, _ in alone]
            assert len(set(colours)) == 2 and legend[:2] == ["slow", "fast one"]
            assert [colour for colour, _ in of_wheels] == [colours[0]] * 4 + [colours[1]] * 4


def test_time_runs_and_the_car_moves(browser: Browser):
    show(browser, 0, -1, "beside")
    browser.run("document.getElementById('view').scrollIntoView(); clock.set(0)")
    before = browser.run("views[0].canvas.toDataURL()")
    browser.run("bar.play.click()")
    assert browser.run("bar.play.textContent") == "Pause"
    browser.wait_for("clock.now > 0.2")
    browser.run("bar.play.click()")
    assert browser.run("[bar.play.textContent, bar.play.getAttribute('aria-pressed')]") == [
        "Play",
        "false",
    ]
    browser.wait_for("!waiting")
    assert browser.run("views[0].canvas.toDataURL()") != before


def test_front_wheels_turn_and_forces_have_arrows(browser: Browser):
    """Ink of the arrows' colour is where there are forces.

    The first row of the table is the inner front wheel.
    """
    show(browser, 0, -1, "beside")
    browser.run("document.getElementById('view').scrollIntoView(); clock.set(1.5)")
    browser.wait_for("!waiting")
    inner, outer = browser.run(
        "views[0].cells.slice(0, 2).map((row) => Number(row[0].textContent))"
    )
    assert inner > np.degrees(0.1 * np.sin(1.5)) > outer > 0.0  # Ackermann, to the left
    reds = browser.run(
        "(() => { const c = views[0].canvas, d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;"
        "let n = 0; for (let i = 0; i < d.length; i += 4) if (d[i] > 180 && d[i + 1] < 60) n++; return n; })()"
    )
    assert reds > 0


def test_the_keyboard_moves_time_by_one_sample_and_hides_a_curve(browser: Browser):
    show(browser, 0, -1, "beside")
    browser.run("clock.set(3); bar.time.focus()")
    browser.press("ArrowRight", 39)
    assert browser.run("clock.now") == pytest.approx(3.01)
    assert browser.run("bar.time.getAttribute('aria-valuetext')") == "3.01 seconds"
    look_at(browser, TORQUE)
    browser.run(f"shown('{TORQUE}').root.querySelectorAll('th')[1].focus()")
    browser.press("Enter", 13)
    assert browser.run(f"shown('{TORQUE}').series[1].show") is False


def test_what_the_script_adds_can_be_read_and_named(browser: Browser):
    """Contrast by WCAG 2.2: 4.5 to 1 for text.

    Every control has a name, every heading follows its parent.
    """
    show(browser, 0, 1, "beside")
    look_at(browser, TORQUE)
    assert browser.run(f"({TEXT_OF_POOR_CONTRAST})()") == []
    assert browser.run(f"({CONTROLS_WITHOUT_NAME})()") == []
    levels = browser.run(
        "[...document.querySelectorAll('h1,h2,h3,h4')].map((each) => Number(each.tagName[1]))"
    )
    assert all(after <= before + 1 for before, after in pairwise(levels))


def test_a_run_that_has_spun_does_not_set_the_limits(browser: Browser):
    """The torque of the slow run ends at 50 N m, that of the other at 70 N m."""
    limits = []
    for spun in ("false", "true"):
        browser.run(f"INDEX.runs[1].spun = {spun}; 0")
        show(browser, 0, 1, "over")
        look_at(browser, TORQUE)
        limits.append(browser.run(f"shown('{TORQUE}').scales.y.max"))
        labels = browser.run(f"shown('{TORQUE}').series.map((series) => series.label)")
    browser.run("INDEX.runs[1].spun = false")
    assert limits[0] > 70.0 and 50.0 < limits[1] < 60.0
    assert labels == ["time", "slow", "fast one (spun)"]


def test_every_quantity_and_the_time_have_a_unit_and_every_link_leads_to_what_is_seen(
    browser: Browser,
):
    show(browser, 0, -1, "beside")
    look_at(browser, TORQUE)
    headings = browser.run(
        "[...document.querySelectorAll('.quantity h4')].map((each) => each.firstChild.textContent)"
    )
    assert len(headings) > 20 and [each for each in headings if "[" not in each] == []
    assert browser.run(f"shown('{TORQUE}').axes[0].label") == "time [s]"
    links = "[...document.querySelectorAll('a[href]')].filter((each) => each.checkVisibility())"
    assert (
        browser.run(
            f"{links}.filter((each) => !document.querySelector(each.hash)?.checkVisibility()).length"
        )
        == 0
    )
    browser.run("INDEX.runs[0].cars = INDEX.runs[0].car; INDEX.runs[0].car = null; show()")
    browser.wait_for("document.getElementById('view').hidden")
    assert browser.run(f"{links}.some((each) => each.hash === '#view')") is False
    browser.run("INDEX.runs[0].car = INDEX.runs[0].cars; show()")


@pytest.mark.parametrize(("width", "height"), [(1280, 800), (390, 844)])
@pytest.mark.parametrize("count", [1, 2, 6])
def test_car_curves_and_metrics_are_the_first_screen(
    tmp_path: Path, width: int, height: int, count: int
):
    """They stand above the bar, with all that is drawn and one legend, and nothing overflows.

    Also with more metrics than there is room for, some of which failed.
    """
    runs = {f"law_of_a_long_name_{n}": run_on_a_circle(5.0 + n) for n in range(count)}
    wrong = Reference(4.0, within(4.0, relative=0.01), "eq 1")
    metrics = {
        f"metric_of_a_long_name_{n}_{run}": Metric(
            0.1 * n, "m/(s^2 rad)", wrong if n == 9 else None
        )
        for n in range(20)
        for run in runs
    }
    summary = dataclasses.replace(summary_of(runs), metrics=metrics).as_json()
    page = tmp_path / "page.html"
    write_page(Page("laws", {"": summary}, (Signals("", runs, CAR),)), page)
    first = Browser(width, height)
    try:
        first.open(page)
        first.wait_for("document.body && document.body.dataset.ready")
        first.wait_for(
            "[...plots.values()].filter((plot) => plot.small && plot.chart).length === 4"
        )
        places = first.run(
            "['#view canvas', '#curves', '#judged', '#bar'].flatMap((each) => [...document.querySelectorAll(each)])"
            ".map((each) => each.getBoundingClientRect()).map(({ left, right, top, bottom }) => ({ left, right, top, bottom }))"
        )
        *shown, bar = places
        assert len(shown) == min(count, 2) + 2
        for place in shown:
            assert 0.0 <= place["left"] < place["right"] <= width
            assert 0.0 < place["top"] < place["bottom"] <= bar["top"]
        small = "[...plots.values()].filter((plot) => plot.small)"
        heights = first.run(f"{small}.map((plot) => plot.chart.over.clientHeight)")
        assert min(heights) > 60  # room for some five ticks of 12 px
        assert first.run(f"{small}.map((plot) => plot.curves.length)") == [count] * 4
        legend = runs if count > 1 else {}
        assert first.run("document.querySelectorAll('#judged .failed').length") == count + 1
        assert first.run(
            "[...document.querySelectorAll('#legend li')].map((each) => each.textContent.trim())"
        ) == [name.replace("_", " ") for name in legend]
        angle = runs["law_of_a_long_name_0"].channels["steering_column.state.angle"][100]
        # Within half a step of 24 bits over a range of 10 rad
        assert first.run(f"{small}[0].series[0][100]") == pytest.approx(np.degrees(angle), abs=2e-5)
        assert not first.run("document.documentElement.scrollWidth > innerWidth")
        assert first.run(f"({TEXT_OF_POOR_CONTRAST})()") == []
        assert first.run(f"({CONTROLS_WITHOUT_NAME})()") == []
        assert first.complaints == []
    finally:
        first.close()


@pytest.mark.parametrize("width", [1280, 390])
def test_every_table_fits_its_screen(browser: Browser, width: int):
    """A table may scroll within its place on a phone, the page may not."""
    browser.resize(width, 900)
    show(browser, 0, 1, "beside")
    browser.run("for (const each of document.querySelectorAll('details')) each.open = true")
    over = "(each) => each.scrollWidth > each.clientWidth"
    assert not browser.run(f"({over})(document.documentElement)"), browser.run(
        "[...document.querySelectorAll('main *')].filter((each) => each.getBoundingClientRect().right > innerWidth)"
        ".map((each) => each.outerHTML.slice(0, 100)).slice(0, 20)"
    )
    assert browser.run(WIDER_BY_LONG_NAMES) == 0
    if width == 1280:
        wide = f"[...document.querySelectorAll('.scroll')].filter({over}).map((each) => each.outerHTML.slice(0, 200))"
        assert browser.run(wide) == []
    browser.run("for (const each of document.querySelectorAll('details')) each.open = false")
    browser.resize(1300, 900)


def test_what_was_never_in_sight_is_printed(tmp_path: Path):
    """A printer asks when the page is loaded, which it is with all samples.

    Each curve is stroked in its colour.
    """
    time = np.linspace(0.0, 1.0, 11)
    run = Recording(time, {f"measured.channel_{n}": n * time for n in range(1, CHANNELS + 1)})
    write_page(Page("printed", {}, (Signals("", {"run": run}, None),)), tmp_path / "page.html")
    words = [
        "--headless=new",
        "--no-sandbox",
        "--disable-gpu",
        f"--user-data-dir={tmp_path}/profile",
    ]
    printed, page = tmp_path / "page.pdf", (tmp_path / "page.html").as_uri()
    subprocess.run(
        [FOUND, *words, f"--print-to-pdf={printed}", page], check=True, capture_output=True
    )
    streams = re.findall(
        rb"/FlateDecode.*?stream\n(.*?)\nendstream", printed.read_bytes(), re.DOTALL
    )
    drawn = b"\n".join(zlib.decompressobj().decompress(stream) for stream in streams)
    # The frame in its legend, and the curve of each plot; those that were on the screen may have
    # become images.
    assert len(re.findall(BLUE, drawn)) > 1.5 * CHANNELS


def test_nothing_was_complained_of_and_nothing_fetched(browser: Browser):
    assert browser.complaints == []
    assert [
        url for url in browser.requests if not url.startswith(("file:", "data:", "blob:"))
    ] == []
