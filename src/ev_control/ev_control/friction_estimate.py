"""Friction of the road under each driven wheel, learnt while it slips."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.first_order_filter import filter_share
from ev_control.friction_learning import FrictionLearningParameters
from ev_control.reference_speed import ReferenceSpeed, ReferenceSpeedParameters, ReferenceSpeedState
from ev_control.wheel_loads import WheelLoads
from ev_msgs_py.parameters import group
from ev_msgs_py.signals import InertialMeasurement, SteeringColumnState, WheelStates
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import NO_WHEELS, WHEEL_NAMES, Wheels


@dataclass(frozen=True, slots=True)
class FrictionEstimateParameters(FrictionLearningParameters):
    """How friction is learnt, and against which speed slip counts."""

    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)


@dataclass(slots=True)
class FrictionEstimateState:
    """Estimated and filtered friction in use by wheel [1], last wheel speeds [rad/s], and the reference speed."""

    friction: Wheels = NO_WHEELS
    used: Wheels = NO_WHEELS
    velocity: Wheels | None = None
    reference: ReferenceSpeedState | None = None


class FrictionEstimate:
    """mu = (M - J w')/(F_z r) of a wheel that slips; of one that does not, a value that slowly rises (assumption).

    See `FrictionLearningParameters.learnt`. Loads by `WheelLoads`.
    """

    def __init__(self, parameters: FrictionEstimateParameters, vehicle: Vehicle, period: float, law: str) -> None:
        p = self._p = parameters
        self._period = period
        self._inertia, self._radius = vehicle.driven_wheel_inertia, vehicle.wheel_radius
        self._share = filter_share(period, p.filter_time)
        self._loads = WheelLoads(vehicle)
        self._driven = [name in vehicle.driven_wheels for name in WHEEL_NAMES]
        self._reference = ReferenceSpeed(p.reference, vehicle, period, law)
        self.state = FrictionEstimateState(Wheels.all(p.largest_friction), reference=self._reference.state)

    def step(
        self, drive_torque: float, column: SteeringColumnState, wheels: WheelStates, imu: InertialMeasurement
    ) -> tuple[Wheels, Wheels]:
        """Friction [1] and load [N] of each wheel; of the drive torque of all wheels [N m] only the sign counts."""
        p, s, velocity = self._p, self.state, wheels.velocity
        direction = (drive_torque > 0.0) - (drive_torque < 0.0)
        self._reference.state = s.reference
        rolling = self._reference.rolling_speeds(velocity, column.road_wheel_angle, imu, direction)
        before = s.velocity or velocity
        loads, friction, used = [], list(s.friction), list(s.used)
        for i, driven in enumerate(self._driven):
            load = self._loads.of(i, imu.longitudinal_acceleration, imu.lateral_acceleration)
            loads.append(load)
            if not driven or direction == 0:
                continue
            road = wheels.effort[i] - self._inertia * (velocity[i] - before[i]) / self._period
            used[i] += self._share * (direction * road / (load * self._radius) - used[i])
            slip = direction * (velocity[i] - rolling[i]) / max(abs(velocity[i]), p.slowest)
            friction[i] = p.learnt(friction[i], used[i], slip, self._period)
        s.velocity, s.friction, s.used = velocity, Wheels(*friction), Wheels(*used)
        return s.friction, Wheels(*loads)
