"""Drive torque shared between axles and rear wheels by slip angles (Zhileykin 2018)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import auto
from typing import NamedTuple

from ev_control.estimation import slip_angle_observer
from ev_control.estimation.plausible import Sensors, is_plausible
from ev_control.law import BrakeSplitParameters, split_brake
from ev_control.shared.torque_split import KnownBy, differential
from ev_core.law import (
    ALL_WHEELS_DRIVEN,
    BodyVelocity,
    Car,
    Choice,
    DriverCommand,
    Wheels,
    compilable,
    cos,
    entry,
    hypot,
    part,
)
from ev_core.parameters.declaration import group, parameter, setting
from ev_msgs_py.contract.signals import WheelTorqueRequest

# Bounds that keep the factor of eq 4 finite: more than any car has, and less than any drive gives.
LARGEST_OF_CARS = 100.0  # [m/s^2]
LEAST_FORCE = 1.0  # [N]


class Factor(Choice):
    """Readings of the factor K, which the source prints as a proportionality."""

    GIVEN = auto()
    INERTIA = auto()
    EQUALITY = auto()


class SecondBranch(Choice):
    """Readings of the front share while the rear slides."""

    PRINTED = auto()
    DERIVED = auto()
    REAR_SHARE = auto()


class Braking(Choice):
    """Conditions under which all torque goes to the rear axle."""

    STRAIGHT = auto()
    DECELERATION = auto()
    COMMAND = auto()


class RearWheels(Choice):
    """Rule by which a rear wheel gets more torque."""

    BY_SPEED = auto()
    BY_GEOMETRY = auto()


class FirstBranch(Choice):
    """Axle that counts as sliding at the start."""

    FRONT = auto()
    REAR = auto()


@dataclass(frozen=True, slots=True)
class AxleRedistributionParameters:
    """Readings of the source where it leaves a choice, source of the slip angles, and deadbands."""

    factor: Factor = parameter(
        Factor.GIVEN,
        about="front share over cos(phi), K: k; 2 J_z/(m L^2), which eq 4 gives without "
        "resistance; or 2 J_z j/(L^2 X), eq 4 as an equality with the measured acceleration j and "
        "the drive force X that is asked for",
        source="Zhileykin 2018, eqs 4 and 5, prints proportionality",
    )
    k: float = parameter(
        1.0,
        unit="1",
        low=0.0,
        high=5.0,
        about="K of the factor `given`; 1 reads proportional as equal",
    )
    second_branch: SecondBranch = parameter(
        SecondBranch.PRINTED,
        about="front share while the rear slides: K (1 - cos(phi)); K cos(phi), which follows "
        "from the line above eq 5; or 1 - K cos(phi), which follows if that line means the rear "
        "share",
        source="Zhileykin 2018, eq 5, which does not follow from the line above it",
    )
    largest_front_share: float = parameter(
        0.5,
        unit="1",
        low=0.0,
        high=0.9,
        about="limit of the front share h_n",
        source="Zhileykin 2018",
    )
    source: KnownBy = parameter(
        KnownBy.TRUTH,
        about="slip angles: from the true velocity of the twist topic, or from the observer",
        source="Zhileykin 2018 uses the true ones",
    )
    braking: Braking = parameter(
        Braking.STRAIGHT,
        about="when all torque goes to the rear axle: while the car slows down straight ahead, "
        "j_x <= 0 and j_y = 0; while it slows down, in a bend as well; or while the driver "
        "brakes, by a negative drive torque or the brake",
        source="Zhileykin 2018, below eq 5: phi = pi, j_y = 0, j_x <= 0",
    )
    straight_angle: float = setting(
        0.2,
        unit="rad",
        low=0.0,
        high=1.5,
        about="angle between deceleration and the car's axis up to which j_y counts as zero for "
        "`straight`",
    )
    rear_wheels: RearWheels = parameter(
        RearWheels.BY_SPEED,
        about="rear wheel that gets more: the slower one; or the inner one, which is the slower "
        "one unless it spins",
        source="Zhileykin 2018, eq 7: the lagging wheel",
    )
    first_branch: FirstBranch = parameter(
        FirstBranch.FRONT,
        about="axle that counts as sliding until the slip angles differ by more than the deadband",
        source="assumption: equal slip angles count as a sliding front",
    )
    slip_angle_deadband: float = parameter(
        0.005,
        unit="rad",
        low=0.0,
        high=0.5,
        about="difference of the magnitudes of the slip angles that changes the branch; straight "
        "ahead it is undefined",
    )
    acceleration_deadband: float = parameter(
        0.1,
        unit="m/s^2",
        low=1e-6,
        high=5.0,
        about="acceleration below which its direction is undefined, and held",
    )
    speed_deadband: float = parameter(
        0.1,
        unit="rad/s",
        low=0.0,
        high=10.0,
        about="difference of the rear wheel speeds that changes the slower one",
    )
    observer: slip_angle_observer.SlipAngleObserverParameters = group(
        slip_angle_observer.SlipAngleObserverParameters
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@dataclass(slots=True)
class AxleRedistributionState:
    """State of the law."""

    front_slides: bool = entry(
        True, unit="1", about="whether the front axle counts as the sliding one"
    )
    cos_phi: float = entry(
        1.0, unit="1", about="cosine of the angle of the acceleration to the travel, held"
    )
    acceleration: float = entry(unit="m/s^2", about="magnitude of the acceleration, j")
    slower: float = entry(
        unit="1", about="slower rear wheel: 1 left, -1 right, 0 while none has been the slower one"
    )
    observer: slip_angle_observer.SlipAngleObserverState = part(
        slip_angle_observer.SlipAngleObserverState
    )


@compilable
def front_share(
    p: AxleRedistributionParameters, car: Car, s: AxleRedistributionState, force: float
) -> float:
    """Share h_n [1] of the front axle, by acceleration j [m/s^2], its angle phi and X [N].

    K cos(phi) while the front slides (eq 4, where |W12| = 0 gives h_n X = 2 J_z j cos(phi)/L^2),
    and `second_branch` while the rear does (eq 5), within 0..largest_front_share.
    """
    factor, lever = p.k, 2.0 * car.yaw_inertia / (car.wheelbase * car.wheelbase)
    if p.factor == Factor.INERTIA:
        factor = lever / car.mass
    elif p.factor == Factor.EQUALITY:
        factor = lever * min(s.acceleration, LARGEST_OF_CARS) / max(force, LEAST_FORCE)
    share = factor * s.cos_phi
    if not s.front_slides and p.second_branch == SecondBranch.PRINTED:
        share = factor * (1.0 - s.cos_phi)
    elif not s.front_slides and p.second_branch == SecondBranch.REAR_SHARE:
        share = 1.0 - share
    return min(max(share, 0.0), p.largest_front_share)


@compilable
def rear_difference(car: Car, road_wheel_angle: float, front_share: float) -> float:
    """Difference q = L |Theta| h_n/(2 B (1 - h_n)) [1], at most 1 (eq 7 at constant speed).

    Of the rear torque the slower wheel gets (1 + q)/2 and the faster one (1 - q)/2.
    """
    inner_lead = car.wheelbase * abs(road_wheel_angle) * front_share
    q = inner_lead / (2.0 * car.rear_track * (1.0 - front_share))
    return min(q, 1.0)


class AxleRedistributionSeen(NamedTuple):
    """Signals that the law reads."""

    driver: DriverCommand
    sensors: Sensors
    body: BodyVelocity


@differential(
    "axle_redistribution",
    start=lambda p: AxleRedistributionState(front_slides=p.first_branch == FirstBranch.FRONT),
    needs=(ALL_WHEELS_DRIVEN,),
)
@compilable
def axle_redistribution(
    p: AxleRedistributionParameters,
    car: Car,
    s: AxleRedistributionState,
    period: float,
    seen: AxleRedistributionSeen,
) -> WheelTorqueRequest:
    """Share the drive torque between front axle and rear wheels so that the car steers neutrally.

    Front share h_n = K cos(phi) if the front axle slides (|d1| >= |d2|), else K (1 - cos(phi)),
    within 0..largest_front_share; 0 while the car slows down straight ahead; phi is the angle of
    the acceleration to the car's axis, in reverse to its rear (Zhileykin 2018, eqs 4 and 5). Of the
    rear torque the slower wheel gets (1 + q)/2 and the faster one (1 - q)/2 with q = L |Theta|
    h_n/(2 B (1 - h_n)), Theta the road-wheel angle [rad] (eq 7). Parameters choose other readings
    of the source. The torques [N m] add up to the driver's; the lag of the clutches is the plant's.
    """
    driver, sensors = seen.driver, seen.sensors
    delta, torque = sensors.column.road_wheel_angle, driver.drive_torque
    speed = sensors.wheels.velocity
    # By all wheels: one may spin or lock. At rest it counts as forwards.
    ahead = -1.0 if (speed[0] + speed[1]) + (speed[2] + speed[3]) < 0.0 else 1.0
    # What is absurd changes nothing: axle, wheel and angle stay as they were found last.
    if p.source == KnownBy.TRUTH or is_plausible(sensors):
        angles = slip_angles(p, car, s, period, seen)
        observe(p, s, sensors, angles, ahead)
    # The rear axle gets all torque, h = 0, for phi = pi, j_y = 0, j_x <= 0 (below eq 5).
    if p.braking == Braking.COMMAND:
        all_to_rear = ahead * torque < 0.0 or driver.brake_torque > 0.0
    else:
        # phi = pi is an acceleration straight to the back, cos(phi) = -1; up to `straight_angle`
        # from there it is -cos of that angle at most, and in any backward direction 0.
        slows_down = 0.0 if p.braking == Braking.DECELERATION else -cos(p.straight_angle)
        all_to_rear = s.cos_phi <= slows_down
    h = 0.0
    if not all_to_rear:
        force = ahead * torque / car.wheel_radius
        h = front_share(p, car, s, force)
    # 1 for the left wheel, -1 for the right one, which gets more.
    # 0 as long as no wheel has been the slower one: both get the same.
    favoured = s.slower
    if p.rear_wheels == RearWheels.BY_GEOMETRY:
        favoured = 1.0 if delta > 0.0 else -1.0
    q = rear_difference(car, delta, h) * favoured
    front, rear = torque * h, torque * (1.0 - h)
    drive = Wheels(front / 2.0, front / 2.0, rear * (1.0 + q) / 2.0, rear * (1.0 - q) / 2.0)
    return WheelTorqueRequest(drive, split_brake(p.brake, driver))


@compilable
def slip_angles(
    p: AxleRedistributionParameters,
    car: Car,
    s: AxleRedistributionState,
    period: float,
    seen: AxleRedistributionSeen,
) -> slip_angle_observer.SlipAngles:
    """Slip angles of both axles [rad], true or observed."""
    if p.source == KnownBy.TRUTH:
        body, delta = seen.body, seen.sensors.column.road_wheel_angle
        return slip_angle_observer.axle_slip_angles(
            car, body.longitudinal, body.lateral, body.yaw_rate, delta, p.observer.slowest
        )
    return slip_angle_observer.observed_slip_angles(
        p.observer, car, s.observer, period, seen.driver, seen.sensors
    )


@compilable
def observe(
    p: AxleRedistributionParameters,
    s: AxleRedistributionState,
    sensors: Sensors,
    angles: slip_angle_observer.SlipAngles,
    ahead: float,
) -> None:
    """Take over sliding axle, slower rear wheel and cos(phi); hold each where it is not defined.

    In reverse, `ahead` below zero, speeding up is an acceleration to the back.
    """
    speed, imu = sensors.wheels.velocity, sensors.imu
    front_excess = abs(angles.front) - abs(angles.rear)
    right_excess = ahead * (speed.rear_right - speed.rear_left)
    if abs(front_excess) > p.slip_angle_deadband:
        s.front_slides = front_excess > 0.0
    if abs(right_excess) > p.speed_deadband:
        s.slower = 1.0 if right_excess > 0.0 else -1.0
    s.acceleration = hypot(imu.longitudinal_acceleration, imu.lateral_acceleration)
    if s.acceleration > p.acceleration_deadband:
        s.cos_phi = ahead * imu.longitudinal_acceleration / s.acceleration
