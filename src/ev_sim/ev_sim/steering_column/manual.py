"""A steering column that only the driver turns (Shchur 2019, eq 3 without the differential torque)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.methods import method
from ev_msgs_py.signals import DriverCommand, SteeringColumnState
from ev_msgs_py.vehicle import Vehicle
from ev_sim.steering_column.road_wheels import RoadWheelParameters, connected_column


@dataclass(slots=True)
class ManualColumnState:
    """Road-wheel angle [rad] and rate [rad/s], and the last hand torque [N m]; left positive."""

    road_wheel_angle: float = 0.0
    road_wheel_rate: float = 0.0
    hand_torque: float = 0.0


@method("steering_column", "manual")
class ManualColumn:
    """Turn the road wheels by hand alone: a steering geometry that gives the drive forces no lever arm.

    J_p d'' + b_p d' + k_p d = i M_b - M_c sgn(d'), with d the road-wheel angle and M_b the hand torque at the steering
    wheel, both left positive; the steering-wheel angle is i d. Shchur (2019), eqs 3 and 6.
    """

    parameters = RoadWheelParameters

    def __init__(self, parameters: RoadWheelParameters, vehicle: Vehicle, period: float) -> None:
        self._ratio = vehicle.steering_ratio
        self._road_wheels = parameters.oscillator(period)
        self.state = ManualColumnState()

    def outputs(self) -> tuple[SteeringColumnState]:
        """The column at this instant; the hand torque is the one that acted up to now."""
        s = self.state
        return (connected_column(self._ratio, s.road_wheel_angle, s.road_wheel_rate, s.hand_torque),)

    def advance(self, driver: DriverCommand) -> None:
        """Go on by one period under the hand torque."""
        s = self.state
        s.hand_torque = driver.hand_torque
        s.road_wheel_angle, s.road_wheel_rate = self._road_wheels.advance(
            s.road_wheel_angle, s.road_wheel_rate, self._ratio * driver.hand_torque
        )
