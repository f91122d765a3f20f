"""The dashboard beside a run, in a headless Chromium.

What it shows, what it asks for, and how it ends.
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from helpers.accessibility import CONTROLS_WITHOUT_NAME, TEXT_OF_POOR_CONTRAST
from helpers.run_script import ENVIRONMENT, ROOT
from pictures.browser import FOUND, Browser

from ev_doors.commands import dashboard as command
from ev_doors.dashboard.server import listening
from ev_stack.recording.outcome import RunFailed

WORDS = "[...document.querySelectorAll('#words li')].map((line) => line.textContent)"
PERIOD = 0.01  # s, of control in shchur2019


class Dashboard(NamedTuple):
    """A dashboard with its run.

    Process, address of the page, and the file with what both print beside the address.
    """

    process: subprocess.Popen
    url: str
    output: Path


def started(folder: Path) -> Dashboard:
    """A long run with its dashboard."""
    words = [
        "--port",
        "0",
        "shchur2019",
        "--duration",
        "1000",
        "--no-record",
        "--no-report",
        "--out",
        str(folder / "run"),
    ]
    with (folder / "output.txt").open("w") as output:
        process = subprocess.Popen(
            [ROOT / "scripts" / "dashboard.sh", *words],
            env=ENVIRONMENT,
            stdout=subprocess.PIPE,
            stderr=output,
            text=True,
            start_new_session=True,
        )
    assert process.stdout is not None
    return Dashboard(
        process,
        process.stdout.readline().removeprefix("dashboard: ").strip(),
        folder / "output.txt",
    )


@pytest.fixture(scope="module")
def dashboards() -> Iterator[list[Dashboard]]:
    """Those that tests have started."""
    found: list[Dashboard] = []
    yield found
    for each in found:
        if each.process.poll() is None:
            each.process.send_signal(signal.SIGINT)
        each.process.communicate()


@pytest.fixture
def run(dashboards: list[Dashboard], tmp_path_factory: pytest.TempPathFactory) -> Dashboard:
    """The one that is under way, or another one where a test has ended it."""
    if not dashboards or dashboards[-1].process.poll() is not None:
        dashboards.append(started(tmp_path_factory.mktemp("dashboard")))
    return dashboards[-1]


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    browser = Browser(1300, 1000)
    yield browser
    browser.close()


@pytest.fixture
def page(run: Dashboard, browser: Browser) -> Browser:
    """The browser, at the page of the run."""
    if browser.run("location.href") != run.url:
        browser.open(run.url)
        browser.wait_for(
            "document.body && document.body.dataset.rows > 3 && shows.has('plant.real_time_factor')"
        )
        browser.wait_for("shows.has('electronic_differential.gamma')")
    return browser


def asked(page: Browser, request: dict, answer: str) -> str:
    """Send a request and return the line that answers it; `answer` tells it from others."""
    page.run(f"byId('words').replaceChildren(); request({json.dumps(request)})")
    expression = f"{WORDS}.find((line) => line.includes({json.dumps(answer)}))"
    page.wait_for(expression)
    return page.run(expression)


def set_to(value: object, node: str = "electronic_differential", name: str = "gamma") -> dict:
    return {"kind": "set", "node": node, "name": name, "value": value}


def needs_browser(test):
    return pytest.mark.slow(
        pytest.mark.skipif(FOUND is None, reason="no Chromium on this machine")(test)
    )


@needs_browser
def test_signals_car_and_parameters_are_seen(page):
    # those in sight
    page.wait_for("drawn().length > 1 && drawn().every((plot) => plot.chart.data[0].length > 3)")
    page.wait_for("document.querySelector('#cars canvas') && views[0].ready")
    assert page.run("document.querySelectorAll('#cars tr:first-child th').length") == 1 + 4
    slider = "document.querySelector('[data-name=gamma] input[type=range]')"
    assert page.run(f"[{slider}.min, {slider}.max].join()") == "0,10"
    assert page.run(f"({TEXT_OF_POOR_CONTRAST})()") == []
    assert page.run(f"({CONTROLS_WITHOUT_NAME})()") == []
    assert all(
        url.startswith(("http://127.0.0.1:", "ws://127.0.0.1:", "data:")) for url in page.requests
    )


@needs_browser
def test_a_slider_sets_the_parameter_of_the_node(page):
    page.run(
        "{ const slider = document.querySelector('[data-name=gamma] input[type=range]'); slider.value = 8;"
        " slider.dispatchEvent(new Event('input')); slider.dispatchEvent(new Event('change')); }"
    )
    page.wait_for(f"{WORDS}.includes('electronic_differential.gamma = 8.0')")


@needs_browser
@pytest.mark.parametrize(
    ("sent", "message"),
    [
        (
            set_to("-5"),
            "electronic_differential refuses: Parameter gamma out of range Min: 0.0, Max: 50.0",
        ),
        (set_to("nan"), "nan"),
        (set_to("much"), "electronic_differential.gamma: 'much' is refused, expected double"),
        (
            set_to("1", name="delta"),
            "electronic_differential.delta is refused: no such parameter in this graph",
        ),
        (
            {"kind": "time", "service": "stop"},
            "service 'stop' is refused, expected pause, resume, step, reset",
        ),
        ({"kind": "drive"}, "request 'drive' is refused, expected set or time"),
        ({"kind": "set"}, "a request of a page is refused: KeyError('node')"),
        ([], "a request of a page is refused, expected an object"),
    ],
)
def test_a_refusal_is_one_line_and_changes_nothing(page, sent, message):
    before = page.run("document.querySelector('[data-name=gamma] input').value")
    assert "\n" not in asked(page, sent, message)
    assert page.run("document.querySelector('[data-name=gamma] input').value") == before


@needs_browser
def test_time_stops_steps_and_begins_again(page):
    asked(page, {"kind": "time", "service": "pause"}, "paused at")
    page.wait_for("document.getElementById('state').textContent.startsWith('no new instant')")
    last = page.run("live.times.at(-1)")
    page.run("document.querySelector('[data-service=step]').click()")
    page.wait_for(f"live.times.at(-1) > {last}")
    assert page.run("live.times.at(-1)") == pytest.approx(last + PERIOD, abs=1e-9)
    page.run("document.querySelector('[data-service=reset]').click()")
    page.wait_for("live.times.at(-1) === 0")
    page.run("document.querySelector('[data-service=resume]').click()")
    page.wait_for("live.times.at(-1) > 0.1")
    assert page.run("Math.max(...live.times)") < last  # of the run before nothing is left


@needs_browser
def test_only_this_machine_under_its_own_name_may_ask(run):
    for path in ("", "live"):
        request = urllib.request.Request(run.url + path, headers={"Host": "elsewhere.example"})
        with pytest.raises(urllib.error.HTTPError, match="403"):
            urllib.request.urlopen(request)


@needs_browser
def test_interrupted_it_ends_in_one_line_with_the_run_and_the_page_says_so(run, page):
    assert page.complaints == []
    run.process.send_signal(signal.SIGINT)
    assert run.process.wait(20) == 130
    output = run.output.read_text()
    assert output.rstrip().splitlines()[-1] == "stopped"
    assert output.count("stopped") == 1
    page.wait_for("document.getElementById('state').textContent.startsWith('no connection')")
    with pytest.raises(ProcessLookupError):
        os.killpg(run.process.pid, 0)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["sweep"], "sweep is a study: its runs are not on DDS: name a scenario"),
        (["shchur2019", "--offline"], "--offline is refused: the page hears a run over DDS"),
        (["--seed", "2"], "'--seed' is not known; options of a run stand behind its SCENARIO"),
    ],
)
def test_words_without_sense_are_one_line(words, message, capsys):
    with pytest.raises(SystemExit) as ended:
        command.main(words)
    assert ended.value.code == 2
    assert capsys.readouterr().err.splitlines()[-1] == f"dashboard.sh: error: {message}"


@pytest.mark.parametrize(
    ("domains", "message"),
    [
        ([], "no run is under way: name a SCENARIO to drive one"),
        ([3, 4], "runs are under way in the domains 3, 4: ROS_DOMAIN_ID=N says which"),
    ],
)
def test_without_scenario_there_must_be_one_run(domains, message, monkeypatch):
    monkeypatch.delenv("ROS_DOMAIN_ID", raising=False)
    monkeypatch.setattr(command, "reserved_domains", lambda: domains)
    with pytest.raises(SystemExit) as ended:
        command.main([])
    assert ended.value.code == f"error: {message}"


def test_a_port_that_is_taken_is_refused_in_one_line():
    (first,) = listening(0)
    with (
        first,
        pytest.raises(
            RunFailed, match="is refused: Address already in use, expected a free one, or 0 for any"
        ),
    ):
        listening(first.getsockname()[1])


@pytest.mark.parametrize("port", ["-1", "65536", "80000", "1e3", "page", ""])
def test_a_port_that_is_none_is_refused_before_anything_is_started(port, capsys, monkeypatch):
    monkeypatch.setattr(command, "_run_of", lambda *_: pytest.fail("a run was started"))
    with pytest.raises(SystemExit) as ended:
        command.main([f"--port={port}", "shchur2019"])
    assert ended.value.code == 2
    last = capsys.readouterr().err.splitlines()[-1]
    assert last.endswith(
        f"argument --port: {port!r} is refused, expected a whole number from 0 to 65535"
    )


def test_a_port_that_is_taken_is_refused_before_a_run_is_started(monkeypatch):
    monkeypatch.setattr(command, "_run_of", lambda *_: pytest.fail("a run was started"))
    (first,) = listening(0)
    with first, pytest.raises(SystemExit) as ended:
        command.main(["--port", str(first.getsockname()[1]), "shchur2019"])
    assert "is refused: Address already in use" in ended.value.code


@needs_browser
@pytest.mark.weekly
def test_the_page_follows_the_runs_of_a_scenario_through_their_namespaces(tmp_path):
    """Each of several runs has a namespace, one after the other, and is over at its end."""
    words = ["--port", "0", "ge_ni2005", "--no-record", "--no-report", "--out", str(tmp_path)]
    process = subprocess.Popen(
        [ROOT / "scripts" / "dashboard.sh", *words],
        env=ENVIRONMENT,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    )
    browser = Browser(1300, 1000)
    try:
        browser.open(process.stdout.readline().removeprefix("dashboard: ").strip())
        seen = []
        for _ in range(2):
            known = json.dumps(seen)
            browser.wait_for(
                f"document.title.includes('/ev/') && !{known}.includes(document.title)"
            )
            seen.append(browser.run("document.title"))
            browser.wait_for(
                "live.times.length > 3 && document.querySelectorAll('#nodes [data-node=plant]').length == 1"
            )
            if len(seen) == 1:
                browser.wait_for("byId('state').textContent === 'The manoeuvre is over since 3 s.'")
        assert len({*seen}) == 2
    finally:
        browser.close()
        process.send_signal(signal.SIGINT)
        process.communicate()
