"""Curves and schemes of which only captions are left; what of their course follows is shown, not judged."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.quantities.car_axes import tyre_force
from ev_sim.report.quantities.passing_speed import turning_in
from ev_sim.report.samples import channel, run_named
from ev_sim.running.recording.recording import Recording
from ev_sim.verdicts.check import Number, holds
from ev_sim.verdicts.declaration import Declaration, no_verdict, not_judgeable
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.sources.tatar_chudzik.runs import EQUAL, LAYOUTS, RUNS, WHEELS

LOST = "curve not in the text"
TURNED = 1.0  # [s] after which the turn-in is over
STRAIGHT = 1.0  # [N] below which there is no lateral force
Courses = Mapping[str, np.ndarray]


def _shape(
    layout: str, courses: Callable[[Recording, Vehicle], Courses], rule: Callable[..., bool], what: str
) -> Number:
    def measure(driven: ScenarioRuns) -> bool:
        run = run_named(driven.runs, f"{layout}_{EQUAL}")
        return rule(courses(run, driven.vehicle), turning_in(run), run.time)

    return holds(measure, what)


def _forces_y(run: Recording, vehicle: Vehicle) -> Courses:
    return {name: tyre_force(run, wheel, vehicle).y for name, wheel in WHEELS.items()}


def _forces_x(run: Recording, vehicle: Vehicle) -> Courses:
    return {name: tyre_force(run, wheel, vehicle).x for name, wheel in WHEELS.items()}


def _wheel_speeds(run: Recording, _: Vehicle) -> Courses:
    return {name: channel(run, f"wheel_states.velocity.{wheel}") for name, wheel in WHEELS.items()}


def _inward(force: Courses, turn: int, time: np.ndarray) -> bool:
    late = time >= time[turn] + TURNED
    straight = all(np.abs(values[:turn]).max() < STRAIGHT for values in force.values())
    return straight and all(values[late][-1] > 0.0 for values in force.values()) and force["FR"][-1] > force["FL"][-1]


def _front_drops(force: Courses, turn: int, time: np.ndarray) -> bool:
    late = time >= time[turn] + TURNED
    return all(force[wheel][late].max() < force[wheel][turn] for wheel in ("FL", "FR"))


def _outer_above_inner(speed: Courses, turn: int, time: np.ndarray) -> bool:
    late = time >= time[turn] + TURNED
    return all((speed[outer][late] > speed[inner][late]).all() for inner, outer in (("FL", "FR"), ("RL", "RR")))


FIGURES = (
    (3, _forces_y, _inward, "zero until the turn, then inwards, outer above inner in front"),
    (4, _forces_x, _front_drops, "in the bend the front wheels stay below their force straight ahead"),
    (5, _wheel_speeds, _outer_above_inner, "in the bend the outer wheels are faster than the inner ones"),
)


def _equal_torques() -> tuple[Declaration, ...]:
    return tuple(
        not_judgeable(f"tatar.fig{first + 3 * n}", LOST, (RUNS,), _shape(layout, courses, rule, what))
        for first, courses, rule, what in FIGURES
        for n, layout in enumerate(LAYOUTS)
    )


DECLARATIONS = (
    *_equal_torques(),
    not_judgeable("tatar.fig12_14.curves", f"{LOST}, beyond the signs", (RUNS,)),
    *(no_verdict(id, "a scheme without numbers") for id in ("tatar.fig1", "tatar.fig2")),
)
