"""Drive torque moved between the axles and the rear wheels of a 4x4 by the slip angles (Zhileykin 2018)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from ev_control.electronic_differential.slip_angle_observer import (
    SlipAngleObserver,
    SlipAngleObserverParameters,
    SlipAngleObserverState,
    axle_slip_angles,
)
from ev_control.electronic_differential.torque_split import BrakeSplitParameters, TorqueSplit, require_driven_wheels
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.signals import (
    BodyVelocity,
    DriverCommand,
    InertialMeasurement,
    SteeringColumnState,
    WheelStates,
    WheelTorqueRequest,
)
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import WHEEL_NAMES, Wheels


@dataclass(frozen=True, slots=True)
class AxleRedistributionParameters:
    """The factor that the source leaves open, where the slip angles come from, and deadbands."""

    source: str = parameter(
        "truth",
        choices=("truth", "estimated"),
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
        choices=("front", "rear"),
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
    """The branch of the law, the held cos(phi) [1] and the observer's state."""

    front_slides: bool
    cos_phi: float = 1.0
    observer: SlipAngleObserverState = field(default_factory=SlipAngleObserverState)


@method("electronic_differential", "axle_redistribution")
class AxleRedistribution:
    """Share the drive torque between front axle, inner and outer rear wheel so that the car steers neutrally.

    Front share h_n = k cos(phi) if the front axle slides (|d1| >= |d2|), else k (1 - cos(phi)), within
    0..largest_front_share, where phi is the angle of the acceleration to the car's axis (Zhileykin 2018, eqs 4 and 5).
    The front wheels get equal halves. Of the rear torque the slow (inner) wheel gets (1 + q)/2 and the fast (outer)
    one (1 - q)/2 with q = L |Theta| h_n/(2 B (1 - h_n)), at most 1 (eq 7 at constant speed), by the mean road-wheel
    angle Theta [rad]. A driver who brakes, with a negative drive torque or the brake, has all drive torque on the rear
    axle. The lag of the clutches is the plant's. ValueError unless all four wheels are driven.
    """

    parameters = AxleRedistributionParameters

    def __init__(self, parameters: AxleRedistributionParameters, vehicle: Vehicle, period: float) -> None:
        require_driven_wheels(vehicle, "axle_redistribution", WHEEL_NAMES)
        self._p = parameters
        self._vehicle = vehicle
        self._split = TorqueSplit(parameters.brake, vehicle)
        self._observer = SlipAngleObserver(parameters.observer, vehicle, period)
        front_first = parameters.first_branch == "front"
        self.state = AxleRedistributionState(front_first, observer=self._observer.state)

    def step(
        self,
        driver: DriverCommand,
        column: SteeringColumnState,
        wheels: WheelStates,
        imu: InertialMeasurement,
        body: BodyVelocity,
    ) -> WheelTorqueRequest:
        """Wheel torques [N m] that add up to the driver's."""
        p, s, car, delta = self._p, self.state, self._vehicle, column.road_wheel_angle
        if p.source == "truth":
            front, rear = axle_slip_angles(
                body.longitudinal, body.lateral, body.yaw_rate, delta, car, p.observer.slowest
            )
        else:
            self._observer.state = s.observer
            front, rear = self._observer.step(driver, column, wheels, imu)
        self._follow(abs(front) - abs(rear), imu)
        braking = driver.drive_torque < 0.0 or driver.brake_torque > 0.0
        h = 0.0 if braking else self._front_share()
        half, rear_torque = driver.drive_torque * h / 2, driver.drive_torque * (1 - h)
        q = min(car.wheelbase * abs(delta) * h / (2 * car.rear_track * (1 - h)), 1.0)
        inner, outer = rear_torque * (1 + q) / 2, rear_torque * (1 - q) / 2
        left, right = (inner, outer) if delta >= 0.0 else (outer, inner)
        return WheelTorqueRequest(Wheels(half, half, left, right), self._split.request(driver).brake)

    def _follow(self, front_excess: float, imu: InertialMeasurement) -> None:
        """Choose the branch by |d1| - |d2| [rad] and take cos(phi) where they are defined."""
        p, s = self._p, self.state
        if abs(front_excess) > p.slip_angle_deadband:
            s.front_slides = front_excess > 0.0
        magnitude = math.hypot(imu.longitudinal_acceleration, imu.lateral_acceleration)
        if magnitude > p.acceleration_deadband:
            s.cos_phi = imu.longitudinal_acceleration / magnitude

    def _front_share(self) -> float:
        """h_n [1] of the present branch (Zhileykin 2018, eqs 4 and 5)."""
        p, s = self._p, self.state
        share = p.k * s.cos_phi if s.front_slides else p.k * (1 - s.cos_phi)
        return min(max(share, 0.0), p.largest_front_share)
