"""Drive torque moved between the axles and the rear wheels of a 4x4 by the slip angles (Zhileykin 2018)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation import slip_angle_observer
from ev_control.estimation.plausible import is_plausible
from ev_control.law import BrakeSplitParameters, split_brake
from ev_control.shared.torque_split import KNOWN_BY, TRUTH, differential
from ev_core.law import ALL_WHEELS_DRIVEN, BodyVelocity, Car, DriverCommand, Wheels, compilable, cos, entry, hypot, part
from ev_core.parameters.declaration import group, parameter, setting
from ev_msgs_py.contract.signals import InertialMeasurement, SteeringColumnState, WheelStates, WheelTorqueRequest

FACTORS = ("given", "inertia", "equality")
GIVEN_FACTOR, INERTIA_FACTOR, EQUALITY_FACTOR = range(len(FACTORS))
SECOND_BRANCHES = ("printed", "derived", "rear_share")
PRINTED, DERIVED, REAR_SHARE = range(len(SECOND_BRANCHES))
LARGEST_OF_CARS = 100.0  # [m/s^2], more than any car's; with the next one it keeps the factor of eq 4 finite
LEAST_FORCE = 1.0  # [N]


BRAKING = ("straight", "deceleration", "command")
BRAKES_STRAIGHT, DECELERATES, DRIVER_BRAKES = range(len(BRAKING))
REAR_WHEELS = ("by_speed", "by_geometry")
BY_SPEED, BY_GEOMETRY = range(len(REAR_WHEELS))
FIRST_BRANCHES = ("front", "rear")
FRONT_BRANCH, REAR_BRANCH = range(len(FIRST_BRANCHES))


@dataclass(frozen=True, slots=True)
class AxleRedistributionParameters:
    """How the source is read where it leaves a choice, where the slip angles come from, and deadbands."""

    factor: str = parameter(
        "given",
        choices=FACTORS,
        about="front share over cos(phi), K: k; 2 J_z/(m L^2), which eq 4 gives without resistance; or "
        "2 J_z j/(L^2 X), eq 4 as an equality with the measured acceleration j and the drive force X that is asked for",
        source="Zhileykin 2018, eqs 4 and 5, prints proportionality",
    )
    k: float = parameter(
        1.0, unit="1", low=0.0, high=5.0, about="K of the factor `given`; 1 reads proportional as equal"
    )
    second_branch: str = parameter(
        "printed",
        choices=SECOND_BRANCHES,
        about="front share while the rear slides: K (1 - cos(phi)); K cos(phi), which follows from the line above "
        "eq 5; or 1 - K cos(phi), which follows if that line means the rear share",
        source="Zhileykin 2018, eq 5, which does not follow from the line above it",
    )
    largest_front_share: float = parameter(
        0.5, unit="1", low=0.0, high=0.9, about="limit of the front share h_n", source="Zhileykin 2018"
    )
    source: str = parameter(
        "truth",
        choices=KNOWN_BY,
        about="slip angles: from the true velocity of the twist topic, or from the observer",
        source="Zhileykin 2018 uses the true ones",
    )
    braking: str = parameter(
        "straight",
        choices=BRAKING,
        about="when all torque goes to the rear axle: while the car slows down straight ahead, j_x <= 0 and j_y = 0; "
        "while it slows down, in a bend as well; or while the driver brakes, by a negative drive torque or the brake",
        source="Zhileykin 2018, below eq 5: phi = pi, j_y = 0, j_x <= 0",
    )
    straight_angle: float = setting(
        0.2,
        unit="rad",
        low=0.0,
        high=1.5,
        about="angle between deceleration and the car's axis up to which j_y counts as zero for `straight`",
    )
    rear_wheels: str = parameter(
        "by_speed",
        choices=REAR_WHEELS,
        about="rear wheel that gets more: the slower one; or the inner one, which is the slower one unless it spins",
        source="Zhileykin 2018, eq 7: the lagging wheel",
    )
    first_branch: str = parameter(
        "front",
        choices=FIRST_BRANCHES,
        about="axle that counts as sliding until the slip angles differ by more than the deadband",
        source="assumption: equal slip angles count as a sliding front",
    )
    slip_angle_deadband: float = parameter(
        0.005,
        unit="rad",
        low=0.0,
        high=0.5,
        about="difference of the magnitudes of the slip angles that changes the branch; straight ahead it is undefined",
    )
    acceleration_deadband: float = parameter(
        0.1, unit="m/s^2", low=1e-6, high=5.0, about="acceleration below which its direction is undefined, and held"
    )
    speed_deadband: float = parameter(
        0.1, unit="rad/s", low=0.0, high=10.0, about="difference of the rear wheel speeds that changes the slower one"
    )
    observer: slip_angle_observer.SlipAngleObserverParameters = group(slip_angle_observer.SlipAngleObserverParameters)
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@compilable
def front_share(
    p: AxleRedistributionParameters, car: Car, front_slides: bool, cos_phi: float, acceleration: float, force: float
) -> float:
    """Share h_n [1] of the front axle, by the acceleration j [m/s^2], its angle phi to the car's axis and X [N].

    K cos(phi) while the front slides (eq 4, where |W12| = 0 gives h_n X = 2 J_z j cos(phi)/L^2), and `second_branch`
    while the rear does (eq 5), within 0..largest_front_share.
    """
    factor, lever = p.k, 2.0 * car.yaw_inertia / (car.wheelbase * car.wheelbase)
    if p.factor == INERTIA_FACTOR:
        factor = lever / car.mass
    elif p.factor == EQUALITY_FACTOR:
        factor = lever * min(acceleration, LARGEST_OF_CARS) / max(force, LEAST_FORCE)
    share = factor * cos_phi
    if not front_slides and p.second_branch == PRINTED:
        share = factor * (1.0 - cos_phi)
    elif not front_slides and p.second_branch == REAR_SHARE:
        share = 1.0 - share
    return min(max(share, 0.0), p.largest_front_share)


@compilable
def rear_difference(car: Car, road_wheel_angle: float, front_share: float) -> float:
    """The difference q = L |Theta| h_n/(2 B (1 - h_n)) [1], at most 1 (eq 7 at constant speed); Theta [rad], h_n < 1.

    Of the rear torque the slower wheel gets (1 + q)/2 and the faster one (1 - q)/2.
    """
    q = car.wheelbase * abs(road_wheel_angle) * front_share / (2.0 * car.rear_track * (1.0 - front_share))
    return min(q, 1.0)


@dataclass(slots=True)
class AxleRedistributionState:
    """What lasts between steps."""

    front_slides: float = entry(1.0, unit="1", about="whether the front axle counts as the sliding one")
    cos_phi: float = entry(1.0, unit="1", about="cosine of the angle of the acceleration to the travel, held")
    acceleration: float = entry(unit="m/s^2", about="magnitude of the acceleration, j")
    slower: float = entry(unit="1", about="slower rear wheel: 1 left, -1 right, 0 while none has been the slower one")
    observer: slip_angle_observer.SlipAngleObserverState = part(slip_angle_observer.SlipAngleObserverState)


@differential(
    "axle_redistribution",
    start=lambda p: AxleRedistributionState(front_slides=1.0 if p.first_branch == FRONT_BRANCH else 0.0),
    needs=(ALL_WHEELS_DRIVEN,),
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
    0..largest_front_share; 0 while the car slows down straight ahead; phi is the angle of the acceleration to the
    car's axis, in reverse to its rear (Zhileykin 2018, eqs 4 and 5). Of the rear torque the slower wheel gets (1 + q)/2
    and the faster one (1 - q)/2 with q = L |Theta| h_n/(2 B (1 - h_n)), Theta the road-wheel angle [rad] (eq 7).
    Parameters choose other readings of the source. The torques [N m] add up to the driver's; the lag of the clutches is
    the plant's.
    """
    delta, torque, speed = column.road_wheel_angle, driver.drive_torque, wheels.velocity
    ahead = -1.0 if (speed[0] + speed[1]) + (speed[2] + speed[3]) < 0.0 else 1.0
    if p.source == TRUTH or is_plausible(column, wheels, imu):
        if p.source == TRUTH:
            angles = slip_angle_observer.axle_slip_angles(
                car, body.longitudinal, body.lateral, body.yaw_rate, delta, p.observer.slowest
            )
        else:
            angles = slip_angle_observer.observed_slip_angles(
                p.observer, car, s.observer, period, driver, column, wheels, imu
            )
        # Branch, slower rear wheel and cos(phi) are held where they are not defined. In reverse speeding up is an
        # acceleration to the back.
        front_excess, right_excess = abs(angles.front) - abs(angles.rear), ahead * (speed.rear_right - speed.rear_left)
        if abs(front_excess) > p.slip_angle_deadband:
            s.front_slides = 1.0 if front_excess > 0.0 else 0.0
        if abs(right_excess) > p.speed_deadband:
            s.slower = 1.0 if right_excess > 0.0 else -1.0
        s.acceleration = hypot(imu.longitudinal_acceleration, imu.lateral_acceleration)
        if s.acceleration > p.acceleration_deadband:
            s.cos_phi = ahead * imu.longitudinal_acceleration / s.acceleration
    h = 0.0
    # The rear axle gets all torque, h = 0, for phi = pi, j_y = 0, j_x <= 0 (below eq 5).
    if p.braking == DRIVER_BRAKES:
        all_to_rear = ahead * torque < 0.0 or driver.brake_torque > 0.0
    else:
        all_to_rear = s.cos_phi <= (0.0 if p.braking == DECELERATES else -cos(p.straight_angle))
    if not all_to_rear:
        h = front_share(p, car, s.front_slides == 1.0, s.cos_phi, s.acceleration, ahead * torque / car.wheel_radius)
    inner = 1.0 if delta > 0.0 else -1.0
    q = rear_difference(car, delta, h) * (s.slower if p.rear_wheels == BY_SPEED else inner)
    front, rear = torque * h, torque * (1.0 - h)
    drive = Wheels(front / 2.0, front / 2.0, rear * (1.0 + q) / 2.0, rear * (1.0 - q) / 2.0)
    return WheelTorqueRequest(drive, split_brake(p.brake, driver))
