"""A steering wheel without mechanical connection; only the front drives turn the road wheels (Shchur 2019)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.signals import DriverCommand, SteeringColumnState, WheelStates
from ev_msgs_py.vehicle import Vehicle
from ev_sim.steering_column.drive_forces import DriveForceDifference
from ev_sim.steering_column.friction_oscillator import FrictionOscillator
from ev_sim.steering_column.road_wheels import DrivenRoadWheelParameters


@dataclass(frozen=True, slots=True)
class SteeringWheelParameters:
    """The steering wheel on its own, at the steering wheel; the paper describes none."""

    inertia: float = parameter(
        0.04, unit="kg m^2", low=0.001, high=1.0, about="inertia, as of an ordinary steering wheel", source="assumption"
    )
    damping: float = parameter(
        0.16, unit="N m s/rad", low=0.0, high=10.0, about="viscous friction, about 0.8 of critical", source="assumption"
    )
    centring_stiffness: float = parameter(
        0.25,
        unit="N m/rad",
        low=0.001,
        high=10.0,
        about="centring spring, as stiff as the mechanical column feels, k_p/i^2",
        source="assumption",
    )
    dry_friction: float = parameter(0.0, unit="N m", low=0.0, high=10.0, about="dry friction", source="assumption")


@dataclass(frozen=True, slots=True)
class ByWireParameters(DrivenRoadWheelParameters):
    """The road wheels of eq 3, and a steering wheel that does not reach them."""

    steering_wheel: SteeringWheelParameters = group(SteeringWheelParameters)


@dataclass(slots=True)
class ByWireState:
    """Angles [rad] and rates [rad/s] of road wheels and steering wheel, last hand torque [N m] and speed difference."""

    road_wheel_angle: float = 0.0
    road_wheel_rate: float = 0.0
    angle: float = 0.0
    rate: float = 0.0
    hand_torque: float = 0.0
    wheel_speed_difference: float = 0.0


@method("steering_column", "by_wire")
class ByWireColumn:
    """Turn the road wheels by the front drives alone; the hands turn a steering wheel with a centring spring.

    Road wheels: eq 3 of Shchur (2019) with M_b = 0, as in its steer-by-wire and drive-by-wire concepts. Steering
    wheel: J a'' + b a' + k a = M_b - M sgn(a'), end stops at i times those of the road wheels. Left positive.
    """

    parameters = ByWireParameters

    def __init__(self, parameters: ByWireParameters, vehicle: Vehicle, period: float) -> None:
        wheel = parameters.steering_wheel
        self._road_wheels = parameters.oscillator(period)
        self._steering_wheel = FrictionOscillator(
            wheel.inertia,
            wheel.damping,
            wheel.centring_stiffness,
            wheel.dry_friction,
            vehicle.steering_ratio * parameters.max_angle,
            period,
        )
        self._drives = DriveForceDifference(parameters.wheel_inertia, vehicle, period)
        self.state = ByWireState()

    def outputs(self) -> tuple[SteeringColumnState]:
        """The column at this instant; the hand torque is the one that acted up to now."""
        s = self.state
        return (SteeringColumnState(s.angle, s.rate, s.hand_torque, s.road_wheel_angle, s.road_wheel_rate),)

    def advance(self, driver: DriverCommand, wheels: WheelStates) -> None:
        """Go on by one period: the hands turn the steering wheel, the drive torques the road wheels."""
        s, drives = self.state, self._drives
        moment = drives.moment(wheels, s.wheel_speed_difference)
        s.wheel_speed_difference = drives.speed_difference(wheels)
        s.hand_torque = driver.hand_torque
        s.angle, s.rate = self._steering_wheel.advance(s.angle, s.rate, driver.hand_torque)
        s.road_wheel_angle, s.road_wheel_rate = self._road_wheels.advance(s.road_wheel_angle, s.road_wheel_rate, moment)
