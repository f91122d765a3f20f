"""Drive force by steering angle for all four controls of the scenario zhileykin2018: who spins, who holds."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ev_msgs_py.contract.roles import MASTER
from ev_sim.report.metric import Metric, metric
from ev_sim.report.quantities.handling import peak_sideslip
from ev_sim.report.scenarios.zhileykin2018 import LIMIT
from ev_sim.report.text_table import text_table
from ev_sim.run.recording.recording import Recording
from ev_sim.run.scenarios.scenario import Run, load_scenario
from ev_sim.study.case import Case
from ev_sim.study.study import Results

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ABOUT = "Zhileykin 2018: drive force by steering angle on ice with snow, who spins with which control"
SCENARIO = "zhileykin2018"
CONTROLS = ("rear_drive", "k05", "k1", "fixed_split")
FORCES = (2000.0, 2500.0, 3000.0, 3500.0, 4000.0)  # of all wheels together [N]
ANGLES = tuple(range(3, 11))  # of the road wheels [deg]
COLUMNS = ("force [N]", "angle [deg]", *CONTROLS)
SUMS = ("cases", "rear_drive_spins", "holds_")


def add_options(parser: argparse.ArgumentParser) -> None:
    """There are none: the grid is that of the page docs/zhileykin2018.md."""


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every control at every force and angle."""
    vehicle = load_scenario(SCENARIO).runs[0].configurations[MASTER].common.vehicle
    return [
        Case(
            name_of(control, force, angle),
            SCENARIO,
            (
                ("driver", "pedals.drive_torque", [force * vehicle.wheel_radius]),
                ("steering_column", "profile.angle", [0.0, math.radians(angle) * vehicle.steering_ratio]),
            ),
            control,
        )
        for force in FORCES
        for angle in ANGLES
        for control in CONTROLS
    ]


def name_of(control: str, force: float, angle: float) -> str:
    """Name of a case; force [N], angle [deg]."""
    return f"{control} {force:g} N {angle:g} deg"


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Largest sideslip angle of the moving car [rad]."""
    return {"peak_sideslip": peak_sideslip(recording)}


def peaks(results: Results, control: str) -> np.ndarray:
    """Largest sideslip angles of a control, (forces, angles) [rad]; NaN where a case was refused."""
    return np.array(
        [
            [results[name_of(control, force, angle)].measured.get("peak_sideslip", math.nan) for angle in ANGLES]
            for force in FORCES
        ]
    )


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """In how many cases rear drive spins, and each control of the 4x4 stays below 15 deg of sideslip."""
    held = {control: metric(lambda c=control: (peaks(results, c) < LIMIT).sum(), "1") for control in CONTROLS[1:]}
    return {
        "cases": metric(lambda: len(FORCES) * len(ANGLES), "1"),
        "rear_drive_spins": metric(lambda: (peaks(results, "rear_drive") >= LIMIT).sum(), "1"),
        **{f"holds_{control}": value for control, value in held.items()},
    }


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Force, angle and the largest sideslip angle [deg] with each control; two stars where the car spins."""

    def shown(peak: float) -> str:
        return f"**{math.degrees(peak):.1f}**" if peak >= LIMIT else f"{math.degrees(peak):.1f}"

    found = {control: peaks(results, control) for control in CONTROLS}
    return [
        (f"{force:g}", f"{angle:g}", *(shown(found[control][i, j]) for control in CONTROLS))
        for i, force in enumerate(FORCES)
        for j, angle in enumerate(ANGLES)
    ]


def tables(given: argparse.Namespace, results: Results) -> str:
    """The rows as aligned text."""
    table = text_table(COLUMNS, rows(given, results), left=())
    return f"largest sideslip angle [deg], ** where it passes {math.degrees(LIMIT):g} deg\n{table}"


def figures(given: argparse.Namespace, results: Results) -> dict[str, Figure]:
    """A map of the largest sideslip angle for each control."""
    from ev_sim.report.figures.heat_map import HeatMap, heat_maps

    maps = [HeatMap(control.replace("_", " "), np.degrees(peaks(results, control))) for control in CONTROLS]
    return {
        "who_spins": heat_maps(
            maps,
            ("road-wheel angle [deg]", [f"{angle:g}" for angle in ANGLES]),
            ("drive force [N]", [f"{force:g}" for force in FORCES]),
            "largest sideslip angle [deg]",
            math.degrees(LIMIT),
        )
    }
