"""Steering columns by eq 3 of Shchur (2019): by hand, with the front drives, by these alone.

How it works: a column is an oscillator (`friction_oscillator`) under a moment that is held over a
period. `manual` has the moment of the hands, `powered` that of the drives as well. `by_wire` has
two oscillators: road wheels under the drives, and a steering wheel under the hands.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

from ev_core.law import Car, Vehicle, compilable, entry, group, method, parameter
from ev_msgs_py.contract.signals import DriverCommand, SteeringColumnState, WheelStates
from ev_sim.steering.friction_oscillator import Oscillator, oscillated, oscillator

steering_column = partial(method, "steering_column", mirrored=True)


class Turned(NamedTuple):
    """Signals of what turns the road wheels: the hands, and the drives of the front wheels."""

    driver: DriverCommand
    wheels: WheelStates


@compilable
def drive_moment(
    car: Car, wheel_inertia: float, period: float, wheels: WheelStates, s: Any
) -> float:
    """Steering moment of the drive forces, left positive [N m].

    d/(2 r_k) (M_R - M_L) - J_k d/(2 r_k) (w_R' - w_L'). The torques are the actual ones at the
    wheels. The wheel accelerations of a period are the difference of the speeds at its two ends
    before, so they come one period late: the column reads no later speed. The state keeps them as
    `wheel_speed_difference`.
    """
    # A drive force M/r_k acts half a track beside the middle of the axle: the difference of both
    # turns the wheels.
    lever = car.front_track / (2 * car.wheel_radius)
    torque_difference = wheels.effort.front_right - wheels.effort.front_left
    speed_difference = wheels.velocity.front_right - wheels.velocity.front_left
    acceleration_torque = wheel_inertia / period * (speed_difference - s.wheel_speed_difference)
    s.wheel_speed_difference = speed_difference
    return lever * (torque_difference - acceleration_torque)


@dataclass(frozen=True, slots=True)
class RoadWheelParameters:
    """The steering system at the road wheels (eq 3 without the drives)."""

    inertia: float = parameter(
        2.8,
        unit="kg m^2",
        low=0.001,
        high=1000.0,
        about="inertia of the steering system, J_p",
        source="Shchur 2019",
    )
    damping: float = parameter(
        7.5,
        unit="N m s/rad",
        low=0.0,
        high=10000.0,
        about="viscous friction, b_p",
        source="Shchur 2019",
    )
    stiffness: float = parameter(
        65.0,
        unit="N m/rad",
        low=0.001,
        high=100000.0,
        about="restoring stiffness, k_p",
        source="Shchur 2019",
    )
    dry_friction: float = parameter(
        0.0,
        unit="N m",
        low=0.0,
        high=1000.0,
        about="dry friction, M_c, the same at rest and in motion; the paper gives no value, 0 "
        "reproduces eqs 6 and 7",
        source="Shchur 2019, eq 3",
    )
    max_angle: float = parameter(
        2.0,
        unit="rad",
        low=0.01,
        high=3.14,
        about="of the end stops, beyond the paper's runs; a car has about 0.7",
    )


@dataclass(frozen=True, slots=True)
class DrivenRoadWheelParameters(RoadWheelParameters):
    """The steering system at the road wheels, with the difference of the drive forces (eq 3)."""

    wheel_inertia: float = parameter(
        0.0,
        unit="kg m^2",
        low=0.0,
        high=100.0,
        about="inertia of one wheel with its drive, J_k in eq 3; 0 neglects that term as the "
        "paper does",
        source="Shchur 2019, eqs 1 and 3",
    )


def road_wheels(parameters: RoadWheelParameters, _vehicle: Vehicle, period: float) -> Oscillator:
    """The motion of the road wheels (eq 3), exact over a period [s]."""
    p = parameters
    return oscillator(p.inertia, p.damping, p.stiffness, p.dry_friction, p.max_angle, period)


@dataclass(slots=True)
class ManualState:
    """The road wheels and the hands; left positive."""

    road_wheel_angle: float = entry(unit="rad")
    road_wheel_rate: float = entry(unit="rad/s")
    hand_torque: float = entry(unit="N m", about="what acted up to now")


@compilable
def connected_column(car: Car, s: ManualState) -> SteeringColumnState:
    """Measured values of a mechanically connected column.

    The steering wheel turns i times as far. The hand torque is the one that acted up to now.
    """
    ratio = car.steering_ratio
    angle = s.road_wheel_angle
    rate = s.road_wheel_rate
    return SteeringColumnState(ratio * angle, ratio * rate, s.hand_torque, angle, rate)


@steering_column(
    "manual", parameters=RoadWheelParameters, prepare=road_wheels, outputs=connected_column
)
@compilable
def manual(car: Car, c: Oscillator, s: ManualState, driver: DriverCommand) -> None:
    """Turn the road wheels by hand alone; the drive forces have no lever arm.

    J_p d'' + b_p d' + k_p d = i M_b - M_c sgn(d'), with d the road-wheel angle and M_b the hand
    torque at the steering wheel, both left positive; the steering-wheel angle is i d. Shchur
    (2019), eqs 3 and 6.
    """
    s.hand_torque = driver.hand_torque
    # Through the gear the hands have i times their torque at the road wheels.
    moment = car.steering_ratio * driver.hand_torque
    s.road_wheel_angle, s.road_wheel_rate = oscillated(
        c, s.road_wheel_angle, s.road_wheel_rate, moment
    )


@dataclass(slots=True)
class PoweredState(ManualState):
    """The same, and the front wheels."""

    wheel_speed_difference: float = entry(
        unit="rad/s", about="right minus left front wheel, a period ago"
    )


@steering_column("powered", prepare=road_wheels, outputs=connected_column)
@compilable
def powered(
    p: DrivenRoadWheelParameters,
    car: Car,
    c: Oscillator,
    s: PoweredState,
    period: float,
    read: Turned,
) -> None:
    """Turn the road wheels by hand and by the difference of the front drive torques (eq 3 in full).

    J_p d'' + b_p d' + k_p d = d_track/(2 r_k) (M_R - M_L) + i M_b - M_c sgn(d') - J_k d_track/(2
    r_k) (w_R' - w_L'), with d the road-wheel angle, M_R and M_L the actual drive torques of the
    front wheels and M_b the hand torque at the steering wheel; left positive; the steering-wheel
    angle is i d. Shchur (2019), eq 3. The wheels start at rest.
    """
    moment = drive_moment(car, p.wheel_inertia, period, read.wheels, s)
    moment += car.steering_ratio * read.driver.hand_torque
    s.hand_torque = read.driver.hand_torque
    s.road_wheel_angle, s.road_wheel_rate = oscillated(
        c, s.road_wheel_angle, s.road_wheel_rate, moment
    )


@dataclass(frozen=True, slots=True)
class SteeringWheelParameters:
    """The steering wheel on its own, at the steering wheel; the paper describes none."""

    inertia: float = parameter(
        0.04, unit="kg m^2", low=0.001, high=1.0, about="inertia, as of an ordinary steering wheel"
    )
    damping: float = parameter(
        0.16, unit="N m s/rad", low=0.0, high=10.0, about="viscous friction, about 0.8 of critical"
    )
    centring_stiffness: float = parameter(
        0.25,
        unit="N m/rad",
        low=0.001,
        high=10.0,
        about="centring spring, as stiff as a mechanical column: k_p/i^2",
    )
    dry_friction: float = parameter(0.0, unit="N m", low=0.0, high=10.0, about="dry friction")


def steering_wheel(p: SteeringWheelParameters, stop: float, period: float) -> Oscillator:
    """The motion of the steering wheel within its end stops [rad], exact over a period [s]."""
    return oscillator(p.inertia, p.damping, p.centring_stiffness, p.dry_friction, stop, period)


@dataclass(frozen=True, slots=True)
class ByWireParameters(DrivenRoadWheelParameters):
    """The road wheels of eq 3, and a steering wheel that does not reach them."""

    steering_wheel: SteeringWheelParameters = group(SteeringWheelParameters)


@dataclass(slots=True)
class ByWireState(PoweredState):
    """The same, and the steering wheel."""

    angle: float = entry(unit="rad", about="of the steering wheel")
    rate: float = entry(unit="rad/s", about="of the steering wheel")


class Moving(NamedTuple):
    """Motions of their own."""

    road_wheels: Oscillator
    steering_wheel: Oscillator


def oscillators(parameters: ByWireParameters, vehicle: Vehicle, period: float) -> Moving:
    """Road wheels and steering wheel, exact over a period [s].

    The latter has the end stops of a connected one.
    """
    wheel = steering_wheel(
        parameters.steering_wheel, vehicle.steering_ratio * parameters.max_angle, period
    )
    return Moving(road_wheels(parameters, vehicle, period), wheel)


@compilable
def shown(s: ByWireState) -> SteeringColumnState:
    """The column at this instant; the hand torque is the one that acted up to now."""
    return SteeringColumnState(
        s.angle, s.rate, s.hand_torque, s.road_wheel_angle, s.road_wheel_rate
    )


@steering_column("by_wire", prepare=oscillators, outputs=shown)
@compilable
def by_wire(
    p: ByWireParameters,
    car: Car,
    c: Moving,
    s: ByWireState,
    period: float,
    read: Turned,
) -> None:
    """Turn the road wheels by the front drives alone.

    The hands turn a steering wheel with a centring spring. Road wheels: eq 3 of Shchur (2019) with
    M_b = 0, as in its steer-by-wire and drive-by-wire concepts. Steering wheel: J a'' + b a' + k a
    = M_b - M sgn(a'), end stops at i times those of the road wheels. Left positive.
    """
    moment = drive_moment(car, p.wheel_inertia, period, read.wheels, s)
    s.hand_torque = read.driver.hand_torque
    s.angle, s.rate = oscillated(c.steering_wheel, s.angle, s.rate, read.driver.hand_torque)
    s.road_wheel_angle, s.road_wheel_rate = oscillated(
        c.road_wheels, s.road_wheel_angle, s.road_wheel_rate, moment
    )
