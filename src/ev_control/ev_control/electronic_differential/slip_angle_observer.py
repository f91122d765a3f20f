"""Slip angles of the axles, from the true motion or from what a car measures: kinematics plus a linear tyre."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ev_msgs_py.parameters import parameter
from ev_msgs_py.signals import DriverCommand, InertialMeasurement, SteeringColumnState, WheelStates
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import Wheels


@dataclass(frozen=True, slots=True)
class SlipAngleObserverParameters:
    """Trust in the accelerometer against the linear tyre, and what the tyre is like; all assumptions."""

    kinematic_share: float = parameter(
        0.9,
        unit="1",
        low=0.0,
        high=1.0,
        about="weight of the measured lateral acceleration against that of the linear tyre; the steady value is "
        "the tyre's alone unless it is 1, which drifts with every offset",
        source="assumption",
    )
    front_cornering_stiffness: float = parameter(
        160e3, unit="N/rad", low=1e3, high=1e6, about="of the front axle", source="assumption"
    )
    rear_cornering_stiffness: float = parameter(
        160e3, unit="N/rad", low=1e3, high=1e6, about="of the rear axle", source="assumption"
    )
    slowest: float = parameter(
        1.0, unit="m/s", low=0.1, high=10.0, about="speed at which slip angles are taken at least", source="assumption"
    )


@dataclass(slots=True)
class SlipAngleObserverState:
    """Estimated lateral velocity of the centre of mass [m/s]."""

    lateral_velocity: float = 0.0


def axle_slip_angles(
    longitudinal: float, lateral: float, yaw_rate: float, road_wheel_angle: float, vehicle: Vehicle, slowest: float
) -> tuple[float, float]:
    """Slip angles d1, d2 of the middles of the axles [rad], positive in a left turn without drive.

    d1 = delta - atan((v + a r)/u), d2 = -atan((v - b r)/u), from the velocities u, v of the centre of mass [m/s], the
    yaw rate r [rad/s] and the mean road-wheel angle delta [rad]; u is at least `slowest` [m/s]. Signs of Zhileykin
    (2018), fig 1.
    """
    u, b = max(longitudinal, slowest), vehicle.centre_of_mass_to_rear_axle
    a = vehicle.wheelbase - b
    return road_wheel_angle - math.atan((lateral + a * yaw_rate) / u), -math.atan((lateral - b * yaw_rate) / u)


class SlipAngleObserver:
    """Estimate the slip angles of both axles from wheel speeds, yaw rate, lateral acceleration and steering angle.

    The lateral velocity v follows v' = w a_y + (1 - w) a_tyre - r u, with the measured a_y and that of linear tyres,
    m a_tyre = C_1 (delta - (v + a r)/u) - C_2 (v - b r)/u: kinematics hold on every road but drift, the tyre does not
    drift but underrates the slip angles on a slippery road; w only sets how long the kinematics lead, because in a
    steady turn a_y = r u and the tyre alone decides. Implicit Euler, stable at every speed. The speed u is that of
    the slowest wheel, brought to the centre of mass, or of the fastest one under braking. No source has it.
    """

    def __init__(self, parameters: SlipAngleObserverParameters, vehicle: Vehicle, period: float) -> None:
        self._p = parameters
        self._vehicle = vehicle
        self._period = period
        self.state = SlipAngleObserverState()

    def step(
        self, driver: DriverCommand, column: SteeringColumnState, wheels: WheelStates, imu: InertialMeasurement
    ) -> tuple[float, float]:
        """Estimated slip angles d1, d2 of the front and the rear axle [rad], as `axle_slip_angles` counts them."""
        p, s, car, dt = self._p, self.state, self._vehicle, self._period
        delta, r, w = column.road_wheel_angle, imu.yaw_rate, p.kinematic_share
        speeds = self._speeds(wheels.velocity, delta, r)
        braking = driver.brake_torque > 0.0 or driver.drive_torque < 0.0
        u = max(max(speeds) if braking else min(speeds), p.slowest)
        b = car.centre_of_mass_to_rear_axle
        front, rear = p.front_cornering_stiffness / car.mass, p.rear_cornering_stiffness / car.mass
        at_rest = front * (delta - (car.wheelbase - b) * r / u) + rear * b * r / u
        damping = (1 - w) * (front + rear) / u
        lateral_acceleration = w * imu.lateral_acceleration + (1 - w) * at_rest
        s.lateral_velocity = (s.lateral_velocity + dt * (lateral_acceleration - r * u)) / (1 + dt * damping)
        return axle_slip_angles(u, s.lateral_velocity, r, delta, car, p.slowest)

    def _speeds(self, wheel_velocity: Wheels, delta: float, yaw_rate: float) -> tuple[float, ...]:
        """Longitudinal velocity of the centre of mass [m/s] as each wheel alone would have it, rolling without slip."""
        car, v = self._vehicle, self.state.lateral_velocity
        across = (v + (car.wheelbase - car.centre_of_mass_to_rear_axle) * yaw_rate) * math.sin(delta)
        radius, front, rear = car.wheel_radius, car.front_track / 2 * yaw_rate, car.rear_track / 2 * yaw_rate
        return (
            (wheel_velocity.front_left * radius - across) / math.cos(delta) + front,
            (wheel_velocity.front_right * radius - across) / math.cos(delta) - front,
            wheel_velocity.rear_left * radius + rear,
            wheel_velocity.rear_right * radius - rear,
        )
