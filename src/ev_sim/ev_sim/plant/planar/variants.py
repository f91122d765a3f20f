"""The planar plant with steered rear wheels, and with drives in speed mode."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import Car, RearSteeringState, Vehicle, WheelSpeedCommand, group, inlined, method, per_wheel
from ev_core.vehicle.drive_train import has_own_motors
from ev_msgs_py.contract.signals import SteeringColumnState, WheelTorqueCommand
from ev_sim.drives.controlled_motor import SpeedControlParameters, speed_control_without_windup
from ev_sim.plant.commands import accepted
from ev_sim.plant.planar.drive_torques import Lags, apply_drives
from ev_sim.plant.planar.energy import PowerConstants, account
from ev_sim.plant.planar.parameters import PlanarParameters
from ev_sim.plant.planar.plant import PLANAR, advance, planar
from ev_sim.plant.planar.prepare import PlanarConstants
from ev_sim.plant.planar.start import begin
from ev_sim.plant.planar.state import WHEEL_SPEED, PlanarState, Step


@method("plant", "planar_rear_steering", PlanarParameters, **PLANAR)
@inlined
def planar_rear_steering(
    p: PlanarParameters,
    car: Car,
    c: PlanarConstants,
    s: PlanarState,
    period: float,
    command: WheelTorqueCommand,
    column: SteeringColumnState,
    rear: RearSteeringState,
) -> None:
    """The planar plant with rear wheels that an actuator steers, besides what `rear_steering_ratio` of the car says.

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

    speed_control: SpeedControlParameters = group(SpeedControlParameters)


@dataclass(slots=True)
class PlanarSpeedModeState(PlanarState):
    """The same, and what the speed controls keep."""

    set_point: list[float] = per_wheel(unit="rad/s", about="of the wheel speed that was accepted last")
    speed_integral: list[float] = per_wheel(unit="N m", about="integral part of the speed control, at the shaft")


def at_start(p: PlanarSpeedModeParameters, car: Car, c: PlanarConstants) -> PlanarSpeedModeState:
    """As the planar plant begins."""
    s = PlanarSpeedModeState()
    begin(s, p, car, c)
    return s


def a_motor_for_each_wheel(_parameters: PlanarSpeedModeParameters, vehicle: Vehicle) -> str:
    """A drive controls the speed of its own wheel."""
    return "" if has_own_motors(vehicle) else "driveline.coupling individual"


@method(
    "plant",
    "planar_speed_mode",
    PlanarSpeedModeParameters,
    needs=(a_motor_for_each_wheel,),
    **PLANAR | {"state": PlanarSpeedModeState, "start": at_start},
)
@inlined
def planar_speed_mode(
    p: PlanarSpeedModeParameters,
    car: Car,
    c: PlanarConstants,
    s: PlanarSpeedModeState,
    period: float,
    command: WheelTorqueCommand,
    column: SteeringColumnState,
    speeds: WheelSpeedCommand,
) -> None:
    """The planar plant whose drives control their speed, with no more than the commanded torque and never against it.

    M = K e + (K/T) integral(e) within 0..M_command, e = w* - w at the shaft, in every step of the plant; motor, its
    limits, lag and losses are those of the plant in torque mode. A set-point out of reach is torque mode, to the bit;
    the integral part follows the torque there, so that a set-point that comes into reach takes over without a jump.
    """
    for i in range(4):
        most = car.motor.maximum_speed / car.gear[i]
        s.set_point[i] = accepted(s.guard, speeds.speed[i], s.set_point[i], -most, most)
    advance(p, car, c, s, period, command, column, _apply, account)


@inlined
def _apply(
    s: PlanarSpeedModeState,
    p: PlanarSpeedModeParameters,
    car: Car,
    power: PowerConstants,
    lags: Lags,
    step: Step,
    h: float,
) -> None:
    """Set the torques of a step of h [s] as in torque mode, by the torque that each speed control asks for."""
    command, control = step.drive_command, p.speed_control
    front_left, front_right, rear_left, rear_right = command[0], command[1], command[2], command[3]
    for i in range(4):
        gear = car.gear[i]
        least, most = min(command[i], 0.0) / gear, max(command[i], 0.0) / gear
        if s.set_point[i] * command[i] >= car.motor.maximum_speed / gear * abs(command[i]):
            s.speed_integral[i] = command[i] / gear
            continue
        error = gear * (s.set_point[i] - s.motion[WHEEL_SPEED + i])
        asked, s.speed_integral[i] = speed_control_without_windup(
            control.gain, control.integral_time, s.speed_integral[i], error, h, least, most
        )
        if (command[i] > 0.0 and asked < most) or (command[i] < 0.0 and asked > least):
            command[i] = gear * min(max(asked, least), most)
    apply_drives(s, p, car, power, lags, step, h)
    command[0], command[1], command[2], command[3] = front_left, front_right, rear_left, rear_right
