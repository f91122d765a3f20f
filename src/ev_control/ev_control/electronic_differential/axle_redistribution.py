"""Drive torque moved between the axles and the rear wheels of a 4x4 by the slip angles (Zhileykin 2018)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.plausible import is_plausible
from ev_control.estimation.slip_angle_observer import SlipAngleObserverState, axle_slip_angles, observed_slip_angles
from ev_control.law import split_brake
from ev_control.shared.axle_redistribution import (
    BY_SPEED,
    COMMAND,
    FRONT,
    TRUTH,
    AxleRedistributionParameters,
    front_share,
    rear_difference,
)
from ev_core.law import ALL_WHEELS_DRIVEN, Car, Wheels, compilable, entry, hypot, method, part
from ev_msgs_py.contract.signals import (
    BodyVelocity,
    DriverCommand,
    InertialMeasurement,
    SteeringColumnState,
    WheelStates,
    WheelTorqueRequest,
)


@dataclass(slots=True)
class AxleRedistributionState:
    """What lasts between steps."""

    front_slides: float = entry(1.0, unit="1", about="whether the front axle counts as the sliding one")
    cos_phi: float = entry(1.0, unit="1", about="cosine of the angle of the acceleration to the travel, held")
    acceleration: float = entry(unit="m/s^2", about="magnitude of the acceleration, j")
    slower: float = entry(unit="1", about="slower rear wheel: 1 left, -1 right, 0 while none has been the slower one")
    observer: SlipAngleObserverState = part(SlipAngleObserverState)


def first_branch(p: AxleRedistributionParameters) -> AxleRedistributionState:
    """The state that begins on the branch of the parameters."""
    return AxleRedistributionState(front_slides=1.0 if p.first_branch == FRONT else 0.0)


@method(
    "electronic_differential",
    "axle_redistribution",
    AxleRedistributionParameters,
    state=AxleRedistributionState,
    start=first_branch,
    needs=(ALL_WHEELS_DRIVEN,),
    mirrored=True,
)
@compilable
def axle_redistribution(
    p: AxleRedistributionParameters,
    car: Car,
    s: AxleRedistributionState,
    period: float,
    driver: DriverCommand,
    column: SteeringColumnState,
    wheels: WheelStates,
    imu: InertialMeasurement,
    body: BodyVelocity,
) -> WheelTorqueRequest:
    """Share the drive torque between front axle, slower and faster rear wheel so that the car steers neutrally.

    Front share h_n = K cos(phi) if the front axle slides (|d1| >= |d2|), else K (1 - cos(phi)), within
    0..largest_front_share; 0 while the car slows down; phi is the angle of the acceleration to the car's axis, in
    reverse to its rear (Zhileykin 2018, eqs 4 and 5). Of the rear torque the slower wheel gets (1 + q)/2 and the faster
    one (1 - q)/2 with q = L |Theta| h_n/(2 B (1 - h_n)), Theta the road-wheel angle [rad] (eq 7). Parameters choose
    other readings of the source. The torques [N m] add up to the driver's; the lag of the clutches is the plant's.
    """
    delta, torque, speed = column.road_wheel_angle, driver.drive_torque, wheels.velocity
    ahead = -1.0 if (speed[0] + speed[1]) + (speed[2] + speed[3]) < 0.0 else 1.0
    if p.source == TRUTH:
        angles = axle_slip_angles(car, body.longitudinal, body.lateral, body.yaw_rate, delta, p.observer.slowest)
        follow(p, s, abs(angles.front) - abs(angles.rear), ahead, wheels, imu)
    elif is_plausible(column, wheels, imu):
        angles = observed_slip_angles(p.observer, car, s.observer, period, driver, column, wheels, imu)
        follow(p, s, abs(angles.front) - abs(angles.rear), ahead, wheels, imu)
    brakes = ahead * torque < 0.0 or driver.brake_torque > 0.0 if p.braking == COMMAND else s.cos_phi <= 0.0
    h = 0.0
    if not brakes:
        h = front_share(p, car, s.front_slides == 1.0, s.cos_phi, s.acceleration, ahead * torque / car.wheel_radius)
    inner = 1.0 if delta > 0.0 else -1.0
    q = rear_difference(car, delta, h) * (s.slower if p.rear_wheels == BY_SPEED else inner)
    front, rear = torque * h, torque * (1.0 - h)
    drive = Wheels(front / 2.0, front / 2.0, rear * (1.0 + q) / 2.0, rear * (1.0 - q) / 2.0)
    return WheelTorqueRequest(drive, split_brake(p.brake, driver))


@compilable
def follow(
    p: AxleRedistributionParameters,
    s: AxleRedistributionState,
    front_excess: float,
    ahead: float,
    wheels: WheelStates,
    imu: InertialMeasurement,
) -> None:
    """Choose branch by |d1| - |d2| [rad], slower rear wheel and cos(phi) where they are defined; else hold them.

    `ahead` is 1, and -1 in reverse, where speeding up is an acceleration to the back.
    """
    if abs(front_excess) > p.slip_angle_deadband:
        s.front_slides = 1.0 if front_excess > 0.0 else 0.0
    right_excess = ahead * (wheels.velocity.rear_right - wheels.velocity.rear_left)
    if abs(right_excess) > p.speed_deadband:
        s.slower = 1.0 if right_excess > 0.0 else -1.0
    s.acceleration = hypot(imu.longitudinal_acceleration, imu.lateral_acceleration)
    if s.acceleration > p.acceleration_deadband:
        s.cos_phi = ahead * imu.longitudinal_acceleration / s.acceleration
