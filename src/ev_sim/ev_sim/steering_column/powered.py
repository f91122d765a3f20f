"""A steering column that the driver and the difference of the front drives turn (Shchur 2019, eq 3)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.methods import method
from ev_msgs_py.signals import DriverCommand, SteeringColumnState, WheelStates
from ev_msgs_py.vehicle import Vehicle
from ev_sim.steering_column.drive_forces import DriveForceDifference
from ev_sim.steering_column.road_wheels import DrivenRoadWheelParameters, connected_column


@dataclass(slots=True)
class PoweredColumnState:
    """Road-wheel angle [rad] and rate [rad/s], last hand torque [N m], last wheel speed difference [rad/s]."""

    road_wheel_angle: float = 0.0
    road_wheel_rate: float = 0.0
    hand_torque: float = 0.0
    wheel_speed_difference: float = 0.0


@method("steering_column", "powered")
class PoweredColumn:
    """Turn the road wheels by hand and by the difference of the front drive torques (eq 3 in full).

    J_p d'' + b_p d' + k_p d = d_track/(2 r_k) (M_R - M_L) + i M_b - M_c sgn(d') - J_k d_track/(2 r_k) (w_R' - w_L'),
    with d the road-wheel angle, M_R and M_L the actual drive torques of the front wheels and M_b the hand torque at
    the steering wheel; left positive; the steering-wheel angle is i d. Shchur (2019), eq 3. The wheels start at rest.
    """

    parameters = DrivenRoadWheelParameters

    def __init__(self, parameters: DrivenRoadWheelParameters, vehicle: Vehicle, period: float) -> None:
        self._ratio = vehicle.steering_ratio
        self._road_wheels = parameters.oscillator(period)
        self._drives = DriveForceDifference(parameters.wheel_inertia, vehicle, period)
        self.state = PoweredColumnState()

    def outputs(self) -> tuple[SteeringColumnState]:
        """The column at this instant; the hand torque is the one that acted up to now."""
        s = self.state
        return (connected_column(self._ratio, s.road_wheel_angle, s.road_wheel_rate, s.hand_torque),)

    def advance(self, driver: DriverCommand, wheels: WheelStates) -> None:
        """Go on by one period under the hand torque and the drive torques."""
        s, drives = self.state, self._drives
        moment = drives.moment(wheels, s.wheel_speed_difference) + self._ratio * driver.hand_torque
        s.wheel_speed_difference = drives.speed_difference(wheels)
        s.hand_torque = driver.hand_torque
        s.road_wheel_angle, s.road_wheel_rate = self._road_wheels.advance(s.road_wheel_angle, s.road_wheel_rate, moment)
