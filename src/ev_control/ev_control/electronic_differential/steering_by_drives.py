"""Steering by the torque difference of two front drives: assisted, or in the place of a column (Shchur 2019)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.law import AllocationParameters, BrakeSplitParameters, allocated, own_motors_to_allocate, split
from ev_control.shared.torque_split import (
    AssistanceParameters,
    assistance,
    differential,
    torque_difference_per_steering_moment,
)
from ev_core.law import FRONT_WHEELS_DRIVEN, Car, compilable, entry, group, parameter
from ev_msgs_py.contract.signals import DriverCommand, SteeringColumnState, WheelStates, WheelTorqueRequest


@dataclass(frozen=True, slots=True)
class PowerSteeringParameters(AssistanceParameters):
    """The same, brakes and what stays where motors saturate."""

    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@differential("power_steering", PowerSteeringParameters, needs=(FRONT_WHEELS_DRIVEN, own_motors_to_allocate))
@compilable
def power_steering(
    p: PowerSteeringParameters, car: Car, driver: DriverCommand, column: SteeringColumnState, wheels: WheelStates
) -> WheelTorqueRequest:
    """Split the drive torque so that the difference of the front wheels assists and damps the steering.

    Delta M = M_R - M_L = (2 r_k i / d) (gamma M_b - k_ck alpha - b_ck alpha'), with the hand torque M_b [N m] and the
    steering-wheel angle alpha [rad] as the column measures them, left positive. Shchur (2019), eq 4.
    """
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
        about="torque difference per steering-wheel angle; 2 r_k k_p/(d i) settles the paper's car at alpha/i",
        source="assumption, from Shchur 2019, eq 3 at rest with M_b = 0",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@differential(
    "drive_by_wire",
    DriveByWireParameters,
    needs=(FRONT_WHEELS_DRIVEN, own_motors_to_allocate),
    requires={"steering_column": "by_wire"},  # the hands must not turn the road wheels as well,
)
@compilable
def drive_by_wire(
    p: DriveByWireParameters, car: Car, driver: DriverCommand, column: SteeringColumnState, wheels: WheelStates
) -> WheelTorqueRequest:
    """Set the torque difference of the front wheels in proportion to the steering-wheel angle, without feedback.

    Delta M = M_R - M_L = k alpha [N m], left positive: the drive-by-wire concept in the introduction of Shchur (2019),
    for a by_wire steering column.
    """
    return allocated(p.allocation, car, wheels, split(p.brake, car, driver, p.gain * column.angle))


@dataclass(frozen=True, slots=True)
class SteerByWireParameters:
    """The wanted motion of the road wheels and the law's own idea of the steering system; the paper gives no law."""

    natural_frequency: float = parameter(
        8.0, unit="rad/s", low=0.1, high=100.0, about="natural frequency of the servo, w_0"
    )
    damping_ratio: float = parameter(0.9, unit="1", low=0.1, high=5.0, about="damping ratio of the servo, D")
    disturbance_rate: float = parameter(
        2.0, unit="1/s", low=0.0, high=100.0, about="rate at which the integral removes disturbances, p; 0 for none"
    )
    max_torque_difference: float = parameter(150.0, unit="N m", low=0.0, high=10000.0, about="limit of |M_R - M_L|")
    inertia: float = parameter(
        2.8, unit="kg m^2", low=0.001, high=1000.0, about="inertia of the steering system, J_p", source="Shchur 2019"
    )
    damping: float = parameter(
        7.5, unit="N m s/rad", low=0.0, high=10000.0, about="viscous friction, b_p", source="Shchur 2019"
    )
    stiffness: float = parameter(
        65.0, unit="N m/rad", low=0.0, high=100000.0, about="restoring stiffness, k_p", source="Shchur 2019"
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@dataclass(slots=True)
class SteerByWireState:
    """What lasts between steps."""

    integral: float = entry(unit="N m", about="integral part of the steering moment")


@differential(
    "steer_by_wire",
    SteerByWireParameters,
    state=SteerByWireState,
    needs=(FRONT_WHEELS_DRIVEN, own_motors_to_allocate),
    requires={"steering_column": "by_wire"},  # the hands must not turn the road wheels as well,
)
@compilable
def steer_by_wire(
    p: SteerByWireParameters,
    car: Car,
    s: SteerByWireState,
    period: float,
    driver: DriverCommand,
    column: SteeringColumnState,
    wheels: WheelStates,
) -> WheelTorqueRequest:
    """Turn the road wheels to the steering-wheel angle over i by the torque difference of the front wheels alone.

    The steer-by-wire concept in the introduction of Shchur (2019): M_b = 0 in eq 3, which leaves
    J_p d'' + b_p d' + k_p d = u with u = d_track/(2 r_k) (M_R - M_L), d the road-wheel angle. The law

        u = J_p w_0^2 d* - K d - B d' + J_p p w_0^2 integral(d* - d),    d* = alpha/i,
        K = J_p (w_0^2 + 2 D w_0 p) - k_p,    B = J_p (2 D w_0 + p) - b_p

    puts the poles at s = -p and at those of s^2 + 2 D w_0 s + w_0^2. The zero of the reference path cancels the pole
    at -p, so d follows d* with the latter two alone, while the integral removes what eq 3 does not know. The
    integral holds while the torque is limited. For a by_wire steering column; left positive.
    """
    w_0, double_damping = p.natural_frequency, 2.0 * p.damping_ratio * p.natural_frequency
    reference_gain = p.inertia * (w_0 * w_0)
    angle_gain = p.inertia * (w_0 * w_0 + double_damping * p.disturbance_rate) - p.stiffness
    rate_gain = p.inertia * (double_damping + p.disturbance_rate) - p.damping
    difference_per_moment = torque_difference_per_steering_moment(car)
    limit = p.max_torque_difference / difference_per_moment
    wanted, angle = column.angle / car.steering_ratio, column.road_wheel_angle
    change = reference_gain * p.disturbance_rate * period * (wanted - angle)
    free = reference_gain * wanted - angle_gain * angle - rate_gain * column.road_wheel_rate
    moment = free + s.integral + change
    if abs(moment) <= limit or moment * change < 0.0:
        s.integral += change
    moment = min(max(moment, -limit), limit)
    return allocated(p.allocation, car, wheels, split(p.brake, car, driver, difference_per_moment * moment))
