"""Report on steady circular driving with slowly rising speed, in the terms of ISO 4138.

Runs: `linear`, tyres with constant cornering stiffness, judged by the closed form, and `friction`,
real tyres up to their limit, both with a fixed steering wheel, and the same as
`constant_radius_linear` and `constant_radius_friction`, with a driver that stays on a circle.
Curvature is the acceleration across the path over the squared speed, the reference for the angle is
that of rolling at this curvature; so both methods give one understeer gradient. All angles,
accelerations and radii count inwards: the circle may lead to either side.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_sim.understeer import axle_cornering_stiffnesses, axle_masses, understeer_gradient
from ev_stack.figures.other_axes import plan_view
from ev_stack.figures.panels import Curve, Panel, panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.handling import GRADIENT_RANGE
from ev_stack.measures.metric import (
    HIGHER,
    Metric,
    NotMeasured,
    Reference,
    Runs,
    channel,
    metric,
    within,
)
from ev_stack.recording.recording import Recording

CONSTANT_RADIUS = "constant_radius_"  # how the names of the runs on a circle begin
LINEAR_RUNS = ("linear", "constant_radius_linear")
SETTLING = 1.0  # [s], after which the car follows a steering wheel that is held
# the closed form has neither drive forces across the car nor a car that accelerates
CLOSED_FORM_BAND = 0.05
STANDARD = "ISO 4138"


def sideslip_gradient(vehicle: Vehicle) -> float:
    """Sideslip gradient of a linear car, -m a/(C_r L) [rad s^2/m], beyond rolling on the circle."""
    return -axle_masses(vehicle)[1] / axle_cornering_stiffnesses(vehicle)[1]


def metrics(runs: Runs, vehicle: Vehicle) -> dict[str, Metric]:
    """Gradients of each run, those of linear cars beside the closed form.

    Largest lateral acceleration.
    """
    result = {}
    for name, run in runs.items():
        closed = (understeer_gradient(vehicle), sideslip_gradient(vehicle))
        # The closed forms are about cars with cornering stiffnesses of their own, and loads that
        # stay.
        has_closed = vehicle.tyre.lateral_curve == "linear" and vehicle.load_transfer == "none"
        closed = closed if name in LINEAR_RUNS and has_closed else None
        result |= {
            f"{name}_understeer_gradient": metric(
                lambda run=run: _gradient(run, _excess_angle(run, vehicle)),
                "rad s^2/m",
                "slope of delta - L/R over a_y from 0.5 to 4 m/s^2 (ISO 4138)",
                reference=_reference(closed[0], "m (b/C_f - a/C_r)/L") if closed else None,
            ),
            f"{name}_sideslip_gradient": metric(
                lambda run=run: _gradient(run, _excess_sideslip(run, vehicle)),
                "rad s^2/m",
                "slope of beta - b/R over a_y from 0.5 to 4 m/s^2",
                reference=_reference(closed[1], "-m a/(C_r L)") if closed else None,
            ),
            f"{name}_maximum_lateral_acceleration": metric(
                lambda run=run: _inward_acceleration(run).max(),
                "m/s^2",
                "max a_y across the path",
                HIGHER,
            ),
            f"{name}_lowest_speed_radius": metric(
                lambda run=run: 1 / float(_curvature(run)[steady(run).start]),
                "m",
                "V^2/a_y once it is steady",
            ),
        }
    return result


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Sheet]:
    """Panels over lateral acceleration, by method, and paths."""
    at_radius = {name: run for name, run in runs.items() if name.startswith(CONSTANT_RADIUS)}
    methods = {
        "steady_circle": {name: run for name, run in runs.items() if name not in at_radius},
        "constant_radius": {
            name.removeprefix(CONSTANT_RADIUS): run for name, run in at_radius.items()
        },
    }
    sheets = {
        name: Sheet(_panels(chosen, vehicle), "lateral acceleration [m/s²]", start=0.0)
        for name, chosen in methods.items()
        if chosen
    }
    tracks = [
        Curve(channel(run, "pose.x"), channel(run, "pose.y"), readable(name))
        for name, run in runs.items()
    ]
    return {**sheets, "path": plan_view("Path of the centre of mass", tracks)}


def _panels(runs: Runs, vehicle: Vehicle) -> list[Panel]:
    def over_acceleration(quantity: Callable[[Recording], np.ndarray]) -> Callable[[], list[Curve]]:
        return lambda: [_curve(name, run, quantity(run)) for name, run in runs.items()]

    def inward(quantity: Callable[[Recording], np.ndarray]) -> Callable[[Recording], np.ndarray]:
        return lambda run: _side(run) * np.degrees(quantity(run))

    return [
        panel(
            "Road-wheel angle beyond that of rolling, δ - L/R",
            "angle [deg]",
            over_acceleration(lambda run: np.degrees(_excess_angle(run, vehicle))),
        ),
        panel("Sideslip angle", "angle [deg]", over_acceleration(inward(motion.sideslip_angle))),
        panel(
            "Yaw rate",
            "yaw rate [deg/s]",
            over_acceleration(inward(lambda run: channel(run, motion.YAW_RATE))),
        ),
        panel("Speed", "speed [m/s]", over_acceleration(motion.path_speed)),
    ]


def steady(run: Recording) -> slice:
    """Samples from the end of steering in to the largest lateral acceleration.

    Behind it the car loses the circle. A driver that stays on a circle never ends steering; then
    the car is on it, at this slowly rising speed, long before the lowest acceleration that
    gradients are taken from.
    """
    angle, acceleration = channel(run, motion.STEERING_WHEEL_ANGLE), _inward_acceleration(run)
    settled = run.time >= run.time[-1] - SETTLING
    # Exactly equal: a steering wheel that is held has one angle, a driver's moves in the last
    # digit.
    if (angle[settled] == angle[-1]).all():
        held = run.time[motion.first(angle == angle[-1], "the fixed steering-wheel angle")]
        start = motion.first(
            run.time >= held + SETTLING - 1e-9, f"{SETTLING:g} s with a fixed steering wheel"
        )
    else:
        start = motion.first(acceleration >= GRADIENT_RANGE[0], f"{GRADIENT_RANGE[0]:g} m/s^2")
    # True from the first sample beyond the range on.
    beyond = np.maximum.accumulate(acceleration > GRADIENT_RANGE[1])
    # it slides off, slows down and grips again
    lost = np.flatnonzero(beyond & (acceleration < 0.9 * GRADIENT_RANGE[1]))
    # Up to the largest acceleration before the circle was lost.
    part = slice(start, int(acceleration[: lost[0] if lost.size else None].argmax()) + 1)
    if not acceleration[part].size:
        raise NotMeasured(
            "the lateral acceleration does not rise once the car follows the steering wheel"
        )
    return part


def _side(run: Recording) -> float:
    """Side of the circle: 1 to the left, -1 to the right.

    The steering does not show it: an oversteering car may be steered against the circle in the end.
    """
    # Straight ahead the side would be that of rounding errors.
    if not channel(run, motion.STEERING_WHEEL_ANGLE)[-1]:
        raise NotMeasured("the steering wheel is not turned")
    # The sum over the run: single samples of the start may have either sign.
    return float(np.sign(motion.lateral_acceleration_on_path(run).sum()))


def _inward_acceleration(run: Recording) -> np.ndarray:
    return _side(run) * motion.lateral_acceleration_on_path(run)


def _curve(name: str, run: Recording, values: np.ndarray) -> Curve:
    part = steady(run)
    return Curve(_inward_acceleration(run)[part], values[part], readable(name))


def _curvature(run: Recording) -> np.ndarray:
    # 1/R = a_y/V^2; 0.1 m/s keeps a car that stands from dividing by zero.
    return _inward_acceleration(run) / np.maximum(motion.speed(run), 0.1) ** 2


def _excess_angle(run: Recording, vehicle: Vehicle) -> np.ndarray:
    """Road-wheel angle beyond that of rolling on the circle, (n,) [rad]."""
    return _side(run) * channel(run, motion.ROAD_WHEEL_ANGLE) - vehicle.wheelbase * _curvature(run)


def _excess_sideslip(run: Recording, vehicle: Vehicle) -> np.ndarray:
    """Sideslip angle beyond that of rolling on the circle, (n,) [rad]."""
    return _side(run) * motion.sideslip_angle(
        run
    ) - vehicle.centre_of_mass_to_rear_axle * _curvature(run)


def _gradient(run: Recording, values: np.ndarray) -> float:
    """Slope over the lateral acceleration within GRADIENT_RANGE, by least squares."""
    part = steady(run)
    acceleration, values = _inward_acceleration(run)[part], values[part]
    inside = (acceleration >= GRADIENT_RANGE[0]) & (acceleration <= GRADIENT_RANGE[1])
    # A slope over a part of the range would be another quantity than the standard's.
    if acceleration.max() < GRADIENT_RANGE[1]:
        raise NotMeasured(f"the lateral acceleration stays below {GRADIENT_RANGE[1]:g} m/s^2")
    if np.count_nonzero(inside) < 2:
        raise NotMeasured(
            f"the lateral acceleration jumps over {GRADIENT_RANGE[0]:g} to {GRADIENT_RANGE[1]:g}"
            " m/s^2"
        )
    return float(np.polyfit(acceleration[inside], values[inside], 1)[0])


def _reference(value: float, formula: str) -> Reference | None:
    return Reference(
        value,
        within(value, relative=CLOSED_FORM_BAND),
        f"closed form {formula}, defined as in {STANDARD}",
    )
