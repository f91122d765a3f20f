"""The live page of every scenario in a headless Chromium.

A lesson at 1280x800 and on a phone, up to its end.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from typing import Any

import pytest
from pictures.browser import FOUND, Browser
from pictures.fed_page import FedPage

from ev_msgs_py.contract.roles import MASTER
from ev_stack.recording.recording import Recording
from ev_stack.running.offline import drive_offline
from ev_stack.scenarios.files import scenario_names
from ev_stack.scenarios.scenario import Overrides, Run, load_scenario

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(FOUND is None, reason="no Chromium on this machine"),
]
SECONDS = 0.1  # that are driven: ten rows at least
SCREEN, PHONE = (1280, 800), (390, 844)
NUMBER = count()  # of the graph that is shown, so that no title comes twice
STATE = "came = performance.now(); tellState(); byId('state').textContent"
PLACES = """[...document.querySelectorAll('#lesson .parameter, #cars canvas, #beside .uplot')].map((each) => {
  const box = each.getBoundingClientRect();
  return [box.left, box.right, box.top, box.bottom];
})"""
SLIDERS = """[...document.querySelectorAll('#lesson .parameter')].map((row) => {
  const slider = row.querySelector('input[type=range]');
  return [row.querySelector('label').textContent, ...['min', 'value', 'max'].map((name) => Number(slider[name]))];
})"""


@pytest.fixture(scope="module")
def fed() -> Iterator[FedPage]:
    fed = FedPage()
    yield fed
    fed.close()


@pytest.fixture(scope="module")
def window() -> Iterator[Browser]:
    window = Browser(*SCREEN)
    yield window
    window.close()


@pytest.fixture
def browser(window: Browser, fed: FedPage) -> Browser:
    """The window at the page of the server, brought back from where a test has left it."""
    if window.run("location.href") != fed.pages.url:
        go_to(window, fed)
        window.complaints.clear()
    return window


def go_to(browser: Browser, fed: FedPage) -> None:
    """Open the page of a server, and wait until it is connected."""
    browser.open(fed.pages.url)
    here = f"location.href === '{fed.pages.url}' && document.readyState === 'complete'"
    browser.wait_for(f"{here} && socket.readyState === WebSocket.OPEN")


def present(run: Run, names: tuple[str, ...]) -> dict[str, Any]:
    """The numbers of a lesson that a run has, and their values."""
    values = {
        f"{node}.{key}": value
        for node, each in run.configurations.items()
        for key, value in each.values().items()
    }
    return {name: values[name] for name in names if name in values}


def short(name: str, over: float) -> tuple[Run, tuple[str, ...]]:
    """The run of a scenario that has most of the lesson, made short, and the lesson.

    It is over at this time [s].
    """
    scenario = load_scenario(name, Overrides(duration=SECONDS))
    lesson = scenario.parameters.lesson
    run = max(scenario.runs, key=lambda each: len(present(each, lesson)))
    plant = run.configurations[MASTER].changed({"manoeuvre_end": over})
    return replace(run, configurations={**run.configurations, MASTER: plant}), lesson


def shown(fed: FedPage, browser: Browser, run: Run, recording: Recording | None = None) -> None:
    """A run, half of it driven, or what was recorded."""
    browser.resize(*SCREEN)
    title = f"EV Control Stack {next(NUMBER)}"
    fed.begin(run, recording or drive_offline(run).recording, title)
    browser.wait_for(f"document.title === '{title}' && live.times.length > 3")
    browser.wait_for("document.querySelectorAll('#beside .uplot').length === 3 && views[0]?.ready")


@pytest.mark.sampled
@pytest.mark.parametrize("name", scenario_names())
def test_sliders_plots_and_car_stand_beside_each_other(fed, browser, name):
    run, lesson = short(name, SECONDS)
    shown(fed, browser, run)
    values = present(run, lesson)
    sliders = browser.run(SLIDERS)
    assert [
        label.replace("\u200b", "").replace(": ", ".").replace(" ", "_") for label, *_ in sliders
    ] == [*values]
    for (_, least, at, most), value in zip(sliders, values.values(), strict=True):
        assert least <= at <= most and at == pytest.approx(value)
        assert most - least <= 2.0 * (abs(value) or 1.0) * (1 + 1e-12)
    places = browser.run(PLACES)
    assert len(places) == len(sliders) + 1 + 3
    bar = browser.run("byId('bar').getBoundingClientRect().top")
    assert all(
        left >= 0 and right <= SCREEN[0] and top >= 0 and bottom <= bar
        for left, right, top, bottom in places
    )
    assert browser.run("drawn().length") == 3 and browser.run("drawn()[0].chart.data[0].length") > 3
    of_car = browser.run(
        "[...document.querySelectorAll('#nodes [data-name^=\"vehicle.\"]')].map((row) => row.dataset.name)"
    )
    assert len(of_car) == len({*of_car}) > 50
    assert browser.run(STATE) == f"running, {SECONDS:g} s in all"
    fed.end()
    browser.wait_for(f"live.times.at(-1) > {SECONDS} - 1e-9")
    assert browser.run(STATE) == f"The manoeuvre is over since {SECONDS:g} s."
    browser.resize(*PHONE)
    browser.wait_for(f"drawn().every((plot) => plot.chart.width < {PHONE[0]})")
    assert (
        browser.run("document.documentElement.scrollWidth - document.documentElement.clientWidth")
        == 0
    )
    lefts, _, tops, bottoms = zip(*browser.run(PLACES), strict=True)
    assert max(lefts) - min(lefts) < 4 and all(
        top >= before for before, top in zip(bottoms, tops[1:], strict=False)
    )
    assert browser.complaints == []


def test_a_run_may_last_longer_than_the_manoeuvre(fed, browser):
    run, _ = short("step_steer", SECONDS / 2)
    shown(fed, browser, run)
    fed.end()
    browser.wait_for(f"live.times.at(-1) > {SECONDS} - 1e-9")
    assert (
        browser.run(STATE)
        == "The manoeuvre is over since 0.05 s; the car drives on up to 0.1 s, Reset begins again."
    )
    paused = browser.run(STATE.replace("performance.now()", "performance.now() - 7000", 1))
    assert paused == (
        "The manoeuvre is over since 0.05 s; no new instant for 7 s: paused, ended or held up, Reset begins again."
    )


def test_a_slider_goes_on_about_the_value_at_its_end(fed, browser):
    """Gamma of 5 slides from 0 to 10.

    At 10, to where it was drawn, from 0 to 20; never beyond what is allowed, 50.
    """
    run, _ = short("shchur2019", SECONDS)
    shown(fed, browser, run)
    slider = "document.querySelector('#lesson [data-name=gamma] input[type=range]')"
    ends = []
    for value in (5, 10, 20, 40, 1, 0):
        fed.tell(
            {
                "kind": "parameter",
                "node": "electronic_differential",
                "name": "gamma",
                "value": value,
            }
        )
        browser.wait_for(f"{slider}.value === '{value}'")
        ends.append(browser.run(f"[{slider}.min, {slider}.max].join()"))
    assert ends == ["0,10", "0,20", "0,40", "0,50", "0,2", "0,1"]
    browser.run(f"{slider}.value = 0.5; {slider}.dispatchEvent(new Event('change'))")
    fed.wait_for_request(
        {"kind": "set", "node": "electronic_differential", "name": "gamma", "value": "0.5"}
    )


def test_a_node_that_believes_in_another_car_shows_where_it_differs(fed, browser):
    run, _ = short("shchur2019", SECONDS)
    law = run.configurations["electronic_differential"].changed({"vehicle.mass": 1234.0})
    believing = replace(run, configurations={**run.configurations, "electronic_differential": law})
    shown(fed, browser, believing, drive_offline(run).recording)
    found = "[...document.querySelectorAll('#nodes [data-node=electronic_differential] [data-name^=\"vehicle.\"]')]"
    assert browser.run(
        f"{found}.map((row) => row.dataset.name + ' ' + row.querySelector('input').value)"
    ) == ["vehicle.mass 1234"]


def test_the_page_says_with_what_it_has_lost_the_connection(browser):
    """A run that was over and one that was not have lines of their own."""
    for over, state in (
        (SECONDS, f"The manoeuvre is over since {SECONDS:g} s. The dashboard has ended with it."),
        (2.0, "no connection: the run or the dashboard has ended; trying again"),
    ):
        fed = FedPage()
        go_to(browser, fed)
        run, _ = short("shchur2019", over)
        shown(fed, browser, run)
        fed.end()
        browser.wait_for(f"live.times.at(-1) > {SECONDS} - 1e-9")
        fed.close()
        browser.wait_for(f"byId('state').textContent === '{state}'")
