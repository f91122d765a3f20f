"""Torque by load and rolling resistance of each wheel (dissertation, eq 1.3)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.electronic_differential.torque_split import BrakeSplitParameters, TorqueSplit
from ev_control.wheel_loads import WheelLoads
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import ParameterError, group, parameter
from ev_msgs_py.signals import DriverCommand, InertialMeasurement, WheelTorqueRequest
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import WHEEL_NAMES, Wheels


@dataclass(frozen=True, slots=True)
class LoadProportionalParameters:
    """The rolling resistance under the wheels, which no sensor of a car measures."""

    rolling_resistance: tuple[float, ...] = parameter(
        (1.0, 1.0, 1.0, 1.0),
        unit="1",
        low=1e-6,
        high=1e6,
        about="of front left, front right, rear left and rear right wheel; only their ratios count",
        source="assumption: the same under all wheels",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)

    def __post_init__(self) -> None:
        if len(self.rolling_resistance) != len(WHEEL_NAMES):
            raise ParameterError(
                f"rolling_resistance has {len(self.rolling_resistance)} elements, allowed is one for each wheel, four"
            )


@method("electronic_differential", "load_proportional")
class LoadProportional:
    """Share the drive torque in proportion to load times rolling resistance of the driven wheels.

    M_i/M_a = f_i G_i/(sum f G), the sum over driven wheels (dissertation, eq 1.3); loads from the accelerations by
    `WheelLoads`. ValueError if the vehicle has no driven wheel.
    """

    parameters = LoadProportionalParameters
    state = None  # nothing lasts between steps

    def __init__(self, parameters: LoadProportionalParameters, vehicle: Vehicle, period: float) -> None:
        self._split = TorqueSplit(parameters.brake, vehicle)
        self._loads = WheelLoads(vehicle)
        self._resistance = [
            f if name in vehicle.driven_wheels else 0.0
            for f, name in zip(parameters.rolling_resistance, WHEEL_NAMES, strict=True)
        ]

    def step(self, driver: DriverCommand, imu: InertialMeasurement) -> WheelTorqueRequest:
        """Wheel torques [N m] by the present loads."""
        along, across = imu.longitudinal_acceleration, imu.lateral_acceleration
        weights = [f * self._loads.of(i, along, across) for i, f in enumerate(self._resistance)]
        # Left and right first, so that a mirrored car gets exactly mirrored torques.
        total = (weights[0] + weights[1]) + (weights[2] + weights[3])
        drive = Wheels(*[driver.drive_torque * weight / total for weight in weights])
        return WheelTorqueRequest(drive, self._split.request(driver).brake)
