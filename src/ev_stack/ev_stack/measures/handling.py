"""Forces, slip and work of the wheels; the effect of a control law on handling, and its cost."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

import numpy as np

from ev_core.vehicle.car import GRAVITY, front_wheel_tangents
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.plant.planar.given import wheel_places
from ev_sim.surfaces import SURFACES, Surface, curve_on_road, tyre_on_road
from ev_sim.understeer import understeer_gradient
from ev_stack.measures import motion
from ev_stack.measures.metric import TYRES, NotMeasured, channel
from ev_stack.measures.motion import distance_on_path
from ev_stack.recording.recording import Recording

_LEAST_LENGTH = 0.1  # of the wheelbase: ten times the yaw rate of a neutral car
GRADIENT_RANGE = (0.5, 4.0)  # [m/s^2], lateral accelerations over which gradients are taken
# The ramp of FMVSS 126, S7.6, has 0.4 m/s^2 of V beta' and 2 to 5.4 m/s^3, lane changes 2 m/s^2 or
# 8 m/s^3 and more.
UNSTEADY = 0.5  # [m/s^2], of V beta' and V'
FASTEST_CHANGE, WHILE = 6.0, 0.5  # [m/s^3] of the lateral acceleration, over [s]
_AXLES_OF_WHEELS = [name.partition("_")[0] for name in WHEEL_NAMES]
LARGEST_ANGLE = 0.1  # [rad] of the road wheels, where tan(delta) is 0.3 % more than delta


class Direction(NamedTuple):
    """Cosine and sine of a wheel's angle against the car, (n,) [1]."""

    cosine: np.ndarray
    sine: np.ndarray


class Force(NamedTuple):
    """Force of the road on a tyre to the front and to the left of the car, (n,) [N]."""

    x: np.ndarray
    y: np.ndarray


def front_wheel_angle(run: Recording, vehicle: Vehicle) -> np.ndarray:
    """Mean angle of the front wheels as they turn, left positive, (n,) [rad].

    Wheels with tyres stop at the end of their travel (`plant.guard`), where a steering column that
    is turned by a driver may go on. Recorded is the angle that the column asks for.
    """
    asked = channel(run, motion.ROAD_WHEEL_ANGLE)
    if not any(name.startswith(TYRES) for name in run.channels):
        return asked
    stop = vehicle.maximum_road_wheel_angle
    return np.clip(asked, -stop, stop)


def wheel_directions(run: Recording, vehicle: Vehicle) -> Mapping[str, Direction]:
    """Direction of each wheel: steering geometry, rear steering, and compliance steer.

    The side force of an axle turns its wheels, those in front out of the bend
    (`plant.planar.contact.point`).
    """
    mean = front_wheel_angle(run, vehicle)
    # A rear axle that is steered by a law of its own adds to what follows the front wheels.
    apart = run.channels.get("rear_steering.state.angle", 0.0)
    angle, rear = np.tan(mean), np.tan(vehicle.rear_steering_ratio * mean + apart)
    parallel = float(vehicle.steering_geometry == "parallel")
    tangents = (
        *front_wheel_tangents(angle, vehicle.wheelbase, vehicle.front_track, parallel),
        rear,
        rear,
    )
    tangents = [
        _bent(run, vehicle, axle, tangent)
        for axle, tangent in zip(_AXLES_OF_WHEELS, tangents, strict=True)
    ]
    # cos = 1/sqrt(1 + tan^2): no wheel is turned beyond 90 deg.
    cosines = (1 / np.hypot(1.0, tangent) for tangent in tangents)
    return {
        wheel: Direction(cosine, tangent * cosine)
        for wheel, tangent, cosine in zip(WHEEL_NAMES, tangents, cosines, strict=True)
    }


def _bent(run: Recording, vehicle: Vehicle, axle: str, tangent: np.ndarray) -> np.ndarray:
    """The tangent of the angle of a wheel as the side force on its axle bends it, (n,)."""
    suspension = vehicle.suspension
    compliance = (
        suspension.rear_compliance_steer if axle == "rear" else -suspension.front_compliance_steer
    )
    if compliance == 0.0 or not any(
        name.startswith("tire_forces.lateral_force.") for name in run.channels
    ):
        return tangent
    # The whole axle bends, so the forces of both of its wheels count.
    held = sum(
        channel(run, f"tire_forces.lateral_force.{axle}_{side}") for side in ("left", "right")
    )
    turned: np.ndarray = np.tan(np.arctan(tangent) + np.arctan(compliance * held))
    return turned


def tyre_force(run: Recording, wheel: str, vehicle: Vehicle) -> Force:
    """Force of a wheel in axes of the car; Tatar & Chudzik, eq. 4.

    F_x = F_p cos d - F_b sin d, F_y = F_p sin d + F_b cos d.
    """
    along, across = (
        channel(run, f"tire_forces.{kind}_force.{wheel}") for kind in ("longitudinal", "lateral")
    )
    cosine, sine = wheel_directions(run, vehicle)[wheel]
    return Force(along * cosine - across * sine, along * sine + across * cosine)


def peak_sideslip(run: Recording) -> float:
    """Largest magnitude of the sideslip angle of the moving car [rad]."""
    return float(np.abs(np.where(motion.moving(run), motion.sideslip_angle(run), 0.0)).max())


def has_spun(run: Recording) -> bool:
    """Mark of a car that slid backwards while it moved: its sideslip angle was beyond 90 deg.

    False where no motion was recorded.
    """
    try:
        return peak_sideslip(run) > 0.5 * np.pi
    except NotMeasured:
        return False


def yaw_rate_error(run: Recording, vehicle: Vehicle) -> float:
    """Root mean square of the yaw rate less that of the linear car, while the car moves [rad/s].

    r = u delta/(L + K_us u |u|) with the understeer gradient at small slip, ahead or in reverse, within +-mu g/u by the
    mean available friction; without tyres there is no such limit. After Rajamani, Vehicle Dynamics
    and Control, 2012, chapter 8.
    """
    _refuse_slip_speed(vehicle)
    speed, turned = channel(run, "twist.longitudinal"), _turning_angle(run, vehicle)
    # u |u| is negative in reverse, where the rear axle leads: the sign is in the gradient.
    gradient = np.where(
        speed < 0.0, -understeer_gradient(vehicle, ahead=-1.0), understeer_gradient(vehicle)
    )
    # Beyond its critical speed the linear car has no steady turn: only friction limits what it
    # would do.
    length = np.maximum(vehicle.wheelbase + gradient * speed**2, _LEAST_LENGTH * vehicle.wheelbase)
    wanted = speed * turned / length
    if f"tire_forces.friction_coefficient.{WHEEL_NAMES[0]}" in run.channels:
        friction = np.mean(of_wheels(run, "tire_forces.friction_coefficient"), axis=0)
        # |a_y| = |u r| cannot exceed mu g, so |r| cannot exceed mu g/|u|.
        limit = friction * GRAVITY / np.maximum(np.abs(speed), motion.SLOWEST)
        wanted = np.clip(wanted, -limit, limit)
    error = (channel(run, motion.YAW_RATE) - wanted)[motion.moving(run)]
    if not len(error):
        raise NotMeasured("the car does not move")
    return float(np.sqrt(np.mean(error**2)))


def _turning_angle(run: Recording, vehicle: Vehicle) -> np.ndarray:
    """Angle of the front wheels less that of the rear ones, by which a car turns, (n,) [rad]."""
    angle = front_wheel_angle(run, vehicle)
    return angle * (1.0 - vehicle.rear_steering_ratio) - run.channels.get(
        "rear_steering.state.angle", 0.0
    )


def measured_understeer_gradient(run: Recording, vehicle: Vehicle) -> float:
    """Slope of delta - L a_y/V^2 over a_y, before it is first beyond GRADIENT_RANGE [rad s^2/m].

    Both count into the bend: delta, the angle of the front wheels less that of the rear ones, is
    below zero where an oversteering car beyond its critical speed is steered against it.
    NotMeasured unless the car turns steadily all the while, as on a slow ramp of the steering wheel
    or a circle (ISO 4138): elsewhere the angle also turns the car, and the slope is no property of
    it.
    """
    # By magnitude, and the angle by the side of the acceleration: left and right bends give the
    # same.
    to_left = motion.lateral_acceleration_on_path(run)
    across = np.abs(to_left)
    _refuse_unsteady(run, across)
    rolling = vehicle.wheelbase * across / np.maximum(motion.speed(run), motion.SLOWEST) ** 2
    beyond = np.sign(to_left) * _turning_angle(run, vehicle) - rolling
    return motion.line_over(across, beyond, *GRADIENT_RANGE)[0]


def _refuse_unsteady(run: Recording, across: np.ndarray) -> None:
    """Check that the car turns steadily, in bends in which L/R is the angle of rolling.

    Raises NotMeasured if it does not.
    """
    low, high = GRADIENT_RANGE
    beyond = np.flatnonzero(across > high)
    if len(run.time) < 2 or not len(beyond):
        return  # `motion.line_over` gives the reason
    speed = motion.speed(run)
    # a_y = V (r + beta'): what V r does not explain is V beta'.
    of_sideslip = np.abs(across - speed * np.abs(channel(run, motion.YAW_RATE)))
    of_speed = np.abs(np.gradient(speed, run.time))
    # Over a while, not from sample to sample: noise of a sensor would count as change.
    before = np.interp(run.time - WHILE, run.time, across)
    rate, angle = (across - before) / WHILE, np.abs(channel(run, motion.ROAD_WHEEL_ANGLE))
    # The samples over which the slope is taken, and no others.
    counts = (np.arange(len(across)) < beyond[0]) & (across >= low)
    for values, most, what in (
        (np.maximum(of_sideslip, of_speed), UNSTEADY, "its sideslip or speed changes"),
        (np.abs(rate), FASTEST_CHANGE, "its lateral acceleration changes"),
        (angle, LARGEST_ANGLE, "its front wheels are turned far"),
    ):
        found = np.flatnonzero(counts & (values > most))
        if len(found):
            raise NotMeasured(f"the car does not turn steadily: {what} at {run.time[found[0]]:g} s")


def peak_slip_ratio(run: Recording) -> float:
    """Largest magnitude of the slip ratio of any wheel while the car moves [1]."""
    # At rest a slip ratio divides by next to nothing; there it counts as 0.
    return float(np.abs(of_wheels(run, "tire_forces.slip_ratio") * motion.moving(run)).max())


def slip_energy(run: Recording, vehicle: Vehicle) -> float:
    """Work that slip of the tyres takes, along and across [J].

    Trapezoidal rule between the samples.
    """
    power = np.zeros_like(run.time)
    for wheel in WHEEL_NAMES:
        for part in slip_powers(run, vehicle, wheel):
            power += part
    return float(np.trapezoid(power, run.time))


def slip_powers(run: Recording, vehicle: Vehicle, wheel: str) -> tuple[np.ndarray, np.ndarray]:
    """Force of a tyre times its slip speed, along and across the wheel, (n,) each [W]."""
    vx, vy, yaw_rate = (
        channel(run, f"twist.{name}") for name in ("longitudinal", "lateral", "yaw_rate")
    )
    number, (cosine, sine) = WHEEL_NAMES.index(wheel), wheel_directions(run, vehicle)[wheel]
    x, y = (places[number] for places in wheel_places(vehicle))
    # Velocity of the wheel's centre in axes of the car, v + r x place; the centre of mass of a body
    # that rolls sways over it.
    sway = vehicle.rolling_body.lever * run.channels.get(motion.ROLL_RATE, 0.0)
    ground_x, ground_y = vx - y * yaw_rate, vy + sway + x * yaw_rate
    radius = vehicle.wheel_radius_ratio[number] * vehicle.wheel_radius
    # Rim less ground: positive when driving, as the force is, so the power is what friction takes.
    slip_x = radius * channel(run, f"wheel_states.velocity.{wheel}") - (
        ground_x * cosine + ground_y * sine
    )
    # The lateral velocity with its sign changed, for the side force acts against it.
    slip_y = ground_x * sine - ground_y * cosine
    along, across = (
        channel(run, f"tire_forces.{kind}_force.{wheel}") for kind in ("longitudinal", "lateral")
    )
    return along * slip_x, across * slip_y


def drive_work(run: Recording) -> np.ndarray:
    """Work of the drives at the wheels since the start, (n,) [J].

    Mean torque over a step times the angle turned in it.
    """
    work = np.zeros(len(run.time))
    for wheel in WHEEL_NAMES:
        turned = np.diff(channel(run, f"wheel_states.position.{wheel}"))
        # The effort of a sample is the mean of the period that ends there.
        work[1:] += np.cumsum(channel(run, f"wheel_states.effort.{wheel}")[1:] * turned)
    return work


def time_over_limit(run: Recording, vehicle: Vehicle, surfaces: Iterable[Surface]) -> float:
    """Time in which any wheel of the moving car slips beyond the peak of its friction curve [s].

    The slip is the resultant of slip ratio and sine of the slip angle; `surfaces` are those of the
    road: under a wheel lies the one with the friction closest to the one that is available there.
    """
    friction = of_wheels(run, "tire_forces.friction_coefficient")
    known = _peak_slips(vehicle, surfaces)
    if not known:
        raise NotMeasured("the surfaces of the road are not known")
    available, peaks = np.array(list(known.items())).T
    # By the closest friction, since a recorded one may have noise.
    limit = peaks[np.abs(friction[..., None] - available).argmin(axis=-1)]
    across = np.sin(of_wheels(run, "tire_forces.slip_angle"))
    over = (np.hypot(of_wheels(run, "tire_forces.slip_ratio"), across) > limit).any(
        axis=0
    ) & motion.moving(run)
    # A sample stands for the period that ends there.
    return float(np.diff(run.time)[over[1:]].sum())


def _peak_slips(vehicle: Vehicle, surfaces: Iterable[Surface]) -> Mapping[float, float]:
    """Available friction [1] -> slip of the peak [1], of each surface."""
    _refuse_slip_speed(vehicle)
    return {
        tyre_on_road(vehicle.tyre, surface).friction: curve_on_road(vehicle.tyre, surface)[1]
        for surface in surfaces
    }


def _refuse_slip_speed(vehicle: Vehicle) -> None:
    if vehicle.tyre.curve == "dry_friction":
        raise NotMeasured("the tyre's friction follows the slip speed, not the slip")


def of_wheels(run: Recording, quantity: str) -> np.ndarray:
    """The channels of a quantity of all four wheels, (4, n), in its unit."""
    return np.array([channel(run, f"{quantity}.{wheel}") for wheel in WHEEL_NAMES])


def turning_in(run: Recording) -> int:
    """The first sample with turned front wheels; NotMeasured if there is none."""
    return motion.first(channel(run, motion.ROAD_WHEEL_ANGLE) != 0.0, "steering")


def when_passing(run: Recording, speed: float, values: np.ndarray) -> float:
    """The value of (n,) at the instant at which the run passes a speed [m/s] after turning in."""
    start, actual = turning_in(run), motion.path_speed(run)
    # Then the crossing would be one before the bend, and its value no effect of the bend.
    if actual[start] >= speed:
        raise NotMeasured(f"the car is faster than {speed:g} m/s before the bend")
    time = motion.crossing_time(run.time[start:], actual[start:], speed, f"{speed:g} m/s")
    return motion.value_at(run, values, time)


def total_force(run: Recording) -> np.ndarray:
    """Sum of the magnitudes of the four tyre forces in the plane of the road, (n,) [N]."""
    along, across = (
        of_wheels(run, f"tire_forces.{kind}_force") for kind in ("longitudinal", "lateral")
    )
    return np.hypot(along, across).sum(axis=0)


def energy_since_turning_in(run: Recording) -> np.ndarray:
    """Work of the drives at the wheels since the front wheels are turned, (n,) [J]."""
    work = drive_work(run)
    return work - work[turning_in(run)]


def time_since_turning_in(run: Recording) -> np.ndarray:
    """Time since the front wheels are turned, (n,) [s]."""
    return run.time - run.time[turning_in(run)]


def surfaces_under(run: Recording, vehicle: Vehicle, wheel: str) -> np.ndarray:
    """Surface of the table with the friction closest to that under the wheel, (n,) str.

    The closest one, for a sensor may add noise. Surfaces with the same friction for the tyre are
    not distinguished, and those of one's own are not known here.
    """
    friction = channel(run, f"tire_forces.friction_coefficient.{wheel}")
    available = np.array([tyre_on_road(vehicle.tyre, name).friction for name in SURFACES])
    return np.array(tuple(SURFACES))[np.abs(friction[:, None] - available).argmin(axis=1)]


def share_of(run: Recording, vehicle: Vehicle, wheel: str, prefix: str) -> float:
    """Share of the driven distance on surfaces with this prefix under the wheel [1]."""
    distance = distance_on_path(run)
    if distance[-1] <= 0.0:
        raise NotMeasured("the car has not moved")
    # A sample stands for the way from the one before it, so the first has none.
    on_it = np.char.startswith(surfaces_under(run, vehicle, wheel)[1:], prefix)
    return float(np.diff(distance)[on_it].sum() / distance[-1])
