"""Figures for print over any data.

Nothing beyond the edge, nothing over anything else, one unit for one quantity.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from argparse import Namespace
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers.layouts import flaws

from ev_core.methods.register import methods_of
from ev_papers.dissertation.studies.five_methods import efficiency_figure
from ev_papers.zhileykin2018 import grid
from ev_papers.zhileykin2018 import sweep as zhileykin2018_sweep
from ev_stack.figures.other_axes import timing_sheet
from ev_stack.figures.panels import Curve, Panel
from ev_stack.figures.saving import save_figures
from ev_stack.figures.sheets import COLUMN, TALLEST, WIDE, Sheet, printed
from ev_study.studies import asr_shootout, compare, faults, sweep
from ev_study.studies.run_study import arguments
from ev_study.studies.study import CaseResult

TIME = np.linspace(0.0, 12.0, 200)
LONG = "Torque of the wheel after the torque control, of the run with the longest name of all, front left"


def results_of(cases, measured) -> dict[str, CaseResult]:
    return {name: CaseResult(name, measured(number)) for number, name in enumerate(cases)}


def compared() -> dict[str, Sheet]:
    """Every electronic differential, two of them with the same signals."""

    def measured(number: int) -> dict:
        values = {name: np.sin(TIME + number // 2) for name in list(compare.CURVES)[2:]}
        return {"time": TIME, "x": 10.0 * TIME, "y": 0.1 * np.sin(TIME + number), **values}

    return compare.figures(
        Namespace(scenario="double_lane_change"), results_of(methods_of(compare.ROLE), measured)
    )


def swept(varied: int) -> dict[str, Sheet]:
    """Five metrics over one or two parameters of long names, two seeds."""
    words = (
        "electronic_differential.gamma=-0.001:0.0005:7",
        "plant.sensors.imu_acceleration.noise=1,2,5,10,100",
    )
    options = [word for each in words[:varied] for word in ("--vary", each)]
    given = arguments("sweep", ["double_lane_change", "--seeds", "2", *options])
    units = {
        f"front_left_largest_slip_energy_of_run_{n}": ("rad", "J", "1")[n % 3] for n in range(5)
    }

    def measured(number: int) -> dict:
        values = {name: number * 10.0 ** (n % 9 - 4) for n, name in enumerate(units)}
        return {"metrics": values, "units": units, "reasons": {}}

    return sweep.figures(given, results_of([case.name for case in sweep.cases(given)], measured))


def shootout() -> dict[str, Sheet]:
    given = Namespace(roads=None, controls=None)
    measured = {"trace_time": TIME, "trace_slip": np.sin(TIME)}
    return asr_shootout.figures(
        given, results_of([case.name for case in asr_shootout.cases(given)], lambda n: measured)
    )


def with_faults() -> dict[str, Sheet]:
    given = Namespace(laws=None, faults=None)
    measured = {"time": TIME, "deviation": np.sin(TIME), "yaw_rate": 100.0 * np.cos(TIME)}
    return faults.figures(
        given, results_of([case.name for case in faults.cases(given)], lambda n: measured)
    )


def largest_sideslip() -> dict[str, Sheet]:
    names = [
        grid.name_of(control, force, angle)
        for control in grid.SWEPT
        for force in grid.FORCES
        for angle in grid.ANGLES
    ]
    (sheet,) = zhileykin2018_sweep.figures(
        Namespace(), results_of(names, lambda n: {"peak_sideslip": 0.01 * (n % 300)})
    ).values()
    return {"sideslip": replace(sheet, panels=sheet.panels[:2])}


def efficiencies() -> dict[str, Sheet]:
    titles = dict(
        enumerate(("by torque", "by power of the motor", "as printed", "free", "by speed"), 1)
    )
    points = {
        name: {n: [0.5 + 0.05 * n, 0.6] for n in titles}
        for name in ("pulse", "imposed_speed", "pid")
    }
    return {"wheel_efficiency": efficiency_figure(points, dict.fromkeys(titles, 0.8), titles)}


def timing() -> dict[str, Sheet]:
    counted = {"edges": [1e-4, 1e-3, 1e-2], "counts": [3, 200, 10000, 1]}
    arrival = {f"steering_column/state/{n}": counted for n in range(6)}
    of_run = {"period": counted, "lateness": counted, "arrival": arrival}
    return {"timing": timing_sheet({"launch_with_a_long_name": of_run})}


def long_words() -> dict[str, Sheet]:
    """Titles, names, reasons and ordinates wider than a column, and a word without a blank."""
    curves = [Curve(TIME, 1e8 * np.sin(TIME + n), f"{LONG} {n}") for n in range(3)]
    reason = f"not measured: {LONG}, for nothing of it was recorded"
    panels = [
        Panel(LONG, "torque of the wheel after the control [N m]", curves),
        Panel("x" * 120, "y [1]", curves),
        Panel(LONG, "a rather long name of a quantity [1]", note=reason),
    ]
    return {"words": Sheet(panels * 3)}


STUDIES = {
    "compare": compared,
    "sweep of one": lambda: swept(1),
    "sweep of two": lambda: swept(2),
    "asr_shootout": shootout,
    "faults": with_faults,
    "zhileykin2018_sweep": largest_sideslip,
    "five_methods": efficiencies,
    "timing": timing,
    "long words": long_words,
}


@pytest.mark.parametrize(
    ("study", "width"),
    [*((study, COLUMN) for study in STUDIES), ("sweep of two", WIDE), ("compare", WIDE)],
)
@pytest.mark.sampled
def test_print_has_no_text_beyond_the_edge_or_over_another(study: str, width: float):
    """A sweep of two parameters fits: bars beside their maps, whole titles."""
    found = {
        name: flaws(figure, width) for name, figure in printed(STUDIES[study](), width).items()
    }
    assert found and {name: of for name, of in found.items() if of} == {}


def test_a_colour_bar_stands_beside_its_map():
    """It lies to the right of its map, as high as it, and closer than the next map."""
    (figure, *_) = printed(swept(2), WIDE).values()
    figure.draw_without_rendering()
    for axes in figure.axes:
        if bar := axes.collections and axes.collections[0].colorbar:
            of_map, of_bar = axes.get_position(), bar.ax.get_position()
            assert of_map.y0 == pytest.approx(of_bar.y0, abs=0.01) and of_map.y1 == pytest.approx(
                of_bar.y1, abs=0.01
            )
            assert 0.0 < of_bar.x0 - of_map.x1 < 0.05
            assert bar.ax.get_ylabel().endswith("]")


@pytest.mark.skipif(not shutil.which("pdftotext"), reason="pdftotext of poppler is not installed")
def test_words_of_a_pdf_stand_on_its_page(tmp_path: Path):
    for path in save_figures(printed(compared(), COLUMN), tmp_path, ["pdf"]):
        text = subprocess.run(
            ["pdftotext", "-bbox", path, "-"], capture_output=True, text=True, check=True
        ).stdout
        wide, tall = map(
            float, re.search(r'<page width="([\d.]+)" height="([\d.]+)">', text).groups()
        )
        assert wide == pytest.approx(72 * COLUMN) and tall <= 72 * TALLEST
        words = re.findall(
            r'<word xMin="([-\d.]+)" yMin="([-\d.]+)" xMax="([-\d.]+)" yMax="([-\d.]+)">', text
        )
        assert len(words) > 20
        for left, top, right, bottom in (map(float, word) for word in words):
            assert left >= 0.0 and top >= 0.0 and right <= wide and bottom <= tall
