"""The live page and the report of one scenario, photographed: docs/images/live_page.png and report_page.png."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

from documentation.images import COLOURS
from ev_stack.interface.driving import run
from ev_stack.recording.recording import PAGE
from ev_stack.report.result import Result
from pictures.browser import FOUND, Browser
from pictures.fed_page import FedPage

SCENARIO = "double_lane_change"
SIZE = {"live_page": (1280, 800), "report_page": (1280, 800)}  # px
INSTANT = 4.0  # s, in the second lane


def save_pictures(folder: Path) -> None:
    """Drive the scenario and write both pictures; SystemExit, in one line, without a Chromium."""
    if FOUND is None:
        raise SystemExit(
            "error: pictures of pages need a Chromium on the PATH: apt install chromium"
        )
    driven = run(SCENARIO)
    for name, save in (("live_page", _save_live_page), ("report_page", _save_report)):
        with closing(Browser(*SIZE[name])) as browser:
            save(browser, driven, folder / f"{name}.png")


def _save_live_page(browser: Browser, driven: Result, path: Path) -> None:
    ((name, recording),) = driven.runs.items()
    (of_scenario,) = (each for each in driven.scenario.runs if each.name == name)
    with closing(FedPage()) as fed:
        browser.open(fed.pages.url)
        browser.wait_for(
            "document.readyState === 'complete' && socket.readyState === WebSocket.OPEN"
        )
        fed.begin(of_scenario, recording, f"EV Control Stack {of_scenario.namespace}")
        last = recording.time[len(recording.time) // 2 - 1]
        browser.wait_for(
            f"live.times.at(-1) >= {last} && drawn().length === 3 && views[0]?.ready && !waiting"
        )
        browser.run("came = performance.now(); tellState()")
        _photograph(browser, path)


def _save_report(browser: Browser, driven: Result, path: Path) -> None:
    with TemporaryDirectory() as folder:
        driven.save(folder)
        browser.open(Path(folder) / PAGE)
        browser.wait_for("document.body && document.body.dataset.loaded")
        browser.run(f"clock.set({INSTANT})")
        browser.wait_for("!waiting && drawn().length > 1")
        _photograph(browser, path)


def _photograph(browser: Browser, path: Path) -> None:
    """Behind the next frame, with a palette of few colours."""
    browser.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    browser.screenshot(path)
    Image.open(path).convert("RGB").quantize(COLOURS).save(path, optimize=True)
