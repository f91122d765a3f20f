"""The speed that traction control counts slip against: what every wheel would turn at if it rolled."""

from __future__ import annotations

from ev_control.estimation.reference_speed import ReferenceSpeedParameters, ReferenceSpeedState
from ev_msgs_py.elementary import cos, sin
from ev_msgs_py.signals import InertialMeasurement
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import WHEEL_NAMES, Wheels


class ReferenceSpeed:
    """Speed of the car, and from it the rolling speed of each wheel in the bend that the car drives.

    The middle of the rear axle is taken to move straight ahead. Left wheels then move at u - r t/2 and right ones at
    u + r t/2 along the car (track t, yaw rate r), and steered ones at (u -+ r t/2) cos(delta) + L r sin(delta) along
    themselves. `free_wheels` turns this round and takes the mean of the wheels without a motor, which roll as long as
    nobody brakes. `observer` integrates the longitudinal acceleration. A wheel that is driven never turns slower than
    it would roll, a braked one never faster: so the slowest wheel (braking: the fastest) limits the estimate quickly
    (`gripping_rate`) and otherwise only draws it slowly (`slipping_rate`). ValueError for `free_wheels` where all
    wheels are driven.
    """

    def __init__(self, parameters: ReferenceSpeedParameters, vehicle: Vehicle, period: float, law: str) -> None:
        self._p = parameters
        self._period = period
        self._radius, self._wheelbase = vehicle.wheel_radius, vehicle.wheelbase
        front, rear = vehicle.front_track / 2, vehicle.rear_track / 2
        self._half_track = (-front, front, -rear, rear)
        free = [i for i, name in enumerate(WHEEL_NAMES) if name not in vehicle.driven_wheels]
        if parameters.source == "free_wheels" and not free:
            raise ValueError(
                f"asr {law} needs a wheel without a motor for reference.source free_wheels, vehicle {vehicle.name}"
                " drives all four; observer and automatic need none"
            )
        self._observes = parameters.source == "observer" or not free
        self._wheels = tuple(range(len(WHEEL_NAMES))) if self._observes else tuple(free)
        self.state = ReferenceSpeedState()

    def rolling_speeds(
        self, velocity: Wheels, road_wheel_angle: float, imu: InertialMeasurement, direction: float
    ) -> tuple[float, float, float, float]:
        """Speeds [rad/s] at which the wheels would roll; `direction` is the sign of what the drives are asked for.

        `velocity` are wheel speeds [rad/s]. The angle is that of the road wheels [rad], within -pi/2..pi/2.
        """
        r, radius = imu.yaw_rate, self._radius
        cosine, across = cos(road_wheel_angle), self._wheelbase * r * sin(road_wheel_angle)
        speeds = []
        for i in self._wheels:
            along = velocity[i] * radius
            if i < 2:
                along = (along - across) / cosine
            speeds.append(along - r * self._half_track[i])
        if self._observes:
            u = self._observed(speeds, imu.longitudinal_acceleration, direction)
        else:
            u = sum(speeds) / len(speeds)
        self.state.speed = u
        front, rear = r * self._half_track[1], r * self._half_track[3]
        return (
            ((u - front) * cosine + across) / radius,
            ((u + front) * cosine + across) / radius,
            (u - rear) / radius,
            (u + rear) / radius,
        )

    def _observed(self, speeds: list[float], acceleration: float, direction: float) -> float:
        """The estimate [m/s] from what each wheel would mean if it rolled [m/s] and the acceleration [m/s^2]."""
        p, dt = self._p, self._period
        u = self.state.speed + acceleration * dt
        if direction == 0.0:
            gap = (min(speeds) + max(speeds)) / 2 - u  # wheels without torque roll
            return u + gap * min(p.gripping_rate * dt, 1.0)
        gap = (min(speeds) if direction > 0.0 else max(speeds)) - u
        rate = p.gripping_rate if gap * direction < 0.0 else p.slipping_rate
        return u + gap * min(rate * dt, 1.0)
