"""Steering by the torque difference of two front drives (Shchur 2019)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import auto
from typing import NamedTuple

from ev_control.estimation.plausible import Sensors, is_plausible
from ev_control.estimation.wheel_dynamics import wheel_load
from ev_control.law import (
    AllocationParameters,
    BrakeSplitParameters,
    allocated,
    own_motors_to_allocate,
    split,
)
from ev_control.shared.allocation import Range, motor_range, within
from ev_control.shared.torque_split import (
    AssistanceParameters,
    assistance,
    differential,
    torque_difference_per_steering_moment,
)
from ev_core.law import (
    Choice,
    InertialMeasurement,
    compilable,
    entry,
    group,
    parameter,
    turning_length,
)
from ev_core.vehicle.car import FRONT_WHEELS_DRIVEN, GRAVITY, Car, only_driven
from ev_msgs_py.contract.signals import (
    DriverCommand,
    SteeringColumnState,
    TireForces,
    WheelStates,
    WheelTorqueRequest,
)


class First(Choice):
    """Demand that gets its part of the torque difference first."""

    STEERING = auto()
    YAW = auto()


class Wish(Choice):
    """Source of the road-wheel angle that the driver wants."""

    ANGLE = auto()
    HAND_TORQUE = auto()


class Against(Choice):
    """Errors of the yaw rate that are worked against."""

    OVERSTEER = auto()
    BOTH = auto()


@dataclass(frozen=True, slots=True)
class PowerSteeringParameters(AssistanceParameters):
    """Assistance, brakes and what stays where motors saturate."""

    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@differential("power_steering", needs=(FRONT_WHEELS_DRIVEN, own_motors_to_allocate))
@compilable
def power_steering(
    p: PowerSteeringParameters,
    car: Car,
    driver: DriverCommand,
    column: SteeringColumnState,
    wheels: WheelStates,
) -> WheelTorqueRequest:
    """Split the drive torque so that its difference in front assists and damps the steering.

    Delta M = M_R - M_L = (2 r_k i / d) (gamma M_b - k_ck alpha - b_ck alpha'), with the hand torque
    M_b [N m] and the steering-wheel angle alpha [rad] as the column measures them, left positive.
    Shchur (2019), eq 4.
    """
    # A torque at the steering wheel is i times as much at the road wheels.
    lever = torque_difference_per_steering_moment(car) * car.steering_ratio
    difference = lever * assistance(p, column)
    return allocated(p.allocation, car, wheels, split(p.brake, car, driver, difference))


@dataclass(frozen=True, slots=True)
class DriveByWireParameters:
    """The gain from steering-wheel angle to torque difference."""

    gain: float = parameter(
        1.634,
        unit="N m/rad",
        low=0.0,
        high=1000.0,
        about="torque difference per steering-wheel angle; 2 r_k k_p/(d i) settles the paper's "
        "car at alpha/i",
        source="assumption, from Shchur 2019, eq 3 at rest with M_b = 0",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@differential(
    "drive_by_wire",
    needs=(FRONT_WHEELS_DRIVEN, own_motors_to_allocate),
    requires={"steering_column": "by_wire"},  # the hands must not turn the road wheels as well,
)
@compilable
def drive_by_wire(
    p: DriveByWireParameters,
    car: Car,
    driver: DriverCommand,
    column: SteeringColumnState,
    wheels: WheelStates,
) -> WheelTorqueRequest:
    """Set the torque difference in front in proportion to the steering-wheel angle.

    Delta M = M_R - M_L = k alpha [N m], left positive: the drive-by-wire concept in the
    introduction of Shchur (2019), for a by_wire steering column.
    """
    return allocated(p.allocation, car, wheels, split(p.brake, car, driver, p.gain * column.angle))


@dataclass(frozen=True, slots=True)
class SteerByWireParameters:
    """Wanted motion of the road wheels, and the steering system as the law knows it."""

    natural_frequency: float = parameter(
        8.0, unit="rad/s", low=0.1, high=100.0, about="natural frequency of the servo, w_0"
    )
    damping_ratio: float = parameter(
        0.9, unit="1", low=0.1, high=5.0, about="damping ratio of the servo, D"
    )
    disturbance_rate: float = parameter(
        2.0,
        unit="1/s",
        low=0.0,
        high=100.0,
        about="rate at which the integral removes disturbances, p; 0 for none",
    )
    max_torque_difference: float = parameter(
        150.0, unit="N m", low=0.0, high=10000.0, about="limit of |M_R - M_L|"
    )
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
        low=0.0,
        high=100000.0,
        about="restoring stiffness, k_p",
        source="Shchur 2019",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@dataclass(slots=True)
class SteerByWireState:
    """State of the servo."""

    integral: float = entry(unit="N m", about="integral part of the steering moment")


class SteerByWireSeen(NamedTuple):
    """Signals that the law reads."""

    driver: DriverCommand
    column: SteeringColumnState
    wheels: WheelStates


@differential(
    "steer_by_wire",
    needs=(FRONT_WHEELS_DRIVEN, own_motors_to_allocate),
    requires={"steering_column": "by_wire"},  # the hands must not turn the road wheels as well,
)
@compilable
def steer_by_wire(
    p: SteerByWireParameters,
    car: Car,
    s: SteerByWireState,
    period: float,
    seen: SteerByWireSeen,
) -> WheelTorqueRequest:
    """Turn the road wheels by the torque difference of the front wheels alone.

    The steer-by-wire concept in the introduction of Shchur (2019): M_b = 0 in eq 3, which leaves
    J_p d'' + b_p d' + k_p d = u with u = d_track/(2 r_k) (M_R - M_L), d the road-wheel angle. The
    law

        u = J_p w_0^2 d* - K d - B d' + J_p p w_0^2 integral(d* - d),    d* = alpha/i,
        K = J_p (w_0^2 + 2 D w_0 p) - k_p,    B = J_p (2 D w_0 + p) - b_p

    puts the poles at s = -p and at those of s^2 + 2 D w_0 s + w_0^2. The zero of the reference path
    cancels the pole at -p, so d follows d* with the latter two alone, while the integral removes
    what eq 3 does not know. The integral holds while the torque is limited. For a by_wire steering
    column; left positive.
    """
    w_0, double_damping = p.natural_frequency, 2.0 * p.damping_ratio * p.natural_frequency
    reference_gain = p.inertia * (w_0 * w_0)
    angle_gain = p.inertia * (w_0 * w_0 + double_damping * p.disturbance_rate) - p.stiffness
    rate_gain = p.inertia * (double_damping + p.disturbance_rate) - p.damping
    difference_per_moment = torque_difference_per_steering_moment(car)
    # The limit of the torque difference as a moment on the road wheels.
    limit = p.max_torque_difference / difference_per_moment
    column = seen.column
    wanted, angle = column.angle / car.steering_ratio, column.road_wheel_angle
    change = reference_gain * p.disturbance_rate * period * (wanted - angle)
    free = reference_gain * wanted - angle_gain * angle - rate_gain * column.road_wheel_rate
    moment = free + s.integral + change
    # Anti-windup: while the torque is limited the integral may only fall.
    if abs(moment) <= limit or moment * change < 0.0:
        s.integral += change
    moment = min(max(moment, -limit), limit)
    request = split(p.brake, car, seen.driver, difference_per_moment * moment)
    return allocated(p.allocation, car, seen.wheels, request)


@dataclass(frozen=True, slots=True)
class CourseStabilityParameters(AssistanceParameters):
    """Priority, the driver's assumed course, its gain, and the friction of the road."""

    first: First = parameter(
        First.STEERING,
        about="what gets its part of the torque difference first: power steering or yaw",
        source="assumption",
    )
    wish: Wish = parameter(
        Wish.HAND_TORQUE,
        source="assumption",
        about="road-wheel angle that the driver wants: the one that is, or that at which eq 5 "
        "rests under his hands",
    )
    against: Against = parameter(
        Against.OVERSTEER,
        source="assumption",
        about="both: the car yaws as is wanted; oversteer: no more than that, for where the front "
        "tyres slide a moment into the bend only turns the road wheels further",
    )
    stiffness: float = parameter(
        65.0,
        unit="N m/rad",
        low=0.001,
        high=1e5,
        about="restoring stiffness k_p, for the wish",
        source="Shchur 2019",
    )
    yaw_gain: float = parameter(
        200.0,
        unit="N m s/rad",
        low=0.0,
        high=1e5,
        about="yaw moment per error of the yaw rate",
        source="assumption",
    )
    largest_hand_torque: float = parameter(
        3.0,
        unit="N m",
        low=0.0,
        high=1000.0,
        about="yaw moment at most, as the hands feel it over the steering ratio",
        source="assumption: what drivers still hold against",
    )
    understeer: float = parameter(
        0.0,
        unit="s^2/m",
        low=-0.1,
        high=0.1,
        about="K of the reference r = u delta/(L + K u |u|)",
        source="assumption",
    )
    error_factor: float = parameter(
        1.0,
        unit="1",
        low=0.1,
        high=10.0,
        about="friction that the law believes in over that of the plant",
    )
    grip_share: float = parameter(
        0.9,
        unit="1",
        low=0.0,
        high=1.0,
        about="share of the friction that yaw rate and torques may take",
        source="assumption",
    )
    slowest: float = parameter(
        1.0, unit="m/s", low=0.01, high=10.0, about="speed below which there is no reference"
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@differential(
    "course_stability", needs=(FRONT_WHEELS_DRIVEN, only_driven("front_left", "front_right"))
)
@compilable
def course_stability(
    p: CourseStabilityParameters,
    car: Car,
    driver: DriverCommand,
    sensors: Sensors,
    tires: TireForces,
) -> WheelTorqueRequest:
    """Share the torque difference in front between power steering and a yaw moment.

    dM_s = (2 r_k i/d)(gamma M_b - k_ck alpha - b_ck alpha') (Shchur 2019, eq 4), dM_y = (2 r_k/d)
    M_z: by his eqs 2 and 3 the lever d/2 that turns the car turns the road wheels as well. M_z =
    k_r (r* - r) within +-i largest_hand_torque, r* = u delta*/(L + K u |u|) within +-share mu g/u,
    delta* what the driver wants, delta or by eq 5 at rest (1 + gamma) i M_b/(k_p + i^2 k_ck). Of
    the room that motors and adhesion leave beside half of the drive torque on each wheel, the first
    of both gets what it asks for, the other one its demand within the share that is left. u [m/s]
    comes from the free rear wheels, the yaw rate r [rad/s] from its sensor; left positive. An
    absurd measurement leaves eq 4 alone. Shchur names course stability as further work, without a
    law; this one is ours.
    """
    lever = torque_difference_per_steering_moment(car) / 2.0
    column = sensors.column
    wheels = sensors.wheels
    imu = sensors.imu
    steering = lever * car.steering_ratio * assistance(p, column)
    yaw = 0.0
    if is_plausible(sensors):
        mu = tires.friction_coefficient
        # The side with less friction decides what a difference of both can do.
        friction = p.error_factor * min(mu.front_left, mu.front_right)
        speed = wheels.velocity
        # The rear wheels are not driven (`needs`), so they roll.
        rear_speed = car.wheel_radius * (speed.rear_left + speed.rear_right) / 2.0
        yaw = lever * yaw_moment(p, car, friction, column, rear_speed, imu.yaw_rate)
        room = room_of(p, car, friction, driver.drive_torque / 2.0, wheels, imu)
        if p.first == First.STEERING:
            steering = within(room, steering)
            yaw = within(left_over(room, steering), yaw)
        else:
            yaw = within(room, yaw)
            steering = within(left_over(room, yaw), steering)
    return split(p.brake, car, driver, 2.0 * (steering + yaw))


@compilable
def yaw_moment(
    p: CourseStabilityParameters,
    car: Car,
    friction: float,
    column: SteeringColumnState,
    u: float,
    yaw_rate: float,
) -> float:
    """Yaw moment [N m] towards the yaw rate that the driver wants and the road allows."""
    # The limit of the yaw rate is over the speed.
    if abs(u) < p.slowest:
        return 0.0
    wish = column.road_wheel_angle
    if p.wish == Wish.HAND_TORQUE:
        i = car.steering_ratio
        wish = (1.0 + p.gamma) * i * column.hand_torque / (p.stiffness + i * i * p.k_ck)
    limit = p.grip_share * friction * GRAVITY / abs(u)
    wanted = min(max(u * wish / turning_length(car.wheelbase, p.understeer, u), -limit), limit)
    # Errors are counted against the range of yaw rates that are left alone: one value, or all
    # between none and the wanted one.
    least = most = wanted
    if p.against == Against.OVERSTEER:
        least, most = min(wanted, 0.0), max(wanted, 0.0)
    error = min(max(yaw_rate, least), most) - yaw_rate
    largest = car.steering_ratio * p.largest_hand_torque
    return min(max(p.yaw_gain * error, -largest), largest)


@compilable
def room_of(
    p: CourseStabilityParameters,
    car: Car,
    friction: float,
    share: float,
    wheels: WheelStates,
    imu: InertialMeasurement,
) -> Range:
    """Half torque differences [N m] that are left beside the drive torque of each wheel.

    They are what motors give and tyres hold along the wheel; zero is one of them.
    """
    along = p.grip_share * friction * car.wheel_radius
    grip_left = along * wheel_load(car, 0, imu.longitudinal_acceleration, imu.lateral_acceleration)
    grip_right = along * wheel_load(car, 1, imu.longitudinal_acceleration, imu.lateral_acceleration)
    left = motor_range(car, 0, wheels.velocity[0])
    right = motor_range(car, 1, wheels.velocity[1])
    # Left gets share - half and right share + half, and both have to stay within their ranges.
    least = max(max(right.least, -grip_right) - share, share - min(left.most, grip_left))
    most = min(min(right.most, grip_right) - share, share - max(left.least, -grip_left))
    return Range(min(least, 0.0), max(most, 0.0))


@compilable
def left_over(room: Range, taken: float) -> Range:
    """Share of the room that half a difference [N m] leaves."""
    # What is taken leaves the same share of both directions, so no order favours a side.
    end = room.most if taken >= 0.0 else room.least
    rest = 1.0 - taken / end if end != 0.0 else 1.0
    return Range(rest * room.least, rest * room.most)
