"""Zhileykin & Eranosyan (2018), figs 3 to 5: which cars spin on the way into a bend on ice.

Runs: `rear_drive` with an open differential, the 4x4 by the law with `k05`, `k1` and, with eq 4 as
an equality, `equality`, `fixed_split` with a half for each axle, and `k1_estimated`, where the law
observes the slip angles instead of knowing them.

A source has its place ORDER, its PANELS, and in MEASURES the functions that published.csv names.
"""

from __future__ import annotations

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.zhileykin2018 import equations, measures
from ev_papers.zhileykin2018.grid import BY_LAW, LIMIT, REAR_DRIVE, SCENARIO
from ev_papers.zhileykin2018.shares import SHARES, SWING, reversals
from ev_stack.figures.other_axes import plan_view
from ev_stack.figures.panels import Curve, Panel, motion_panels, over_time, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.handling import peak_sideslip
from ev_stack.measures.metric import Metric, Parameters, Runs, channel, metric, run_named
from ev_stack.measures.registry import METRICS
from ev_stack.recording.recording import Recording
from ev_study.verdicts.measure import measures_of
from ev_study.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_study.verdicts.panels_page import PublishedPanel, scheme
from ev_study.verdicts.panels_page import over_time as drawn_over_time
from ev_study.verdicts.verdict import metrics_at_hand

ORDER = 4  # among the sources, in tables
MEASURES = measures_of(measures, equations)
PEAK_SIDESLIP = METRICS["peak_sideslip"].formula
ESTIMATED = "k1_estimated"  # observes the slip angles instead of knowing them
_BEND = (ScenarioNeed("zhileykin2018"),)


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Numbers judged on these runs alone; sideslip angles, final speeds, turn-arounds of shares."""

    def sideslip(name: str) -> float:
        return peak_sideslip(run_named(runs, name))

    def final_speed(name: str) -> float:
        return _speed(run_named(runs, name))[-1]

    found = metrics_at_hand(SCENARIO, SCENARIO, ScenarioRuns(runs, vehicle, parameters))
    for name in runs:
        found[f"peak_sideslip_{name}"] = metric(
            lambda name=name: sideslip(name), "rad", PEAK_SIDESLIP
        )
        found[f"holds_{name}"] = metric(
            lambda name=name: sideslip(name) < LIMIT, "1", "1: that is below 15 deg; else 0"
        )
        found[f"final_speed_{name}"] = metric(
            lambda name=name: final_speed(name), "m/s", "|V| in the end"
        )
    for name in (*BY_LAW, ESTIMATED):
        for share in SHARES:
            found[f"turn_arounds_{share}_{name}"] = metric(
                lambda name=name, share=share: reversals(run_named(runs, name), share),
                "1",
                f"how often the share turns round by more than {SWING:g} once the car is steered",
            )
    return found


def _speed(run: Recording) -> np.ndarray:
    """Speed along the path, whichever way the spinning car points, (n,) [m/s]."""
    return np.abs(motion.path_speed(run))


def panels(runs: Runs) -> dict[str, Panel]:
    """Panels of fig. 5 by their letter, for the runs by the law."""
    by_law = {name: run for name, run in runs.items() if name in BY_LAW}

    def of(title: str, share: str) -> Panel:
        return over_time(by_law, title, "share [1]", SHARES[share])

    return {
        "a": of("Front axle, h_n", "h_n"),
        "b": of("Rear left, h_2", "h_2"),
        "c": of("Rear right, h_4", "h_4"),
    }


def track(runs: Runs, name: str) -> Curve:
    """Path of the centre of mass, y over x [m], of a run (figs 3 and 4)."""
    run = run_named(runs, name)
    return Curve(channel(run, "pose.x"), channel(run, "pose.y"), readable(name))


def figures(runs: Runs) -> dict[str, Sheet]:
    """Paths (figs 3 and 4), shares (fig. 5), sideslip angle, yaw rate and speed."""
    shown = {name: run for name, run in runs.items() if name != ESTIMATED}
    tracks = [track(runs, name) for name in shown]
    beside = motion_panels(shown, "sideslip_angle", "yaw_rate")
    speed = over_time(shown, "Speed", "speed [m/s]", _speed)
    return {
        "fig3_fig4": plan_view("Path of the centre of mass", tracks),
        "fig5": Sheet([*panels(runs).values(), *beside, speed]),
    }


def _paths(figure: str, title: str, *names: str) -> PublishedPanel:
    def draw(driven: ScenarioRuns) -> Sheet:
        return plan_view(title, [track(driven.runs, name) for name in names])

    return PublishedPanel(figure, "", "Paths", (f"zhil.fig{figure}",), _BEND, draw)


def _share(letter: str, most: float) -> PublishedPanel:
    row = "Shares of the drive torque"
    draw = drawn_over_time(lambda driven: panels(driven.runs)[letter], ends=(0.0, most))
    return PublishedPanel("5", letter, row, (f"zhil.fig5{letter}",), _BEND, draw)


PANELS = (
    scheme("1", "the forces", "zhil.fig1"),
    scheme("2", "the driveline", "zhil.fig2"),
    _paths("3", "Path of the rear-driven car on ice", REAR_DRIVE),
    _paths("4", "Path of the 4x4 on ice", *BY_LAW),  # by each reading: the source names none
    _share("a", 0.5),
    _share("b", 1.0),
    _share("c", 1.0),
)
