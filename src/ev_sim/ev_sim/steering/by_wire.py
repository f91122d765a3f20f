"""A steering wheel without mechanical connection; only the front drives turn the road wheels (Shchur 2019)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import Car, Vehicle, compilable, entry, group, method, parameter
from ev_msgs_py.contract.signals import DriverCommand, SteeringColumnState, WheelStates
from ev_sim.steering.friction_oscillator import Oscillator, oscillated, oscillator
from ev_sim.steering.road_wheels import DrivenRoadWheelParameters, drive_moment, road_wheels, speed_difference


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
        about="centring spring, as stiff as the mechanical column feels, k_p/i^2",
    )
    dry_friction: float = parameter(0.0, unit="N m", low=0.0, high=10.0, about="dry friction")


@dataclass(frozen=True, slots=True)
class ByWireParameters(DrivenRoadWheelParameters):
    """The road wheels of eq 3, and a steering wheel that does not reach them."""

    steering_wheel: SteeringWheelParameters = group(SteeringWheelParameters)


@dataclass(slots=True)
class ByWireState:
    """Road wheels and steering wheel, the hands, and the front wheels; left positive."""

    road_wheel_angle: float = entry(unit="rad")
    road_wheel_rate: float = entry(unit="rad/s")
    angle: float = entry(unit="rad", about="of the steering wheel")
    rate: float = entry(unit="rad/s", about="of the steering wheel")
    hand_torque: float = entry(unit="N m", about="what acted up to now")
    wheel_speed_difference: float = entry(unit="rad/s", about="right minus left front wheel, a period ago")


class Oscillators(NamedTuple):
    """What moves on its own."""

    road_wheels: Oscillator
    steering_wheel: Oscillator


def oscillators(parameters: ByWireParameters, vehicle: Vehicle, period: float) -> Oscillators:
    """Road wheels and steering wheel, exact over a period [s]; the latter has the end stops of a connected one."""
    wheel = parameters.steering_wheel
    steering_wheel = oscillator(
        wheel.inertia,
        wheel.damping,
        wheel.centring_stiffness,
        wheel.dry_friction,
        vehicle.steering_ratio * parameters.max_angle,
        period,
    )
    return Oscillators(road_wheels(parameters, vehicle, period), steering_wheel)


@compilable
def shown(s: ByWireState) -> SteeringColumnState:
    """The column at this instant; the hand torque is the one that acted up to now."""
    return SteeringColumnState(s.angle, s.rate, s.hand_torque, s.road_wheel_angle, s.road_wheel_rate)


@method(
    "steering_column", "by_wire", ByWireParameters, state=ByWireState, prepare=oscillators, outputs=shown, mirrored=True
)
@compilable
def by_wire(
    p: ByWireParameters,
    car: Car,
    c: Oscillators,
    s: ByWireState,
    period: float,
    driver: DriverCommand,
    wheels: WheelStates,
) -> None:
    """Turn the road wheels by the front drives alone; the hands turn a steering wheel with a centring spring.

    Road wheels: eq 3 of Shchur (2019) with M_b = 0, as in its steer-by-wire and drive-by-wire concepts. Steering
    wheel: J a'' + b a' + k a = M_b - M sgn(a'), end stops at i times those of the road wheels. Left positive.
    """
    moment = drive_moment(car, p.wheel_inertia, period, wheels, s.wheel_speed_difference)
    s.wheel_speed_difference = speed_difference(wheels)
    s.hand_torque = driver.hand_torque
    s.angle, s.rate = oscillated(c.steering_wheel, s.angle, s.rate, driver.hand_torque)
    s.road_wheel_angle, s.road_wheel_rate = oscillated(c.road_wheels, s.road_wheel_angle, s.road_wheel_rate, moment)
