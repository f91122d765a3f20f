"""Tatar & Chudzik, figs 3 to 14: tyre forces with equal and corrected torques in three layouts.

A run is called LAYOUT_CONTROL: front, rear or all wheels driven, equal or corrected torques. Forces
are those in the axes of the car (eq 4, the captions), with those in the axes of the wheel beside
them. They are compared when the cars have the same speed in the bend: at the same time the
corrected car is faster, and a faster car needs more force.

A source has its place ORDER, its PANELS, and in MEASURES the functions that published.csv names.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_papers.tatar_chudzik import measures
from ev_papers.tatar_chudzik.measures import CONTROLS, CORRECTED, EQUAL, LAYOUTS, WHEELS
from ev_stack.figures.panels import Curve, Panel, panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.handling import (
    energy_since_turning_in,
    time_since_turning_in,
    total_force,
    turning_in,
    tyre_force,
    when_passing,
)
from ev_stack.measures.metric import (
    Metric,
    NotMeasured,
    Parameters,
    Runs,
    channel,
    metric,
    run_named,
)
from ev_stack.recording.recording import Recording
from ev_study.verdicts.measure import measures_of
from ev_study.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_study.verdicts.panels_page import PublishedPanel, over_time, scheme
from ev_study.verdicts.verdict import metrics_at_hand

ORDER = 2  # among the sources, in tables
MEASURES = measures_of(measures)
SPEED = 8.5  # [m/s], which every run passes in the bend
_AT_SPEED = f"at {SPEED:g} m/s"
ACROSS = {
    "force_y": "tyre force along y of the car",
    "lateral_force": "tyre force across the wheel",
}


def of_wheel(run: Recording, wheel: str, kind: str, vehicle: Vehicle) -> np.ndarray:
    """A quantity of a wheel, (n,): a force [N] or its speed [rad/s]."""
    match kind:
        case "force_y":
            return tyre_force(run, wheel, vehicle).y
        case "force_x":
            return tyre_force(run, wheel, vehicle).x
        case "lateral_force":
            return channel(run, f"tire_forces.lateral_force.{wheel}")
        case _:
            return channel(run, f"wheel_states.velocity.{wheel}")


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Forces in both axes, total force and energy at equal speed, and the judged numbers."""
    found: dict[str, Metric] = {}
    for layout in LAYOUTS:
        for control in CONTROLS:
            found |= _at_equal_speed(runs, f"{layout}_{control}", vehicle)
    driven = ScenarioRuns(runs, vehicle, parameters)
    return found | metrics_at_hand("tatar_chudzik", "tatar_chudzik", driven)


def _at_equal_speed(runs: Runs, name: str, vehicle: Vehicle) -> dict[str, Metric]:
    """Metrics of a run at the instant at which it passes SPEED in the bend."""

    def passing(values: Callable[[Recording], np.ndarray], unit: str, formula: str) -> Metric:
        def measure() -> float:
            run = run_named(runs, name)
            return when_passing(run, SPEED, values(run))

        return metric(measure, unit, formula)

    found = {}
    for wheel in WHEEL_NAMES:
        for kind, formula in ACROSS.items():
            found[f"{kind}_{wheel}_{name}"] = passing(
                lambda run, wheel=wheel, kind=kind: of_wheel(run, wheel, kind, vehicle),
                "N",
                f"{formula} {_AT_SPEED}",
            )
    found[f"total_tyre_force_{name}"] = passing(
        total_force, "N", f"sum of all tyre forces {_AT_SPEED}"
    )
    found[f"drive_energy_{name}"] = passing(
        energy_since_turning_in, "J", f"work at the wheels since turning in, {_AT_SPEED}"
    )
    found[f"time_to_speed_{name}"] = passing(
        time_since_turning_in, "s", f"time since turning in, {_AT_SPEED}"
    )
    return found


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Sheet]:
    """Figs 3 to 14 over time, and the change of the lateral forces over the speed, in both axes."""
    shown = panels(runs, vehicle)
    # Row by row: F_y, F_x and wheel speeds of the three layouts.
    equal = [shown[number] for number in (3, 6, 9, 4, 7, 10, 5, 8, 11)]
    corrected = [shown[number] for number in (12, 13, 14)]
    across = [
        _wheels_over_time(runs, vehicle, "Across the wheel", f"{each}_{CORRECTED}", "lateral_force")
        for each in LAYOUTS
    ]

    def changes(kind: str) -> Sheet:
        over_speed = [_change_over_speed(runs, vehicle, wheel, kind) for wheel in WHEEL_NAMES]
        return Sheet(over_speed, "speed [m/s]")

    return {
        "forces_y": changes("force_y"),
        "lateral_forces": changes("lateral_force"),
        "fig3_to_fig11": Sheet(equal, columns=len(LAYOUTS)),
        "fig12_to_fig14": Sheet([*corrected, *across], columns=len(LAYOUTS)),
    }


def _change_over_speed(runs: Runs, vehicle: Vehicle, wheel: str, kind: str) -> Panel:
    """Force with the correction minus that with equal torques, at the same speed in the bend."""

    def in_the_bend(name: str) -> tuple[np.ndarray, np.ndarray]:
        """Speed [m/s] and force [N] of a run once the turn-in is over."""
        run = run_named(runs, name)
        period = run.time[1] - run.time[0]
        start = turning_in(run) + int(measures.TURNED / period)
        speed = motion.path_speed(run)[start:]
        # Only over a rising speed is the force a function of it.
        if len(speed) < 2 or not (np.diff(speed) > 0.0).all():
            raise NotMeasured(f"the speed of {name} does not rise all the time")
        return speed, of_wheel(run, wheel, kind, vehicle)[start:]

    def gained(layout: str) -> Curve:
        speed, equal = in_the_bend(f"{layout}_{EQUAL}")
        other_speed, corrected = in_the_bend(f"{layout}_{CORRECTED}")
        both = (speed >= other_speed[0]) & (speed <= other_speed[-1])
        difference = np.interp(speed[both], other_speed, corrected) - equal[both]
        return Curve(speed[both], difference, f"{layout}-wheel drive")

    title = f"{readable(wheel)}: corrected minus equal"
    return panel(
        title, "force [N]", lambda: [gained(layout) for layout in LAYOUTS], scale="difference"
    )


def _wheels_over_time(runs: Runs, vehicle: Vehicle, title: str, name: str, kind: str) -> Panel:
    def curves() -> list[Curve]:
        run = run_named(runs, name)
        return [
            Curve(run.time, of_wheel(run, wheel, kind, vehicle), readable(wheel))
            for wheel in WHEEL_NAMES
        ]

    ylabel = "wheel speed [rad/s]" if kind == "wheel_speed" else "force [N]"
    return panel(f"{title}, {name.replace('_', ', ')}", ylabel, curves)


def panels(runs: Runs, vehicle: Vehicle) -> dict[int, Panel]:
    """Figs 3 to 14 by number: forces along y and x of the car, and wheel speeds."""
    found = {}

    def add(number: int, title: str, run: str, kind: str) -> None:
        titled = f"{number}  {title}"
        found[number] = _wheels_over_time(runs, vehicle, titled, run, kind)

    # The paper has three figures for each layout, and those with corrected torques in the end.
    for place, layout in enumerate(LAYOUTS):
        equal = f"{layout}_{EQUAL}"
        add(3 + 3 * place, "F_y", equal, "force_y")
        add(4 + 3 * place, "F_x", equal, "force_x")
        add(5 + 3 * place, "Wheel speed", equal, "wheel_speed")
        add(12 + place, "F_y", f"{layout}_{CORRECTED}", "force_y")
    return found


def _row(title: str, numbers: range) -> tuple[PublishedPanel, ...]:
    """Figures of the three layouts; of those with corrected torques each wheel has an id."""
    found = []
    for number in numbers:
        ends = [f".{wheel}" for wheel in WHEELS] if number >= 12 else [""]
        draw = over_time(lambda driven, n=number: panels(driven.runs, driven.vehicle)[n])
        ids = tuple(f"tatar.fig{number}{end}" for end in ends)
        needs = (ScenarioNeed("tatar_chudzik"),)
        found.append(PublishedPanel(str(number), "", title, ids, needs, draw))
    return tuple(found)


PANELS = (
    scheme("1", "the forces", "tatar.fig1"),
    scheme("2", "inputs and outputs", "tatar.fig2"),
    *_row("Forces along y of the car, equal torques", range(3, 12, 3)),
    *_row("Forces along x of the car, equal torques", range(4, 12, 3)),
    *_row("Wheel speeds, equal torques", range(5, 12, 3)),
    *_row("Forces along y of the car, corrected torques", range(12, 15)),
)
