"""A driver that follows commands from outside; the node writes the newest one into its state."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import Car, compilable, entry, group, method, parameter, part
from ev_core.vehicle.car import speed_along_path
from ev_msgs_py.contract.signals import BodyVelocity, DriverCommand, SteeringColumnState
from ev_sim.driver.followers import AngleControlParameters, AngleControlState, turn_to_angle
from ev_sim.driver.pedals import SpeedControlParameters, SpeedControlState, follow_speed


@dataclass(frozen=True, slots=True)
class CommandedParameters:
    """Parameters of pedals and steering behind a command, and of the stop without one."""

    speed_control: SpeedControlParameters = group(SpeedControlParameters)
    angle_control: AngleControlParameters = group(AngleControlParameters)
    commands_last: float = parameter(
        0.5, unit="s", low=0.01, high=10.0, about="a command holds for this simulated time"
    )
    stopping_deceleration: float = parameter(
        3.0,
        unit="m/s^2",
        low=0.1,
        high=10.0,
        about="by which the car is brought to rest without a command",
    )


@dataclass(slots=True)
class CommandedState:
    """The command, what has been made of it, and what the node reports."""

    wanted_speed: float = entry(unit="m/s", about="of the command, negative backwards")
    lowest_speed: float = entry(unit="m/s", about="that the gear allows")
    highest_speed: float = entry(unit="m/s", about="that the gear allows")
    in_neutral: float = entry(unit="", about="1: the drives are let go")
    acceleration: float = entry(unit="m/s^2", about="largest magnitude that the command allows")
    wanted_angle: float = entry(unit="rad", about="road-wheel angle of the command")
    angle_rate: float = entry(unit="rad/s", about="largest rate that the command allows")
    left: float = entry(unit="s", about="for which the command still holds")
    held: float = entry(
        -1.0, unit="", about="1: a command holds; 0: none; -1: before the first step"
    )
    speed: float = entry(unit="m/s", about="that the feet follow now")
    angle: float = entry(unit="rad", about="road-wheel angle that the hands follow now")
    longitudinal: float = entry(unit="m/s", about="velocity of the centre of mass, forwards")
    lateral: float = entry(unit="m/s", about="velocity of the centre of mass, to the left")
    yaw_rate: float = entry(unit="rad/s", about="left positive")
    road_wheel_angle: float = entry(unit="rad", about="mean of the front wheels")
    feet: SpeedControlState = part(SpeedControlState)
    hands: AngleControlState = part(AngleControlState)


@compilable
def towards(value: float, goal: float, most: float) -> float:
    """The value after a change towards the goal, by no more than this."""
    return value + min(max(goal - value, -most), most)


@method("driver", "commanded")
@compilable
def commanded(
    p: CommandedParameters,
    car: Car,
    s: CommandedState,
    period: float,
    body: BodyVelocity,
    column: SteeringColumnState,
) -> DriverCommand:
    """Follow speed and road-wheel angle of the command.

    A car without a fresh command comes to rest with the angle as it is.
    """
    speed = speed_along_path(body)
    holds = 1.0 if s.left > 0.0 else 0.0
    # A command that begins or ends: the speed goes on from what the car does, without a jump.
    if holds != s.held:
        s.held, s.speed = holds, speed
        # Until a command has turned them, the hands keep the angle that the wheels have.
        if s.angle == 0.0:
            s.angle = column.road_wheel_angle
    # The node sets it anew with each command.
    s.left = max(s.left - period, 0.0)
    wanted, most, rate = 0.0, p.stopping_deceleration, 0.0
    if holds == 1.0:
        wanted = min(max(s.wanted_speed, s.lowest_speed), s.highest_speed)
        most, rate = s.acceleration, s.angle_rate
    s.speed = towards(s.speed, wanted, most * period)
    # An angle beyond the stop of the wheels would have to come back before they turn.
    most_angle = car.maximum_road_wheel_angle
    wanted_angle = min(max(s.wanted_angle, -most_angle), most_angle)
    # Without a command the rate is 0, so the angle stays.
    s.angle = towards(s.angle, wanted_angle, rate * period)
    drive, brake = follow_speed(p.speed_control, car, s.feet, period, s.speed, speed)
    # The integral is cleared, or the car would jerk when the gear is put in again.
    if holds == 1.0 and s.in_neutral == 1.0:
        s.speed, s.feet.integral, drive, brake = speed, 0.0, 0.0, 0.0
    # Copied for the reports of the node, which reads this state and no topic.
    s.longitudinal, s.lateral, s.yaw_rate = body.longitudinal, body.lateral, body.yaw_rate
    s.road_wheel_angle = column.road_wheel_angle
    return DriverCommand(
        drive,
        brake,
        turn_to_angle(p.angle_control, s.hands, period, car.steering_ratio * s.angle, column),
    )
