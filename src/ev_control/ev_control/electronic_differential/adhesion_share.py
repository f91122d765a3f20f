"""Torque by the grip of each wheel: method 5 of the dissertation's five."""

from __future__ import annotations

from dataclasses import dataclass, field

from ev_control.electronic_differential.torque_split import BrakeSplitParameters, TorqueSplit
from ev_control.friction_estimate import FrictionEstimate, FrictionEstimateParameters, FrictionEstimateState
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.signals import (
    DriverCommand,
    InertialMeasurement,
    SteeringColumnState,
    TireForces,
    WheelStates,
    WheelTorqueRequest,
)
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import WHEEL_NAMES, Wheels


@dataclass(frozen=True, slots=True)
class AdhesionShareParameters:
    """Where the friction comes from, and how wrong it is."""

    friction: str = parameter(
        "truth",
        choices=("truth", "estimated"),
        about="friction of the road: as the plant has it, or from slip and torque of the wheels",
        source="the dissertation takes it as known",
    )
    error_factor: float = parameter(
        1.0, unit="1", low=0.1, high=10.0, about="friction that the law believes in over that", source="assumption"
    )
    estimate: FrictionEstimateParameters = group(FrictionEstimateParameters)
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@dataclass(slots=True)
class AdhesionShareState:
    """The state of the friction estimate."""

    estimate: FrictionEstimateState = field(default_factory=FrictionEstimateState)


@method("electronic_differential", "adhesion_share")
class AdhesionShare:
    """Share the drive torque in proportion to the grip of the driven wheels, and give none of them more than that.

    tau_i = phi_i F_i r (dissertation, eq 1.2, at the wheel), M_i = min(M tau_i/sum(tau), tau_i). With `truth` friction
    and load are the plant's; else they come from `FrictionEstimate` and the accelerations. Braking by the drives is
    shared in the same way. ValueError if the vehicle has no driven wheel.
    """

    parameters = AdhesionShareParameters

    def __init__(self, parameters: AdhesionShareParameters, vehicle: Vehicle, period: float) -> None:
        self._split = TorqueSplit(parameters.brake, vehicle)
        self._knows = parameters.friction == "truth"
        self._lever = parameters.error_factor * vehicle.wheel_radius
        self._driven = [name in vehicle.driven_wheels for name in WHEEL_NAMES]
        law = "electronic_differential adhesion_share"
        self._estimate = FrictionEstimate(parameters.estimate, vehicle, period, law)
        self.state = AdhesionShareState(self._estimate.state)

    def step(
        self,
        driver: DriverCommand,
        column: SteeringColumnState,
        wheels: WheelStates,
        imu: InertialMeasurement,
        tires: TireForces,
    ) -> WheelTorqueRequest:
        """Wheel torques [N m] by grip."""
        total = driver.drive_torque
        if self._knows:
            friction, load = tires.friction_coefficient, tires.load
        else:
            self._estimate.state = self.state.estimate
            friction, load = self._estimate.step(total, column, wheels, imu)
        grip = [self._lever * friction[i] * load[i] if driven else 0.0 for i, driven in enumerate(self._driven)]
        # Left and right first, so that a mirrored car gets exactly mirrored torques.
        sum_of_grip = (grip[0] + grip[1]) + (grip[2] + grip[3])
        share = min(max(total / sum_of_grip, -1.0), 1.0) if sum_of_grip > 0.0 else 0.0
        return WheelTorqueRequest(Wheels(*[share * g for g in grip]), self._split.request(driver).brake)
