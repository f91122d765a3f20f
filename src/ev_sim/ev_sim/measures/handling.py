"""What a control law does for the handling of a car and what that costs, as one number each, in any manoeuvre."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from ev_core.vehicle.car import GRAVITY
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.measures import motion
from ev_sim.measures.car_axes import wheel_directions
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.samples import channel
from ev_sim.measures.understeer import understeer_gradient
from ev_sim.plant.planar.given import wheel_places
from ev_sim.recording.recording import Recording
from ev_sim.surfaces import Surface, curve_on_road, tyre_on_road
from ev_sim.tyres.curve import peak_slip


def peak_sideslip(run: Recording) -> float:
    """Largest magnitude of the sideslip angle of the moving car [rad]."""
    return float(np.abs(np.where(motion.moving(run), motion.sideslip_angle(run), 0.0)).max())


def yaw_rate_error(run: Recording, vehicle: Vehicle) -> float:
    """Root mean square of the yaw rate less that of the linear car, while the car moves [rad/s].

    r = u delta/(L + K_us u^2) with the understeer gradient at small slip, within +-mu g/u by the mean available
    friction; without tyres there is no such limit. After Rajamani, Vehicle Dynamics and Control, 2012, chapter 8.
    """
    speed, angle = channel(run, "twist.longitudinal"), channel(run, motion.ROAD_WHEEL_ANGLE)
    turned = angle * (1.0 - vehicle.rear_steering_ratio) - run.channels.get("rear_steering.state.angle", 0.0)
    wanted = speed * turned / (vehicle.wheelbase + understeer_gradient(vehicle) * speed**2)
    if f"tire_forces.friction_coefficient.{WHEEL_NAMES[0]}" in run.channels:
        friction = np.mean(_of_wheels(run, "tire_forces.friction_coefficient"), axis=0)
        limit = friction * GRAVITY / np.maximum(np.abs(speed), motion.SLOWEST)
        wanted = np.clip(wanted, -limit, limit)
    error = (channel(run, motion.YAW_RATE) - wanted)[motion.moving(run)]
    if not len(error):
        raise NotMeasured("the car does not move")
    return float(np.sqrt(np.mean(error**2)))


def peak_slip_ratio(run: Recording) -> float:
    """Largest magnitude of the slip ratio of any wheel while the car moves [1]."""
    return float(np.abs(_of_wheels(run, "tire_forces.slip_ratio") * motion.moving(run)).max())


def slip_energy(run: Recording, vehicle: Vehicle) -> float:
    """Work that the tyres take where they slip, along and across [J]; trapezoidal rule between the samples."""
    power = np.zeros_like(run.time)
    for wheel in WHEEL_NAMES:
        for part in slip_powers(run, vehicle, wheel):
            power += part
    return float(np.trapezoid(power, run.time))


def slip_powers(run: Recording, vehicle: Vehicle, wheel: str) -> tuple[np.ndarray, np.ndarray]:
    """Force of a tyre times the speed at which it slips over the road, along and across the wheel, (n,) each [W]."""
    vx, vy, yaw_rate = (channel(run, f"twist.{name}") for name in ("longitudinal", "lateral", "yaw_rate"))
    number, (cosine, sine) = WHEEL_NAMES.index(wheel), wheel_directions(run, vehicle)[wheel]
    x, y = (places[number] for places in wheel_places(vehicle))
    ground_x, ground_y = vx - y * yaw_rate, vy + x * yaw_rate
    radius = vehicle.wheel_radius_ratio[number] * vehicle.wheel_radius
    slip_x = radius * channel(run, f"wheel_states.velocity.{wheel}") - (ground_x * cosine + ground_y * sine)
    slip_y = ground_x * sine - ground_y * cosine
    along, across = (channel(run, f"tire_forces.{kind}_force.{wheel}") for kind in ("longitudinal", "lateral"))
    return along * slip_x, across * slip_y


def drive_work(run: Recording) -> np.ndarray:
    """Work of the drives at the wheels since the start, (n,) [J]: mean torque over a step times angle turned in it."""
    work = np.zeros(len(run.time))
    for wheel in WHEEL_NAMES:
        turned = np.diff(channel(run, f"wheel_states.position.{wheel}"))
        work[1:] += np.cumsum(channel(run, f"wheel_states.effort.{wheel}")[1:] * turned)
    return work


def time_over_limit(run: Recording, vehicle: Vehicle, surfaces: Iterable[Surface]) -> float:
    """Time in which any wheel of the moving car slips beyond the peak of its friction curve [s].

    The slip is the resultant of slip ratio and sine of the slip angle; `surfaces` are those of the road, of which that
    one lies under a wheel whose friction is closest to the one that is available there.
    """
    friction = _of_wheels(run, "tire_forces.friction_coefficient")
    known = _peak_slips(vehicle, surfaces)
    if not known:
        raise NotMeasured("the surfaces of the road are not known")
    available, peaks = np.array(list(known.items())).T
    limit = peaks[np.abs(friction[..., None] - available).argmin(axis=-1)]
    across = np.sin(_of_wheels(run, "tire_forces.slip_angle"))
    over = (np.hypot(_of_wheels(run, "tire_forces.slip_ratio"), across) > limit).any(axis=0) & motion.moving(run)
    return float(np.diff(run.time)[over[1:]].sum())


def _peak_slips(vehicle: Vehicle, surfaces: Iterable[Surface]) -> Mapping[float, float]:
    """Available friction [1] -> slip of the peak [1], of each surface."""
    return {
        tyre_on_road(vehicle.tyre, surface).friction: peak_slip(*curve_on_road(vehicle.tyre, surface))
        for surface in surfaces
    }


def _of_wheels(run: Recording, quantity: str) -> np.ndarray:
    return np.array([channel(run, f"{quantity}.{wheel}") for wheel in WHEEL_NAMES])
