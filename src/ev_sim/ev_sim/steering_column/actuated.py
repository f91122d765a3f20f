"""A steering wheel without mechanical connection, and an electric actuator that turns the road wheels (Shchur 2019)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.record import entry, part
from ev_msgs_py.contract.signals import DriverCommand, WheelStates
from ev_msgs_py.lockstep.methods import method
from ev_msgs_py.parameters.declaration import group, parameter
from ev_msgs_py.vehicle.car import Car
from ev_sim.steering_column.by_wire import ByWireParameters, ByWireState, Oscillators, oscillators, shown
from ev_sim.steering_column.drive_forces import drive_moment, speed_difference
from ev_sim.steering_column.friction_oscillator import oscillated
from ev_sim.steering_column.steering_motor import (
    SteeringMotorParameters,
    SteeringMotorState,
    book_work,
    steer_by_motor,
)


@dataclass(frozen=True, slots=True)
class AngleControlParameters:
    """The position loop of the actuator; the source only has it in the title of its reference 8."""

    proportional: float = parameter(
        1750.0, unit="N m/rad", low=0.0, high=1e6, about="per error of the road-wheel angle", source="assumption"
    )
    integral: float = parameter(
        5000.0, unit="N m/(rad s)", low=0.0, high=1e6, about="per integral of that error", source="assumption"
    )
    derivative: float = parameter(
        130.0, unit="N m s/rad", low=0.0, high=1e5, about="against the road-wheel rate", source="assumption"
    )


@dataclass(frozen=True, slots=True)
class ActuatedParameters(ByWireParameters):
    """Road wheels and steering wheel as by wire, the actuator between them, and a motor for road feel."""

    control: AngleControlParameters = group(AngleControlParameters)
    actuator: SteeringMotorParameters = group(SteeringMotorParameters)
    feel: float = parameter(
        0.0,
        unit="1",
        low=0.0,
        high=5.0,
        about="share of the actuator's torque that a motor brings to the steering wheel, over the steering ratio; 1 "
        "feels like a mechanical column",
        source="Shchur 2019, introduction: no feedback to the column; a motor for it is an assumption",
    )
    feel_motor: SteeringMotorParameters = group(SteeringMotorParameters, gear_ratio=10.0, peak_torque=1.0)


@dataclass(slots=True)
class ActuatedState(ByWireState):
    """The same, and both motors."""

    integral: float = entry(unit="N m", about="integral part of the angle control")
    actuator: SteeringMotorState = part(SteeringMotorState)
    feel_motor: SteeringMotorState = part(SteeringMotorState)


@method(
    "steering_column",
    "actuated",
    ActuatedParameters,
    state=ActuatedState,
    prepare=oscillators,
    outputs=shown,
    mirrored=True,
)
@compilable
def actuated(
    p: ActuatedParameters,
    car: Car,
    c: Oscillators,
    s: ActuatedState,
    period: float,
    driver: DriverCommand,
    wheels: WheelStates,
) -> None:
    """Turn the road wheels to the angle that the steering wheel sets, a/i, by an actuator with a PID position loop.

    Steer-by-wire as in the introduction of Shchur (2019): the steering wheel sets the angle only, a dedicated electric
    actuator turns the wheels, the column feels nothing (`feel` 0). Road wheels: eq 3 with the actuator in the place of
    i M_b, so the drives' torque difference is a disturbance. Steering wheel: as `by_wire`, and the torque of the
    feel motor, minus `feel` times the actuator's over i. Left positive.
    """
    drives = drive_moment(car, p.wheel_inertia, period, wheels, s.wheel_speed_difference)
    s.wheel_speed_difference = speed_difference(wheels)
    s.hand_torque = driver.hand_torque
    control, most = p.control, p.actuator.peak_torque * p.actuator.gear_ratio
    error = s.angle / car.steering_ratio - s.road_wheel_angle
    s.integral = min(max(s.integral + control.integral * error * period, -most), most)
    wanted = control.proportional * error + s.integral - control.derivative * s.road_wheel_rate
    feel = -p.feel * s.actuator.torque / car.steering_ratio
    hands = driver.hand_torque + steer_by_motor(p.feel_motor, s.feel_motor, feel, s.rate, period)
    moment = drives + steer_by_motor(p.actuator, s.actuator, wanted, s.road_wheel_rate, period)
    angle, road_wheel_angle = s.angle, s.road_wheel_angle
    s.angle, s.rate = oscillated(c.steering_wheel, angle, s.rate, hands)
    s.road_wheel_angle, s.road_wheel_rate = oscillated(c.road_wheels, road_wheel_angle, s.road_wheel_rate, moment)
    book_work(s.feel_motor, angle, s.angle)
    book_work(s.actuator, road_wheel_angle, s.road_wheel_angle)
