"""Report on the steps of Shchur (2019): figs. 1a and 1b, and holding 30 deg with and without the law.

Runs: `object` (column alone, step of 5 N m by hand), `closed_loop` (power steering, step of 1 N m), `hold_manual` and
`hold_assisted` (the driver holds 30 deg without and with the law).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ev_sim.report.figures.panels import Curve, panel
from ev_sim.report.metric import Metric, Reference, metric, within
from ev_sim.report.papers import shchur2019 as paper
from ev_sim.report.papers import shchur2019_references as references
from ev_sim.report.quantities import derived
from ev_sim.report.quantities.step_response import StepResponse, step_response
from ev_sim.report.samples import Parameters, Runs, channel, last, mean_between, run_named
from ev_sim.run.recording.recording import Recording

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SETTLING_BAND = 0.05
WINDOW = 1.0  # mean values are taken over the last second [s]


def metrics(runs: Runs, parameters: Parameters) -> dict[str, Metric]:
    """The numbers of figs. 1a and 1b and the hand torques at 30 deg."""
    return {
        **_step_metrics("object", runs, parameters, paper.OBJECT, paper.HAND_TORQUE_OBJECT, "eq. 6"),
        **_step_metrics(
            "closed_loop",
            runs,
            parameters,
            paper.CLOSED_LOOP,
            (1 + paper.GAMMA) * paper.HAND_TORQUE_CLOSED_LOOP,
            "eq. 7",
        ),
        "differential_torque_final": metric(
            lambda: _final_differential_torque(run_named(runs, "closed_loop")), "N m", _final_torque_reference()
        ),
        "hand_torque_30deg_manual": metric(
            lambda: _held(run_named(runs, "hold_manual"), _hand_torque), "N m", references.hand_torque_manual()
        ),
        "hand_torque_30deg_assisted": metric(
            lambda: _held(run_named(runs, "hold_assisted"), _hand_torque), "N m", references.hand_torque_assisted()
        ),
        "differential_torque_30deg": metric(
            lambda: _held(run_named(runs, "hold_assisted"), derived.differential_torque),
            "N m",
            references.differential_torque(),
        ),
    }


def figures(runs: Runs) -> dict[str, Figure]:
    """Fig. 1: a, road-wheel angle of the object and of the closed loop; b, differential torque."""
    from ev_sim.report.figures.drawing import sheet

    def after_step(name: str, quantity: Callable[[Recording], np.ndarray], label: str = "") -> Curve:
        run = run_named(runs, name)
        return Curve(run.time - derived.hand_torque_step_time(run), quantity(run), label)

    panels = [
        panel(
            "a  Road-wheel angle",
            "angle [rad]",
            lambda: [
                after_step("object", _road_wheel_angle, "1: object, 5 N m by hand"),
                after_step("closed_loop", _road_wheel_angle, "2: closed loop, 1 N m by hand"),
            ],
        ),
        panel(
            "b  Differential torque, right minus left",
            "torque [N m]",
            lambda: [after_step("closed_loop", derived.differential_torque)],
        ),
    ]
    return {"fig1": sheet(panels, "time after the step [s]", columns=1, start=0.0)}


def _step_metrics(
    name: str, runs: Runs, parameters: Parameters, system: paper.SecondOrder, hand_torque: float, equation: str
) -> dict[str, Metric]:
    """Steady angle, overshoot and settling time of one curve of fig. 1a."""

    def response() -> StepResponse:
        run = run_named(runs, name)
        step_time = derived.hand_torque_step_time(run)
        return step_response(run.time, _road_wheel_angle(run), step_time, SETTLING_BAND, WINDOW)

    steady = system.steady_angle(paper.I_RATIO * hand_torque)
    settling = system.settling_time(SETTLING_BAND)
    source = references.follows(equation)
    return {
        f"{name}_steady_angle": metric(
            lambda: response().steady_value,
            "rad",
            Reference(steady, references.angle_band(steady, parameters), source),
        ),
        f"{name}_overshoot": metric(
            lambda: response().overshoot,
            "%",
            Reference(system.overshoot, within(system.overshoot, absolute=references.OVERSHOOT), source),
        ),
        f"{name}_settling_5": metric(
            lambda: response().settling_time,
            "s",
            Reference(settling, within(settling, relative=references.SETTLING), source),
        ),
    }


def _final_torque_reference() -> Reference:
    angle = paper.CLOSED_LOOP.steady_angle((1 + paper.GAMMA) * paper.I_RATIO * paper.HAND_TORQUE_CLOSED_LOOP)
    value = paper.differential_torque(paper.HAND_TORQUE_CLOSED_LOOP, angle)
    return Reference(value, within(value, relative=references.STEADY), references.follows("eqs. 4 and 7"))


def _final_differential_torque(run: Recording) -> float:
    return mean_between(run, derived.differential_torque(run), *last(run, WINDOW))


def _road_wheel_angle(run: Recording) -> np.ndarray:
    return channel(run, derived.ROAD_WHEEL_ANGLE)


def _hand_torque(run: Recording) -> np.ndarray:
    return channel(run, derived.HAND_TORQUE)


def _held(run: Recording, quantity: Callable[[Recording], np.ndarray]) -> float:
    return derived.mean_while_held(run, quantity(run), paper.TURN_ANGLE, *last(run, WINDOW))
