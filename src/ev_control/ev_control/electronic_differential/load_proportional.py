"""Torque by load and rolling resistance of each wheel (dissertation, eq 1.3)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_control.estimation.plausible import wheel_loads
from ev_control.law import AllocationParameters, allocated, own_motors_to_allocate
from ev_control.shared.torque_split import BrakeSplitParameters, split, split_brake
from ev_core.law import Car, ParameterError, Vehicle, compilable, each_driven, group, method, parameter
from ev_msgs_py.contract.signals import DriverCommand, InertialMeasurement, WheelStates, WheelTorqueRequest
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels


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
        per_wheel=True,
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)

    def __post_init__(self) -> None:
        if len(self.rolling_resistance) != len(WHEEL_NAMES):
            raise ParameterError(
                f"rolling_resistance has {len(self.rolling_resistance)} elements, allowed is one for each wheel, four"
            )


class Prepared(NamedTuple):
    """What the law is told once."""

    resistance: tuple[float, ...]  # rolling resistance under each wheel [1], zero where none is driven


def prepare(parameters: LoadProportionalParameters, vehicle: Vehicle, _period: float) -> Prepared:
    """The rolling resistance of the wheels that count."""
    by_name = zip(WHEEL_NAMES, parameters.rolling_resistance, strict=True)
    return Prepared(tuple(f if name in vehicle.driven_wheels else 0.0 for name, f in by_name))


@method(
    "electronic_differential",
    "load_proportional",
    LoadProportionalParameters,
    prepare=prepare,
    needs=(each_driven, own_motors_to_allocate),
    mirrored=True,
)
@compilable
def load_proportional(
    p: LoadProportionalParameters,
    car: Car,
    c: Prepared,
    driver: DriverCommand,
    imu: InertialMeasurement,
    wheels: WheelStates,
) -> WheelTorqueRequest:
    """Share the drive torque in proportion to load times rolling resistance of the driven wheels.

    M_i/M_a = f_i G_i/(sum f G), the sum over driven wheels (dissertation, eq 1.3); loads [N] from the accelerations
    by `wheel_loads`. Driven wheels that carry nothing, as those of an axle far from the centre of mass, get equal
    torques [N m].
    """
    load, total = wheel_loads(car, imu), driver.drive_torque
    front_left, front_right = c.resistance[0] * load[0], c.resistance[1] * load[1]
    rear_left, rear_right = c.resistance[2] * load[2], c.resistance[3] * load[3]
    # Left and right first, so that a mirrored car gets exactly mirrored torques.
    weight = (front_left + front_right) + (rear_left + rear_right)
    if weight == 0.0:
        return split(p.brake, car, driver, 0.0)
    drive = Wheels(
        total * front_left / weight,
        total * front_right / weight,
        total * rear_left / weight,
        total * rear_right / weight,
    )
    return allocated(p.allocation, car, wheels, WheelTorqueRequest(drive, split_brake(p.brake, driver)))
