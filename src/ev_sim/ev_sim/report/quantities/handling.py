"""What a control law does for the handling of a car and what that costs, as one number each, in any manoeuvre."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.vehicle.car import GRAVITY
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.plant.planar.constants import wheel_places
from ev_sim.report.quantities import derived, motion
from ev_sim.report.quantities.car_axes import wheel_directions
from ev_sim.report.quantities.understeer import understeer_gradient
from ev_sim.report.samples import channel
from ev_sim.running.recording.recording import Recording
from ev_sim.surfaces.table import Surface, curve_on_road, tyre_on_road
from ev_sim.tyres.curve import peak_slip

SLOWEST = 1.0  # [m/s], below which the direction of travel and slip ratios say little


def moving(run: Recording) -> np.ndarray:
    """Whether the car moves, (n,)."""
    return np.abs(derived.speed(run)) >= SLOWEST


def peak_sideslip(run: Recording) -> float:
    """Largest magnitude of the sideslip angle of the moving car [rad]."""
    return float(np.abs(np.where(moving(run), motion.sideslip_angle(run), 0.0)).max())


def yaw_rate_error(run: Recording, vehicle: Vehicle) -> float:
    """Root mean square of the yaw rate less that of the linear car, while the car moves [rad/s].

    r = u delta/(L + K_us u^2) with the understeer gradient at small slip, within +-mu g/u by the mean available
    friction; without tyres there is no such limit. After Rajamani, Vehicle Dynamics and Control, 2012, chapter 8.
    """
    speed, angle = channel(run, "twist.longitudinal"), channel(run, derived.ROAD_WHEEL_ANGLE)
    turned = angle * (1.0 - vehicle.rear_steering_ratio)
    wanted = speed * turned / (vehicle.wheelbase + understeer_gradient(vehicle) * speed**2)
    if f"tire_forces.friction_coefficient.{WHEEL_NAMES[0]}" in run.channels:
        friction = np.mean(_of_wheels(run, "tire_forces.friction_coefficient"), axis=0)
        limit = friction * GRAVITY / np.maximum(np.abs(speed), SLOWEST)
        wanted = np.clip(wanted, -limit, limit)
    error = (channel(run, motion.YAW_RATE) - wanted)[moving(run)]
    return float(np.sqrt(np.mean(error**2))) if len(error) else 0.0


def peak_slip_ratio(run: Recording) -> float:
    """Largest magnitude of the slip ratio of any wheel while the car moves [1]."""
    return float(np.abs(_of_wheels(run, "tire_forces.slip_ratio") * moving(run)).max())


def slip_energy(run: Recording, vehicle: Vehicle) -> float:
    """Work that the tyres take where they slip, along and across [J]; trapezoidal rule between the samples."""
    vx, vy, yaw_rate = (channel(run, f"twist.{name}") for name in ("longitudinal", "lateral", "yaw_rate"))
    power = np.zeros_like(vx)
    directions = wheel_directions(run, vehicle)
    places = zip(WHEEL_NAMES, *wheel_places(vehicle), vehicle.wheel_radius_ratio, strict=True)
    for wheel, x, y, ratio in places:
        cosine, sine = directions[wheel]
        ground_x, ground_y = vx - y * yaw_rate, vy + x * yaw_rate
        rim = ratio * vehicle.wheel_radius * channel(run, f"wheel_states.velocity.{wheel}")
        slip_x = rim - (ground_x * cosine + ground_y * sine)
        slip_y = ground_x * sine - ground_y * cosine
        power += channel(run, f"tire_forces.longitudinal_force.{wheel}") * slip_x
        power += channel(run, f"tire_forces.lateral_force.{wheel}") * slip_y
    return float(np.trapezoid(power, run.time))


def drive_work(run: Recording) -> np.ndarray:
    """Work of the drives at the wheels since the start, (n,) [J]: mean torque over a step times angle turned in it."""
    work = np.zeros(len(run.time))
    for wheel in WHEEL_NAMES:
        turned = np.diff(channel(run, f"wheel_states.position.{wheel}"))
        work[1:] += np.cumsum(channel(run, f"wheel_states.effort.{wheel}")[1:] * turned)
    return work


def time_over_limit(run: Recording, vehicle: Vehicle, surfaces: Iterable[Surface]) -> float:
    """Time in which any wheel of the moving car slips beyond the peak of its friction curve [s].

    The slip is the resultant of slip ratio and sine of the slip angle; `surfaces` are those of the road, told apart by
    the available friction under the wheel.
    """
    friction = _of_wheels(run, "tire_forces.friction_coefficient")
    limit = np.full_like(friction, np.inf)
    for available, slip in _peak_slips(vehicle, surfaces).items():
        limit[friction == available] = slip
    across = np.sin(_of_wheels(run, "tire_forces.slip_angle"))
    over = (np.hypot(_of_wheels(run, "tire_forces.slip_ratio"), across) > limit).any(axis=0) & moving(run)
    return float(np.count_nonzero(over[1:]) * (run.time[1] - run.time[0]))


def _peak_slips(vehicle: Vehicle, surfaces: Iterable[Surface]) -> Mapping[float, float]:
    """Available friction [1] -> slip of the peak [1], of each surface."""
    return {
        tyre_on_road(vehicle.tyre, surface).friction: peak_slip(*curve_on_road(vehicle.tyre, surface))
        for surface in surfaces
    }


def _of_wheels(run: Recording, quantity: str) -> np.ndarray:
    return np.array([channel(run, f"{quantity}.{wheel}") for wheel in WHEEL_NAMES])
