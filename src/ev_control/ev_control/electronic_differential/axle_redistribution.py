"""Drive torque moved between the axles and the rear wheels of a 4x4 by the slip angles (Zhileykin 2018)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.plausible import is_plausible
from ev_control.estimation.slip_angle_observer import (
    SlipAngleObserverParameters,
    SlipAngleObserverState,
    axle_slip_angles,
    observed_slip_angles,
)
from ev_control.shared.sources import SOURCES, TRUTH
from ev_control.shared.torque_split import BrakeSplitParameters, split_brake
from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.record import entry, part
from ev_msgs_py.contract.signals import (
    BodyVelocity,
    DriverCommand,
    InertialMeasurement,
    SteeringColumnState,
    WheelStates,
    WheelTorqueRequest,
)
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.elementary import hypot
from ev_msgs_py.lockstep.methods import method
from ev_msgs_py.parameters.declaration import group, parameter
from ev_msgs_py.vehicle.car import Car
from ev_msgs_py.vehicle.layout import ALL_WHEELS_DRIVEN

AXLES = ("front", "rear")
FRONT, REAR = range(len(AXLES))


@dataclass(frozen=True, slots=True)
class AxleRedistributionParameters:
    """The factor that the source leaves open, where the slip angles come from, and deadbands."""

    source: str = parameter(
        "truth",
        choices=SOURCES,
        about="slip angles: from the true velocity of the twist topic, or from the observer",
        source="Zhileykin 2018 uses the true ones",
    )
    k: float = parameter(
        1.0,
        unit="1",
        low=0.0,
        high=5.0,
        about="front share over cos(phi), or over 1 - cos(phi); eq 4 with j cos(phi) = X/m gives 2 J_z/(m L^2) instead",
        source="Zhileykin 2018, eqs 4 and 5, factor not given",
    )
    largest_front_share: float = parameter(
        0.5, unit="1", low=0.0, high=0.9, about="limit of the front share h_n", source="Zhileykin 2018"
    )
    first_branch: str = parameter(
        "front",
        choices=AXLES,
        about="axle that counts as sliding until the slip angles differ by more than the deadband",
        source="Zhileykin 2018 counts equal slip angles as a sliding front",
    )
    slip_angle_deadband: float = parameter(
        0.005,
        unit="rad",
        low=0.0,
        high=0.5,
        about="difference of the magnitudes of the slip angles that changes the branch; straight ahead it is undefined",
        source="assumption",
    )
    acceleration_deadband: float = parameter(
        0.1,
        unit="m/s^2",
        low=1e-6,
        high=5.0,
        about="acceleration below which its direction is undefined and the last one is held",
        source="assumption",
    )
    observer: SlipAngleObserverParameters = group(SlipAngleObserverParameters)
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@dataclass(slots=True)
class AxleRedistributionState:
    """What lasts between steps."""

    front_slides: float = entry(1.0, unit="1", about="whether the front axle counts as the sliding one")
    cos_phi: float = entry(1.0, unit="1", about="cosine of the angle of the acceleration to the car's axis, held")
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
    """Share the drive torque between front axle, inner and outer rear wheel so that the car steers neutrally.

    Front share h_n = k cos(phi) if the front axle slides (|d1| >= |d2|), else k (1 - cos(phi)), within
    0..largest_front_share, where phi is the angle of the acceleration to the car's axis (Zhileykin 2018, eqs 4 and 5).
    The front wheels get equal halves. Of the rear torque the slow (inner) wheel gets (1 + q)/2 and the fast (outer)
    one (1 - q)/2 with q = L |Theta| h_n/(2 B (1 - h_n)), at most 1 (eq 7 at constant speed), by the mean road-wheel
    angle Theta [rad]. A driver who brakes, with a negative drive torque or the brake, has all drive torque on the rear
    axle. The torques [N m] add up to the driver's. The lag of the clutches is the plant's. With `estimated` slip angles
    an absurd measurement changes nothing.
    """
    delta = column.road_wheel_angle
    if p.source == TRUTH:
        angles = axle_slip_angles(car, body.longitudinal, body.lateral, body.yaw_rate, delta, p.observer.slowest)
        follow(p, s, abs(angles.front) - abs(angles.rear), imu)
    elif is_plausible(column, wheels, imu):
        angles = observed_slip_angles(p.observer, car, s.observer, period, driver, column, wheels, imu)
        follow(p, s, abs(angles.front) - abs(angles.rear), imu)
    braking = driver.drive_torque < 0.0 or driver.brake_torque > 0.0
    h = 0.0 if braking else front_share(p, s)
    half, rear_torque = driver.drive_torque * h / 2.0, driver.drive_torque * (1.0 - h)
    q = min(car.wheelbase * abs(delta) * h / (2.0 * car.rear_track * (1.0 - h)), 1.0)
    left, right = rear_torque * (1.0 + q) / 2.0, rear_torque * (1.0 - q) / 2.0
    if delta < 0.0:
        left, right = right, left
    return WheelTorqueRequest(Wheels(half, half, left, right), split_brake(p.brake, driver))


@compilable
def follow(
    p: AxleRedistributionParameters, s: AxleRedistributionState, front_excess: float, imu: InertialMeasurement
) -> None:
    """Choose the branch by |d1| - |d2| [rad] and take cos(phi) where they are defined."""
    if abs(front_excess) > p.slip_angle_deadband:
        s.front_slides = 1.0 if front_excess > 0.0 else 0.0
    magnitude = hypot(imu.longitudinal_acceleration, imu.lateral_acceleration)
    if magnitude > p.acceleration_deadband:
        s.cos_phi = imu.longitudinal_acceleration / magnitude


@compilable
def front_share(p: AxleRedistributionParameters, s: AxleRedistributionState) -> float:
    """h_n [1] of the present branch (Zhileykin 2018, eqs 4 and 5)."""
    share = p.k * s.cos_phi if s.front_slides == 1.0 else p.k * (1.0 - s.cos_phi)
    return min(max(share, 0.0), p.largest_front_share)
