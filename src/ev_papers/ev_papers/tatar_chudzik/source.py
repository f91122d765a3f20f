"""Tatar & Chudzik, figs 3 to 14: tyre forces with equal and with corrected torques, for three layouts.

A run is called LAYOUT_CONTROL: front, rear or all wheels driven, equal or corrected torques. Forces are those in the
axes of the car (eq 4, the captions), with those in the axes of the wheel beside them. They are compared when the cars
have the same speed in the bend: at the same time the corrected car is faster, and a faster car needs more force.

A source has its place ORDER, the functions MEASURES that measure the numbers of published.csv, and its PANELS.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_papers.tatar_chudzik import measures
from ev_papers.tatar_chudzik.measures import CONTROLS, CORRECTED, EQUAL, LAYOUTS
from ev_sim.figures.panels import Curve, Panel, panel, readable
from ev_sim.figures.sheets import Sheet
from ev_sim.measures import motion
from ev_sim.measures.handling import (
    energy_since_turning_in,
    time_since_turning_in,
    total_force,
    turning_in,
    tyre_force,
    when_passing,
)
from ev_sim.measures.metric import Metric, NotMeasured, Parameters, Runs, channel, metric, run_named
from ev_sim.recording.recording import Recording
from ev_study.verdicts.measure import measures_of
from ev_study.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_study.verdicts.panels_page import PublishedPanel, cannot_be_drawn, over_time
from ev_study.verdicts.verdict import metrics_at_hand

SPEED = 8.5  # [m/s], which every run passes in the bend
OF_WHEEL: dict[str, Callable[[Recording, str, Vehicle], np.ndarray]] = {  # (n,); forces along the axes of the car
    "force_y": lambda run, wheel, vehicle: tyre_force(run, wheel, vehicle).y,
    "force_x": lambda run, wheel, vehicle: tyre_force(run, wheel, vehicle).x,
    "lateral_force": lambda run, wheel, vehicle: channel(run, f"tire_forces.lateral_force.{wheel}"),
    "wheel_speed": lambda run, wheel, vehicle: channel(run, f"wheel_states.velocity.{wheel}"),
}
ACROSS = {"force_y": "tyre force along y of the car", "lateral_force": "tyre force across the wheel"}
_AT_SPEED = f"at {SPEED:g} m/s"


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Forces in both axes, total tyre force and drive energy at equal speed, and what the source is judged by."""
    result = {}
    for name in (f"{layout}_{control}" for layout in LAYOUTS for control in CONTROLS):
        for wheel in WHEEL_NAMES:
            for kind in ACROSS:
                force = _when_fast(runs, name, lambda run, w=wheel, k=kind: OF_WHEEL[k](run, w, vehicle))
                result[f"{kind}_{wheel}_{name}"] = metric(force, "N", f"{ACROSS[kind]} {_AT_SPEED}")
        result[f"total_tyre_force_{name}"] = metric(
            _when_fast(runs, name, total_force), "N", f"sum of all tyre forces {_AT_SPEED}"
        )
        result[f"drive_energy_{name}"] = metric(
            _when_fast(runs, name, energy_since_turning_in), "J", f"work at the wheels since turning in, {_AT_SPEED}"
        )
        result[f"time_to_speed_{name}"] = metric(
            _when_fast(runs, name, time_since_turning_in), "s", f"time since turning in, {_AT_SPEED}"
        )
    driven = ScenarioRuns(runs, vehicle, parameters)
    return result | metrics_at_hand("tatar_chudzik", "tatar_chudzik", driven)


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Sheet]:
    """Figs 3 to 14 over time, and what the correction does to the lateral forces over the speed, in both axes."""
    shown = panels(runs, vehicle)
    across = [
        _wheels_over_time(runs, vehicle, "Across the wheel", f"{each}_{CORRECTED}", "lateral_force") for each in LAYOUTS
    ]
    return {
        **{
            name: Sheet([_over_speed(runs, vehicle, wheel, kind) for wheel in WHEEL_NAMES], "speed [m/s]")
            for name, kind in zip(("forces_y", "lateral_forces"), ACROSS, strict=True)
        },
        "fig3_to_fig11": Sheet([shown[n] for n in (3, 6, 9, 4, 7, 10, 5, 8, 11)], columns=len(LAYOUTS)),
        "fig12_to_fig14": Sheet([*(shown[n] for n in (12, 13, 14)), *across], columns=len(LAYOUTS)),
    }


def _when_fast(runs: Runs, name: str, values: Callable[[Recording], np.ndarray]) -> Callable[[], float]:
    """The quantity (n,) at the instant at which the run passes SPEED in the bend."""

    def measure() -> float:
        run = run_named(runs, name)
        return when_passing(run, SPEED, values(run))

    return measure


def _over_speed(runs: Runs, vehicle: Vehicle, wheel: str, kind: str) -> Panel:
    """The force with the correction minus that with equal torques, at the same speed in the bend."""

    def in_the_bend(name: str) -> tuple[np.ndarray, np.ndarray]:
        run = run_named(runs, name)
        start = turning_in(run) + int(1.0 / (run.time[1] - run.time[0]))  # when the turn-in is over
        speed = motion.path_speed(run)[start:]
        if len(speed) < 2 or not (np.diff(speed) > 0.0).all():
            raise NotMeasured(f"the speed of {name} does not rise all the time")
        return speed, OF_WHEEL[kind](run, wheel, vehicle)[start:]

    def gained(layout: str) -> Curve:
        (speed, equal), (others, corrected) = (in_the_bend(f"{layout}_{control}") for control in CONTROLS)
        both = (speed >= others[0]) & (speed <= others[-1])
        difference = np.interp(speed[both], others, corrected) - equal[both]
        return Curve(speed[both], difference, f"{layout}-wheel drive")

    title = f"{readable(wheel)}: corrected minus equal"
    return panel(title, "force [N]", lambda: [gained(layout) for layout in LAYOUTS], scale="difference")


def _wheels_over_time(runs: Runs, vehicle: Vehicle, title: str, name: str, kind: str) -> Panel:
    def curves() -> list[Curve]:
        run = run_named(runs, name)
        return [Curve(run.time, OF_WHEEL[kind](run, each, vehicle), readable(each)) for each in WHEEL_NAMES]

    ylabel = "wheel speed [rad/s]" if kind == "wheel_speed" else "force [N]"
    return panel(f"{title}, {name.replace('_', ', ')}", ylabel, curves)


def panels(runs: Runs, vehicle: Vehicle) -> dict[int, Panel]:
    """Figs 3 to 14 by number: forces along y and x of the car and wheel speeds, with equal and corrected torques."""
    found = {}
    for n, layout in enumerate(LAYOUTS):
        equal, corrected = f"{layout}_{EQUAL}", f"{layout}_{CORRECTED}"
        for number, title, run, kind in (
            (3 + 3 * n, "F_y", equal, "force_y"),
            (4 + 3 * n, "F_x", equal, "force_x"),
            (5 + 3 * n, "Wheel speed", equal, "wheel_speed"),
            (12 + n, "F_y", corrected, "force_y"),
        ):
            found[number] = _wheels_over_time(runs, vehicle, f"{number}  {title}", run, kind)
    return found


ORDER = 2  # among the sources, in tables
MEASURES = measures_of(measures)


def _row(title: str, numbers: range) -> tuple[PublishedPanel, ...]:
    """The figures of the three layouts; of those with corrected torques each wheel has an id."""
    ends = [f".{wheel}" for wheel in measures.WHEELS] if numbers[0] == 12 else [""]
    return tuple(
        PublishedPanel(
            str(number),
            "",
            title,
            tuple(f"tatar.fig{number}{end}" for end in ends),
            (ScenarioNeed("tatar_chudzik"),),
            over_time(lambda driven, number=number: panels(driven.runs, driven.vehicle)[number]),
        )
        for number in numbers
    )


PANELS = (
    cannot_be_drawn("1", "", "Schemes", "a scheme of the forces, no quantity over another one", "tatar.fig1"),
    cannot_be_drawn("2", "", "Schemes", "a scheme of inputs and outputs, no quantity over another one", "tatar.fig2"),
    *_row("Forces along y of the car, equal torques", range(3, 12, 3)),
    *_row("Forces along x of the car, equal torques", range(4, 12, 3)),
    *_row("Wheel speeds, equal torques", range(5, 12, 3)),
    *_row("Forces along y of the car, corrected torques", range(12, 15)),
)
