"""The planar plant and its variants, as methods of the role `plant` (docs/planar_plant.md).

How it works: a control period is divided into equal steps. Before them the guard accepts the
commands, and faults are looked up. Each step finds the road, turns the wheels, lets the drives set
the torques of the wheels, integrates body and wheels, moves the car on, and books
its energies. A variant puts functions of its own in the place of `apply_drives`, which sets the
torques, or of `account`, which books, or does something before or behind the period. Options of
the plant are switches among its parameters (`OPTIONS`): electrical side, rear steering, speed mode.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

from ev_core.law import (
    Car,
    Vehicle,
    cos,
    group,
    inlined,
    method,
    per_wheel,
    setting,
    sin,
    working_memory,
)
from ev_core.methods.former_names import formerly
from ev_core.methods.law import Options
from ev_core.vehicle.driveline import has_own_motors
from ev_msgs_py.contract.optional_signals import RearSteeringState, WheelSpeedCommand
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_sim.drives.synchronous_motor import (
    SpeedControl,
    SpeedModeParameters,
    speed_control_without_windup,
)
from ev_sim.plant.guard import Commanded, accepted, guarded_steering, guarded_torques
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
from ev_sim.plant.planar.model import Mechanics, Plant
from ev_sim.plant.planar.powertrain import account, apply_drives
from ev_sim.plant.planar.prepare import PlanarConstants, prepare, prepare_electrical
from ev_sim.plant.planar.semi_implicit import integrate_once
from ev_sim.profiles.profile import value_at

# A vehicle with it has a body that rolls.
ROLLING = "vehicle.suspension.sprung_mass"

# Declaration of the plant, which its options and other plants like it may replace in part.
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


@dataclass(frozen=True, slots=True)
class PlanarPlantParameters(PlanarParameters):
    """The planar plant, and its options, which go with each other."""

    electrical: bool = setting(
        False,
        about="electrical side of the motors, and cells: docs/electrical.md",
        read_only=True,
    )
    rear_steering: bool = setting(
        False,
        about="rear wheels that the node rear_steering steers: docs/rear_steering.md",
        read_only=True,
    )
    speed_mode: bool = setting(
        False,
        about="drives that control the speeds that `speed_command` sets, as some asr do",
        read_only=True,
    )
    speed_control: SpeedModeParameters = group(SpeedModeParameters)


@inlined
def planar(
    p: PlanarParameters,
    car: Car,
    c: PlanarConstants,
    s: state.PlanarState,
    period: float,
    commanded: Commanded,
) -> None:
    """Body in the plane, four wheels on real tyres and roads, drives, battery: planar_plant.md.

    Over one period the torques are held and the steering angle goes on at its rate, as the guard
    accepts them.
    """
    plant = Plant(p, car, c, s, working_memory(state.STEP_MEMORY)[0])
    advance(plant, period, commanded, apply_drives, account)


@inlined
def advance(
    plant: Plant,
    period: float,
    commanded: Commanded,
    apply: Callable[..., None],
    book: Callable[..., None],
) -> None:
    """Advance the plant by a period [s], step by step.

    `apply` sets the torques of a step as `apply_drives` does, `book` its energies as `account`
    does.
    """
    s, c = plant.s, plant.c
    angle, rate = begin_period(plant, period, commanded)
    is_struck = s.faults.is_struck == 1.0
    # The period counts that ends now; half a period against the rounding of n times the period.
    is_held = s.periods * period <= plant.p.initial_hold + 0.5 * period
    for n in range(int(c.steps)):
        # The rear angle goes on at its rate, too: 0 without an actuator.
        # The angle in the middle of a step stands for all of it.
        time = (n + 0.5) * c.h
        # A flat tyre changes what the look-up has left in the step, so with faults each step needs
        # the tyres anew.
        find_ground(plant, n == 0 or is_struck)
        steer(plant.car, plant.step, angle + rate * time, s.rear_angle + s.rear_rate * time)
        apply(plant)
        move(plant, is_held)
        book(plant)
    s.road_wheel_angle = angle + rate * (c.steps * c.h)
    shown.keep_noted(s, plant.car, c)


@inlined
def begin_period(plant: Plant, period: float, commanded: Commanded) -> tuple[float, float]:
    """Take commands and faults of a period; road-wheel angle [rad] and its rate [rad/s]."""
    p, _, c, s, step = plant
    torques = guarded_torques(c.limits, s.guard, commanded.torques)
    angle, rate = guarded_steering(c.limits, s.guard, commanded.column, period)
    # Also once after the last fault has gone from the parameters: that clears what it has left
    # behind.
    if len(c.faults.kind) > 0 or s.faults.is_struck == 1.0:
        find_faults(p, c.faults, s, period)
    s.periods += 1.0
    s.imposed_acceleration = 0.0
    if p.speed == SPEED_IMPOSED:
        # The speed at the end of this period, to which one constant acceleration leads.
        wanted = value_at(c.imposed, s.periods * period)
        s.imposed_acceleration = (wanted - s.motion[state.VX]) / period
    step.imposed_acceleration = s.imposed_acceleration
    hold_commands(plant, torques)
    return angle, rate


@inlined
def hold_commands(plant: Plant, torques: WheelTorqueCommand) -> None:
    """Hold the accepted torques [N m] for the steps of a period, as late as faulty inverters do."""
    s, step = plant.s, plant.step
    for i in range(4):
        step.drive_command[i] = torques.drive[i]
        step.brake_command[i] = torques.brake[i]
        s.mean_drive[i] = 0.0
    if s.faults.is_struck == 1.0:
        # The count is that of periods that have begun; the first one is number 0.
        delay_commands(s.faults, s.periods - 1.0, step)


@inlined
def find_ground(plant: Plant, first: bool) -> None:
    """Find the road under the car, and put flat tyres on it; `first` as in `find_road`."""
    p, car, c, s, step = plant
    find_road(s.motion, c.body, step, c.road, first)
    if s.faults.is_struck == 1.0:
        deflate(s.faults, p, car, c.body, step)


@inlined
def move(plant: Plant, is_held: bool) -> None:
    """Move body and wheels on by one step; `is_held` while the motion of the start is held."""
    p, car, c, s, step = plant
    y = s.motion
    mechanics = Mechanics(p, car, c.body, step)
    is_pushed = p.speed == SPEED_IMPOSED and p.imposed_at == AT_WHEELS
    if is_pushed:
        push_at_wheels(y, mechanics)
    vx = y[state.VX]
    vy = y[state.VY]
    heading = y[state.HEADING]
    for i in range(4):
        # Less the angle before the step; the one after it is added below.
        step.turned[i] = -y[state.WHEEL_ANGLE + i]
    _integrate(c.semi_implicit, s, mechanics, c.h)
    if is_held:
        hold_motion(p, s)
    for i in range(4):
        step.turned[i] += y[state.WHEEL_ANGLE + i]
        s.mean_drive[i] += step.drive[i] / c.steps
    if is_pushed:
        book_push(y, step)
    # The position feeds nothing back, so the trapezoidal rule over the step is enough.
    mean_x = 0.5 * (vx + y[state.VX])
    mean_y = 0.5 * (vy + y[state.VY])
    middle = 0.5 * (heading + y[state.HEADING])
    cosine, sine = cos(middle), sin(middle)
    s.x += c.h * (mean_x * cosine - mean_y * sine)
    s.y += c.h * (mean_y * cosine + mean_x * sine)


@inlined
def _integrate(
    semi_implicit: float | None, s: state.PlanarState, mechanics: Mechanics, h: float
) -> None:
    """Take a step of h [s] by the integrator of the plant.

    None is a type of its own, so the compiler leaves the other integrator out.
    """
    if semi_implicit is None:
        integrate(s.motion, mechanics, h)
    else:
        integrate_once(s.motion, s.rates, mechanics, h)


@inlined
def hold_motion(p: PlanarParameters, s: state.PlanarState) -> None:
    """Put lateral velocity, yaw rate and a free speed back to those of the start."""
    y = s.motion
    y[state.VY] = p.initial_lateral_velocity
    y[state.YAW_RATE] = p.initial_yaw_rate
    s.rates[state.VY] = s.rates[state.YAW_RATE] = 0.0
    if p.speed == SPEED_FREE:
        y[state.VX] = p.initial_speed
        s.rates[state.VX] = 0.0


class SteeredBehind(NamedTuple):
    """The commands, and the actuator of the rear wheels."""

    commanded: Commanded
    rear: RearSteeringState


@inlined
def with_rear_steering(
    p: PlanarPlantParameters,
    car: Car,
    c: PlanarConstants,
    s: state.PlanarState,
    period: float,
    read: SteeredBehind,
) -> None:
    """The planar plant with rear wheels that an actuator steers.

    Its angle adds to what the `rear_steering_ratio` of the car gives.
    """
    begin_rear(c, s, period, read.rear)
    planar(p, car, c, s, period, read.commanded)
    s.rear_angle += s.rear_rate * period


@inlined
def begin_rear(
    c: PlanarConstants, s: state.PlanarState, period: float, rear: RearSteeringState
) -> None:
    """Take the angle of the actuator, and the rate at which it goes on over a period [s].

    Both stay within the limit of the front wheels.
    """
    limit = c.limits.angle
    s.rear_angle = accepted(s.guard, rear.angle, s.rear_angle, -limit, limit)
    least = (-limit - s.rear_angle) / period
    most = (limit - s.rear_angle) / period
    s.rear_rate = accepted(s.guard, rear.rate, 0.0, least, most)


@dataclass(slots=True)
class SpeedModeState(state.PlanarState):
    """The same, and what the speed controls keep."""

    set_point: list[float] = per_wheel(
        unit="rad/s", about="of the wheel speed that was accepted last"
    )
    speed_integral: list[float] = per_wheel(
        unit="N m", about="integral part of the speed control, at the shaft"
    )


class SpeedCommanded(NamedTuple):
    """The commands, and the set-points of the wheel speeds."""

    commanded: Commanded
    speeds: WheelSpeedCommand


def a_motor_for_each_wheel(parameters: PlanarPlantParameters, vehicle: Vehicle) -> str:
    """A drive in speed mode controls the speed of its own wheel."""
    if parameters.speed_mode and not has_own_motors(vehicle):
        return "driveline.coupling individual"
    return ""


@inlined
def with_speed_mode(
    p: PlanarPlantParameters,
    car: Car,
    c: PlanarConstants,
    s: SpeedModeState,
    period: float,
    read: SpeedCommanded,
) -> None:
    """The planar plant with drives that control their speed, within the commanded torque.

    M = K e + (K/T) integral(e) within 0..M_command, e = w* - w at the shaft, in every step of the
    plant; motor, its limits, lag and losses are those of the plant in torque mode. A set-point out
    of reach is torque mode, to the bit; the integral part follows the torque there, so that a
    set-point that comes into reach takes over without a jump.
    """
    for i in range(4):
        most = car.motor.maximum_speed / car.gear[i]
        s.set_point[i] = accepted(s.guard, read.speeds.speed[i], s.set_point[i], -most, most)
    plant = Plant(p, car, c, s, working_memory(state.STEP_MEMORY)[0])
    advance(plant, period, read.commanded, _apply_speed_control, account)


@inlined
def _apply_speed_control(plant: Plant) -> None:
    """Set the torques of a step as in torque mode, by what each speed control asks for."""
    command = plant.step.drive_command
    # Kept aside, because `apply_drives` reads the command of the step.
    front_left, front_right = command[0], command[1]
    rear_left, rear_right = command[2], command[3]
    for i in range(4):
        command[i] = _controlled_torque(plant, i)
    apply_drives(plant)
    # The command holds for the whole period: the next step controls by it again.
    command[0], command[1] = front_left, front_right
    command[2], command[3] = rear_left, rear_right


@inlined
def _controlled_torque(plant: Plant, i: int) -> float:
    """Torque [N m] that the speed control of wheel i asks of its drive, within its command."""
    p, car, c, s, step = plant
    command, gear = step.drive_command[i], car.gear[i]
    fastest = car.motor.maximum_speed / gear
    # A set-point that no motor reaches in the direction of the command; also any without a command.
    if s.set_point[i] * command >= fastest * abs(command):
        s.speed_integral[i] = command / gear
        return command
    # The speed control only takes torque away: between none and the command, never against it.
    least = min(command, 0.0) / gear
    most = max(command, 0.0) / gear
    error = gear * (s.set_point[i] - s.motion[state.WHEEL_SPEED + i])
    control = SpeedControl(p.speed_control.gain, p.speed_control.integral_time, c.h, least, most)
    asked, s.speed_integral[i] = speed_control_without_windup(control, s.speed_integral[i], error)
    if (command > 0.0 and asked < most) or (command < 0.0 and asked > least):
        return gear * min(max(asked, least), most)
    return command


class SteeredBehindBySpeed(NamedTuple):
    """The commands, the actuator of the rear wheels, and the set-points of the wheel speeds."""

    commanded: Commanded
    rear: RearSteeringState
    speeds: WheelSpeedCommand


@inlined
def with_rear_steering_and_speed_mode(
    p: PlanarPlantParameters,
    car: Car,
    c: PlanarConstants,
    s: SpeedModeState,
    period: float,
    read: SteeredBehindBySpeed,
) -> None:
    """The planar plant with both."""
    begin_rear(c, s, period, read.rear)
    with_speed_mode(p, car, c, s, period, SpeedCommanded(read.commanded, read.speeds))
    s.rear_angle += s.rear_rate * period


# Each option replaces fields of the declaration. The electrical side is one of constants and
# signals, so it goes with every function; the two others read signals, so both together need one
# function more.
OPTIONS: Options = {
    ("electrical",): {
        "prepare": prepare_electrical,
        "outputs": shown.electrical_outputs,
        "writes": shown.ELECTRICAL_SIGNALS,
    },
    (ROLLING,): {"outputs": shown.rolling_outputs, "writes": shown.ROLLING_SIGNALS},
    ("electrical", ROLLING): {
        "outputs": shown.electrical_rolling_outputs,
        "writes": shown.ELECTRICAL_ROLLING_SIGNALS,
    },
    ("rear_steering",): {"function": with_rear_steering},
    ("speed_mode",): {
        "function": with_speed_mode,
        "state": SpeedModeState,
        "start": partial(shown.begin, kind=SpeedModeState),
        "idle": (),
    },
    ("rear_steering", "speed_mode"): {"function": with_rear_steering_and_speed_mode},
}

method(
    "plant",
    "planar",
    **PLANAR,
    parameters=PlanarPlantParameters,
    needs=(a_motor_for_each_wheel,),
    options=OPTIONS,
    idle=("speed_control",),
)(planar)

# Each option was a plant of its own. Scenarios may have these names for one release more.
formerly("plant", "planar_electrical", "planar", electrical=True)
formerly("plant", "planar_rear_steering", "planar", rear_steering=True)
formerly("plant", "planar_speed_mode", "planar", speed_mode=True)
