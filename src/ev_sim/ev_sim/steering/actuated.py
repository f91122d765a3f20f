"""A steering wheel without mechanical connection, and an electric actuator that turns the road wheels (Shchur 2019)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import Car, Vehicle, compilable, entry, group, method, parameter, part
from ev_msgs_py.contract.signals import DriverCommand, SteeringColumnState, WheelStates
from ev_sim.steering.actuator import Servo, SteeringMotorParameters, SteeringMotorState, servo, turn
from ev_sim.steering.by_wire import SteeringWheelParameters
from ev_sim.steering.friction_oscillator import Oscillator, oscillated, oscillator
from ev_sim.steering.road_wheels import drive_moment, speed_difference


@dataclass(frozen=True, slots=True)
class FeelParameters:
    """The motor at the steering wheel; the source has none."""

    share: float = parameter(
        0.0,
        unit="1",
        low=0.0,
        high=5.0,
        about="of the moment of the road on the road wheels over the steering ratio that the motor brings to the "
        "steering wheel; 1 feels like a mechanical column",
        source="Shchur 2019, introduction: no feedback; a motor for it is an assumption",
    )
    peak_torque: float = parameter(8.0, unit="N m", low=0.0, high=100.0, about="largest torque at the steering wheel")
    copper_loss: float = parameter(
        2.0, unit="W/(N m)^2", low=0.0, high=1e4, about="loss in the windings over squared torque"
    )


@dataclass(frozen=True, slots=True)
class ActuatedParameters:
    """The actuator with the road wheels, the steering wheel, and what the road wheels feel besides."""

    actuator: SteeringMotorParameters = group(
        SteeringMotorParameters, wheel_inertia=2.8, damping=7.5, max_angle=0.7, max_rate=1.0
    )
    stiffness: float = parameter(
        65.0,
        unit="N m/rad",
        low=0.0,
        high=1e5,
        about="restoring stiffness of the road wheels, k_p",
        source="Shchur 2019",
    )
    drive_inertia: float = parameter(
        0.0,
        unit="kg m^2",
        low=0.0,
        high=100.0,
        about="inertia of one wheel with its drive, J_k in eq 3",
        source="Shchur 2019, eqs 1 and 3",
    )
    steering_wheel: SteeringWheelParameters = group(SteeringWheelParameters)
    feel: FeelParameters = group(FeelParameters)


@dataclass(slots=True)
class ActuatedState:
    """Road wheels with their motor, steering wheel, hands, and the front wheels; left positive."""

    actuator: SteeringMotorState = part(SteeringMotorState)
    angle: float = entry(unit="rad", about="of the steering wheel")
    rate: float = entry(unit="rad/s", about="of the steering wheel")
    hand_torque: float = entry(unit="N m", about="what acted up to now")
    feel: float = entry(unit="N m", about="torque of the motor at the steering wheel")
    feel_power: float = entry(unit="W", about="that it takes, mean over the last period")
    wheel_speed_difference: float = entry(unit="rad/s", about="right minus left front wheel, a period ago")


class Moved(NamedTuple):
    """What moves."""

    servo: Servo
    steering_wheel: Oscillator


def moved(p: ActuatedParameters, vehicle: Vehicle, period: float) -> Moved:
    """The actuator over a period [s], and the steering wheel with the end stops of a connected one."""
    wheel, stop = p.steering_wheel, vehicle.steering_ratio * p.actuator.max_angle
    turned = oscillator(wheel.inertia, wheel.damping, wheel.centring_stiffness, wheel.dry_friction, stop, period)
    return Moved(servo(p.actuator, period), turned)


@compilable
def shown(s: ActuatedState) -> SteeringColumnState:
    """The column at this instant; the hand torque is the one that acted up to now."""
    return SteeringColumnState(s.angle, s.rate, s.hand_torque, s.actuator.angle, s.actuator.rate)


@method(
    "steering_column", "actuated", ActuatedParameters, state=ActuatedState, prepare=moved, outputs=shown, mirrored=True
)
@compilable
def actuated(
    p: ActuatedParameters,
    car: Car,
    c: Moved,
    s: ActuatedState,
    period: float,
    driver: DriverCommand,
    wheels: WheelStates,
) -> None:
    """Turn the road wheels by an actuator to the angle that the steering wheel sets; the hands do not reach them.

    Steer-by-wire as in the introduction of Shchur (2019): wanted angle a/i, a dedicated electric actuator with a
    position loop (`steering_actuator.motor`), no feedback to the column (`feel.share` 0). Road wheels: eq 3 with the
    actuator in the place of i M_b, so the torque difference of the drives disturbs. Steering wheel: as `by_wire`, and
    the motor's torque, `feel.share` times the moment of the road over i, as a sensor at the rack shows it (the torque
    of the actuator would bring its own acceleration back, and swing). Left positive.
    """
    road = drive_moment(car, p.drive_inertia, period, wheels, s.wheel_speed_difference) - p.stiffness * s.actuator.angle
    s.wheel_speed_difference = speed_difference(wheels)
    s.hand_torque = driver.hand_torque
    felt = p.feel.share * road / car.steering_ratio
    s.feel = min(max(felt, -p.feel.peak_torque), p.feel.peak_torque)
    turn(p.actuator, c.servo, s.actuator, s.angle / car.steering_ratio, road)
    angle = s.angle
    s.angle, s.rate = oscillated(c.steering_wheel, angle, s.rate, driver.hand_torque + s.feel)
    s.feel_power = s.feel * (s.angle - angle) / period + p.feel.copper_loss * (s.feel * s.feel)
