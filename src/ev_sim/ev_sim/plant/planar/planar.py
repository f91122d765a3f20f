"""The planar plant and its variants, as methods of the role `plant` (docs/planar_plant.md)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

from ev_core.law import Car, Vehicle, cos, group, inlined, method, per_wheel, sin, working_memory
from ev_core.vehicle.driveline import has_own_motors
from ev_msgs_py.contract.optional_signals import RearSteeringState, WheelSpeedCommand
from ev_msgs_py.contract.signals import SteeringColumnState, WheelTorqueCommand
from ev_sim.drives.synchronous_motor import SpeedModeParameters, speed_control_without_windup
from ev_sim.plant.guard import accepted, guarded_steering, guarded_torques
from ev_sim.plant.planar import planar_state as state
from ev_sim.plant.planar import shown
from ev_sim.plant.planar.body import book_push, integrate, push_at_wheels, steer
from ev_sim.plant.planar.contact import find_road
from ev_sim.plant.planar.given import (
    AT_WHEELS,
    SPEED_FREE,
    SPEED_IMPOSED,
    PlanarParameters,
    deflate,
    delay_commands,
    find_faults,
    load_files,
)
from ev_sim.plant.planar.powertrain import account, apply_drives
from ev_sim.plant.planar.prepare import PlanarConstants, prepare, prepare_electrical
from ev_sim.profiles.profile import value_at

# What all methods of this plant have, but for what they give themselves.
PLANAR: dict[str, Any] = {
    "state": state.PlanarState,
    "prepare": prepare,
    "start": shown.begin,
    "outputs": shown.outputs,
    "notes": shown.notes,
    "writes": shown.PLANAR_SIGNALS,
    "load_files": load_files,
    "heavy": True,
    "mirrored": True,
}


@method("plant", "planar", **PLANAR)
@inlined
def planar(
    p: PlanarParameters,
    car: Car,
    c: PlanarConstants,
    s: state.PlanarState,
    period: float,
    command: WheelTorqueCommand,
    column: SteeringColumnState,
) -> None:
    """Body in the plane, four wheels on real tyres and real roads, drives and battery (docs/planar_plant.md).

    Over one period the torques are held and the steering angle goes on at its rate, as the guard accepts them.
    """
    advance(p, car, c, s, period, command, column, apply_drives, account, working_memory(state.STEP_MEMORY))


@inlined
def advance(
    p: PlanarParameters,
    car: Car,
    c: PlanarConstants,
    s: state.PlanarState,
    period: float,
    command: WheelTorqueCommand,
    column: SteeringColumnState,
    apply: Callable[..., None],
    book: Callable[..., None],
    steps: list[state.Step],
) -> None:
    """All steps of a period, in memory of one record.

    `apply` sets the torques of a step as `apply_drives` does, `book` its energies as `account` does. The road-wheel
    angle goes on at its rate.
    """
    torques = guarded_torques(c.limits, s.guard, command)
    angle, rate = guarded_steering(c.limits, s.guard, column, period)
    if len(c.faults.kind) > 0 or s.faults.is_struck == 1.0:
        find_faults(p, c.faults, s, period)
    s.periods += 1.0
    s.imposed_acceleration = 0.0
    if p.speed == SPEED_IMPOSED:
        s.imposed_acceleration = (value_at(c.imposed, s.periods * period) - s.motion[state.VX]) / period
    step, h, y = steps[0], c.h, s.motion
    step.imposed_acceleration = s.imposed_acceleration
    for i in range(4):
        step.drive_command[i], step.brake_command[i] = torques.drive[i], torques.brake[i]
        s.mean_drive[i] = 0.0
    is_struck = s.faults.is_struck == 1.0
    if is_struck:
        delay_commands(s.faults, s.periods - 1.0, step)
    for n in range(int(c.steps)):
        find_road(y, c.body, step, c.road, n == 0 or is_struck)
        if is_struck:
            deflate(s.faults, p, car, c.body, step)
        time = (n + 0.5) * h
        steer(car, step, angle + rate * time, s.rear_angle + s.rear_rate * time)
        apply(p, car, c, s, step)
        if p.speed == SPEED_IMPOSED and p.imposed_at == AT_WHEELS:
            push_at_wheels(p, car, c.body, y, step)
        vx, vy, heading = y[state.VX], y[state.VY], y[state.HEADING]
        for i in range(4):
            step.turned[i] = -y[state.WHEEL_ANGLE + i]
        integrate(y, p, car, c.body, step, h)
        if s.periods * period <= p.initial_hold + 0.5 * period:
            y[state.VY], y[state.YAW_RATE] = p.initial_lateral_velocity, p.initial_yaw_rate
            if p.speed == SPEED_FREE:
                y[state.VX] = p.initial_speed
        for i in range(4):
            step.turned[i] += y[state.WHEEL_ANGLE + i]
            s.mean_drive[i] += step.drive[i] / c.steps
        if p.speed == SPEED_IMPOSED and p.imposed_at == AT_WHEELS:
            book_push(y, step)
        # The position feeds nothing back, so the trapezoidal rule over the step is enough.
        mean_x, mean_y = 0.5 * (vx + y[state.VX]), 0.5 * (vy + y[state.VY])
        middle = 0.5 * (heading + y[state.HEADING])
        cosine, sine = cos(middle), sin(middle)
        s.x += h * (mean_x * cosine - mean_y * sine)
        s.y += h * (mean_y * cosine + mean_x * sine)
        book(p, car, c, s, step)
    s.road_wheel_angle = angle + rate * (c.steps * h)
    shown.keep_noted(s, car, c.road)


@method(
    "plant",
    "planar_electrical",
    **PLANAR | {"prepare": prepare_electrical, "outputs": shown.electrical_outputs, "writes": shown.ELECTRICAL_SIGNALS},
)
@inlined
def planar_electrical(
    p: PlanarParameters,
    car: Car,
    c: PlanarConstants,
    s: state.PlanarState,
    period: float,
    command: WheelTorqueCommand,
    column: SteeringColumnState,
) -> None:
    """The planar plant with currents, voltages and temperatures of its motors, and cells (docs/electrical.md).

    Voltage of the DC link and temperatures limit the torque.
    """
    planar(p, car, c, s, period, command, column)


@method("plant", "planar_rear_steering", **PLANAR)
@inlined
def planar_rear_steering(
    p: PlanarParameters,
    car: Car,
    c: PlanarConstants,
    s: state.PlanarState,
    period: float,
    command: WheelTorqueCommand,
    column: SteeringColumnState,
    rear: RearSteeringState,
) -> None:
    """The planar plant with rear wheels that an actuator steers, besides the `rear_steering_ratio` of the car.

    Over a period the rear angle goes on at its rate, as the front one does, within the same limit.
    """
    limit = c.limits.angle
    s.rear_angle = accepted(s.guard, rear.angle, s.rear_angle, -limit, limit)
    s.rear_rate = accepted(s.guard, rear.rate, 0.0, (-limit - s.rear_angle) / period, (limit - s.rear_angle) / period)
    planar(p, car, c, s, period, command, column)
    s.rear_angle += s.rear_rate * period


@dataclass(frozen=True, slots=True)
class PlanarSpeedModeParameters(PlanarParameters):
    """The same, and the speed control of the drives."""

    speed_control: SpeedModeParameters = group(SpeedModeParameters)


@dataclass(slots=True)
class SpeedModeState(state.PlanarState):
    """The same, and what the speed controls keep."""

    set_point: list[float] = per_wheel(unit="rad/s", about="of the wheel speed that was accepted last")
    speed_integral: list[float] = per_wheel(unit="N m", about="integral part of the speed control, at the shaft")


def a_motor_for_each_wheel(_parameters: PlanarSpeedModeParameters, vehicle: Vehicle) -> str:
    """A drive controls the speed of its own wheel."""
    return "" if has_own_motors(vehicle) else "driveline.coupling individual"


@method(
    "plant",
    "planar_speed_mode",
    needs=(a_motor_for_each_wheel,),
    **PLANAR | {"state": SpeedModeState, "start": partial(shown.begin, kind=SpeedModeState)},
)
@inlined
def planar_speed_mode(
    p: PlanarSpeedModeParameters,
    car: Car,
    c: PlanarConstants,
    s: SpeedModeState,
    period: float,
    command: WheelTorqueCommand,
    column: SteeringColumnState,
    speeds: WheelSpeedCommand,
) -> None:
    """The planar plant with drives that control their speed, within the commanded torque and never against it.

    M = K e + (K/T) integral(e) within 0..M_command, e = w* - w at the shaft, in every step of the plant; motor, its
    limits, lag and losses are those of the plant in torque mode. A set-point out of reach is torque mode, to the bit;
    the integral part follows the torque there, so that a set-point that comes into reach takes over without a jump.
    """
    for i in range(4):
        most = car.motor.maximum_speed / car.gear[i]
        s.set_point[i] = accepted(s.guard, speeds.speed[i], s.set_point[i], -most, most)
    advance(p, car, c, s, period, command, column, _apply, account, working_memory(state.STEP_MEMORY))


@inlined
def _apply(p: PlanarSpeedModeParameters, car: Car, c: PlanarConstants, s: SpeedModeState, step: state.Step) -> None:
    """Set the torques of a step as in torque mode, by the torque that each speed control asks for."""
    command, control = step.drive_command, p.speed_control
    front_left, front_right, rear_left, rear_right = command[0], command[1], command[2], command[3]
    for i in range(4):
        gear = car.gear[i]
        least, most = min(command[i], 0.0) / gear, max(command[i], 0.0) / gear
        if s.set_point[i] * command[i] >= car.motor.maximum_speed / gear * abs(command[i]):
            s.speed_integral[i] = command[i] / gear
            continue
        error = gear * (s.set_point[i] - s.motion[state.WHEEL_SPEED + i])
        asked, s.speed_integral[i] = speed_control_without_windup(
            control.gain, control.integral_time, s.speed_integral[i], error, c.h, least, most
        )
        if (command[i] > 0.0 and asked < most) or (command[i] < 0.0 and asked > least):
            command[i] = gear * min(max(asked, least), most)
    apply_drives(p, car, c, s, step)
    command[0], command[1], command[2], command[3] = front_left, front_right, rear_left, rear_right
