"""Report on a coast-down: rolling resistance and drag (after SAE J1263 and UN R154).

Road load: (m + sum J/r^2) dV/dt = -m g f_0 - rho c_d A V^2/2, fitted by least squares to the mean
decelerations of intervals of one second.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_core.vehicle.car import GRAVITY
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import wheel_inertias
from ev_msgs_py.contract.roles import MASTER
from ev_stack.figures.panels import Curve, motion_panels, panel
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.metric import (
    Metric,
    NotMeasured,
    Parameters,
    Reference,
    Runs,
    channel,
    metric,
    within,
)
from ev_stack.recording.recording import Recording

INTERVAL = 1.0  # [s]
FEWEST = 10  # intervals for a fit
LOWEST_SPEED = 15 / 3.6  # [m/s], the fit does not use lower ones
ROAD_LOAD_BAND = 0.01  # of the vehicle description, in which fitted values count as found back
UPPER, LOWER = 100 / 3.6, 80 / 3.6  # [m/s], between which the coast-down is timed


def effective_mass(vehicle: Vehicle) -> float:
    """Mass and rotating inertias, m + sum (J_w + J_m n^2)/r^2, by the radius of each wheel [kg]."""
    of_wheels = zip(wheel_inertias(vehicle), vehicle.wheel_radius_ratio, strict=True)
    return (
        vehicle.mass
        + sum(inertia / ratio**2 for inertia, ratio in of_wheels) / vehicle.wheel_radius**2
    )


def decelerations(run: Recording) -> tuple[np.ndarray, np.ndarray]:
    """Speeds in the middle of the intervals (n,) [m/s] and decelerations (n,) [m/s^2].

    Raises NotMeasured if there is no interval.
    """
    speed = coasting_speed(run)
    # Rounding of the last instant must not cost the last interval.
    ends = np.arange(run.time[0], run.time[-1] + 1e-9, INTERVAL)
    at_ends = np.interp(ends, run.time, speed)
    # Between ends: there is one more of them than of intervals.
    if np.count_nonzero(at_ends > LOWEST_SPEED) <= FEWEST:
        least = f"{FEWEST * INTERVAL:g} s"
        raise NotMeasured(f"the car coasts above {LOWEST_SPEED:.2f} m/s for less than {least}")
    ends, at_ends = ends[at_ends > LOWEST_SPEED], at_ends[at_ends > LOWEST_SPEED]
    return np.interp((ends[:-1] + ends[1:]) / 2, run.time, speed), -np.diff(at_ends) / np.diff(ends)


def coasting_speed(run: Recording) -> np.ndarray:
    """Speed of the car, forwards or in reverse, (n,) [m/s].

    Raises NotMeasured if a pedal is pressed: the deceleration is then not that of the road load.
    """
    for pedal in (motion.DRIVE_TORQUE, motion.BRAKE_TORQUE):
        if channel(run, pedal).any():
            raise NotMeasured(
                f"the car does not coast: {pedal} is not zero at"
                f" {run.time[channel(run, pedal) != 0][0]:g} s"
            )
    return motion.speed(run)


def road_load(run: Recording, vehicle: Vehicle) -> tuple[float, float]:
    """Rolling resistance coefficient f_0 [1] and drag area c_d A [m^2] that fit best."""
    speed, deceleration = decelerations(run)
    # The model is linear in f_0 and c_d A: one column of forces for each.
    columns = np.column_stack(
        (np.full_like(speed, vehicle.mass * GRAVITY), 0.5 * vehicle.air_density * speed**2)
    )
    (rolling, area), *_ = np.linalg.lstsq(
        columns, effective_mass(vehicle) * deceleration, rcond=None
    )
    return float(rolling), float(area)


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Fitted road load beside that of the vehicle description, and the time from 100 to 80 km/h."""
    road = parameters.get(MASTER, {})

    def level(measure: Callable[[], float]) -> Callable[[], float]:
        def measured() -> float:
            if any((*road.get("road.grade", ()), *road.get("road.side_slope", ()))):
                raise NotMeasured(
                    "the road is not level, and what its slope gives would count as road load"
                )
            if vehicle.road_load.linear != 0.0:
                raise NotMeasured(
                    "f_0 and c_d A do not describe a road load with a part in proportion to the"
                    " speed"
                )
            return measure()

        return measured

    # All that is constant in the road load of the description; the fit cannot tell it apart.
    rolling = vehicle.rolling_resistance + vehicle.road_load.constant / (vehicle.mass * GRAVITY)
    area = vehicle.drag_coefficient * vehicle.frontal_area
    # the part of the rolling resistance that grows with V^2 looks like drag
    if vehicle.air_density > 0.0:
        area += 2 * vehicle.road_load.quadratic / vehicle.air_density
        area += 2 * vehicle.mass * GRAVITY * vehicle.rolling_resistance_growth / vehicle.air_density
    return motion.of_each_run(
        runs,
        lambda run: {
            "rolling_resistance": metric(
                level(lambda: road_load(run, vehicle)[0]),
                "1",
                "f_0 of m_e dV/dt = -m g f_0 - rho c_d A V^2/2, by least squares",
                reference=_described(rolling, "f_0"),
            ),
            "drag_area": metric(
                level(lambda: road_load(run, vehicle)[1]),
                "m^2",
                "c_d A of the same fit",
                reference=_described(area, "c_d A and k_f"),
            ),
            "initial_deceleration": metric(
                level(lambda: decelerations(run)[1][0]), "m/s^2", "mean of the first second"
            ),
            "time_from_100_to_80_km_h": metric(
                level(lambda: _time_between(run)), "s", "time from 100 to 80 km/h"
            ),
        },
    )


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Sheet]:
    """Speed over time, and deceleration over speed with the fitted road load."""

    def loads() -> list[Curve]:
        # One run only: a fit of each run would put two curves for each into the panel.
        run = next(iter(runs.values()))
        speed, deceleration = decelerations(run)
        rolling, area = road_load(run, vehicle)
        force = vehicle.mass * GRAVITY * rolling + 0.5 * vehicle.air_density * area * speed**2
        fitted = force / effective_mass(vehicle)
        return [
            Curve(speed[::-1], each[::-1], name)
            for name, each in (("measured", deceleration), ("fitted", fitted))
        ]

    deceleration = panel("Deceleration", "deceleration [m/s²]", loads)
    return {
        "speed": Sheet(motion_panels(runs, "speed")),
        "deceleration": Sheet([deceleration], "speed [m/s]", start=0.0),
    }


def _described(value: float, symbol: str) -> Reference | None:
    return (
        Reference(
            value, within(value, relative=ROAD_LOAD_BAND), f"{symbol} of the vehicle description"
        )
        if value
        else None
    )


def _time_between(run: Recording) -> float:
    # A crossing is one from below, and a coasting car falls through the levels from above.
    slowness = -coasting_speed(run)
    return motion.crossing_time(run.time, slowness, -LOWER, "80 km/h") - motion.crossing_time(
        run.time, slowness, -UPPER, "100 km/h"
    )
