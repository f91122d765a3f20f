"""Torque by load or grip of wheels (dissertation), or by the steering angle (Tatar & Chudzik)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import auto
from typing import NamedTuple

from ev_control.estimation import friction_estimate
from ev_control.estimation.plausible import Sensors
from ev_control.estimation.reference_speed import free_wheels_for
from ev_control.estimation.wheel_dynamics import wheel_loads
from ev_control.law import BrakeSplitParameters, split, split_brake
from ev_control.shared.allocation import AllocationParameters, allocated, own_motors_to_allocate
from ev_control.shared.torque_split import KnownBy, differential
from ev_core.law import (
    WHEEL_NAMES,
    Choice,
    InertialMeasurement,
    Vehicle,
    Wheels,
    compilable,
    group,
    parameter,
    part,
)
from ev_core.vehicle.car import FRONT_WHEELS_DRIVEN, REAR_WHEELS_DRIVEN, Car, each_driven
from ev_msgs_py.contract.signals import (
    DriverCommand,
    SteeringColumnState,
    TireForces,
    WheelStates,
    WheelTorqueRequest,
)
from ev_msgs_py.refusal import ParameterError


class CorrectedAxle(Choice):
    """Axle with different torques left and right."""

    AUTOMATIC = auto()
    FRONT = auto()
    REAR = auto()


@dataclass(frozen=True, slots=True)
class LoadShareParameters:
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
                f"rolling_resistance has {len(self.rolling_resistance)} elements, expected one "
                f"for each wheel, four"
            )


class Prepared(NamedTuple):
    """Numbers that are computed once."""

    resistance: tuple[
        float, ...
    ]  # rolling resistance under each wheel [1], zero where none is driven


def prepare(parameters: LoadShareParameters, vehicle: Vehicle, _period: float) -> Prepared:
    """The rolling resistance of the wheels that count."""
    by_name = zip(WHEEL_NAMES, parameters.rolling_resistance, strict=True)
    return Prepared(tuple(f if name in vehicle.driven_wheels else 0.0 for name, f in by_name))


@differential("load_proportional", prepare=prepare, needs=(each_driven, own_motors_to_allocate))
@compilable
def load_proportional(
    p: LoadShareParameters,
    car: Car,
    c: Prepared,
    driver: DriverCommand,
    imu: InertialMeasurement,
    wheels: WheelStates,
) -> WheelTorqueRequest:
    """Share the drive torque in proportion to load times rolling resistance of the driven wheels.

    M_i/M_a = f_i G_i/(sum f G), the sum over driven wheels (dissertation, eq 1.3); loads [N] from
    the accelerations by `wheel_loads`. Driven wheels that carry nothing, as those of an axle far
    from the centre of mass, get equal torques [N m].
    """
    load, total = wheel_loads(car, imu), driver.drive_torque
    front_left, front_right = c.resistance[0] * load[0], c.resistance[1] * load[1]
    rear_left, rear_right = c.resistance[2] * load[2], c.resistance[3] * load[3]
    # Left and right first, so that a mirrored car gets exactly mirrored torques.
    whole = (front_left + front_right) + (rear_left + rear_right)
    # Driven wheels that carry nothing leave no ratio to share by.
    if whole == 0.0:
        return split(p.brake, car, driver, 0.0)
    drive = Wheels(
        total * front_left / whole,
        total * front_right / whole,
        total * rear_left / whole,
        total * rear_right / whole,
    )
    return allocated(
        p.allocation, car, wheels, WheelTorqueRequest(drive, split_brake(p.brake, driver))
    )


@dataclass(frozen=True, slots=True)
class AdhesionShareParameters:
    """Source of the friction, its error, and a limit by it."""

    friction: KnownBy = parameter(
        KnownBy.TRUTH,
        about="friction of the road: as the plant has it, or from slip and torque of the wheels",
        source="the dissertation takes it as known",
    )
    error_factor: float = parameter(
        1.0, unit="1", low=0.1, high=10.0, about="friction that the law believes in over that"
    )
    limit: bool = parameter(
        False,
        about="whether no wheel gets more than its grip: a traction control, which an ideal "
        "divider has beside the shares in proportion to adhesion",
        source="the dissertation, section 1.2, lists both; its method 5 is named after the shares",
    )
    estimate: friction_estimate.FrictionEstimateParameters = group(
        friction_estimate.FrictionEstimateParameters
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@dataclass(slots=True)
class AdhesionShareState:
    """State of the friction estimate."""

    estimate: friction_estimate.FrictionEstimateState = part(
        friction_estimate.FrictionEstimateState
    )


class AdhesionShareSeen(NamedTuple):
    """Signals that the law reads."""

    driver: DriverCommand
    sensors: Sensors
    tires: TireForces


@differential(
    "adhesion_share",
    start=lambda p: AdhesionShareState(friction_estimate.unknown_road(p.estimate)),
    needs=(each_driven, free_wheels_for("estimate.reference"), own_motors_to_allocate),
)
@compilable
def adhesion_share(
    p: AdhesionShareParameters,
    car: Car,
    s: AdhesionShareState,
    period: float,
    seen: AdhesionShareSeen,
) -> WheelTorqueRequest:
    """Share the drive torque in proportion to the grip of the driven wheels.

    M_i = M tau_i/sum(tau) with tau_i = phi_i F_i r [N m] (dissertation, eq 1.2, at the wheel). With
    `truth` friction and load are the plant's; else they come from `estimated_friction` and the
    accelerations. Braking by the drives is shared in the same way. With `limit` no wheel gets more
    than tau_i/eta: a command counts before the gear, and its efficiency eta takes its part of it on
    the way to the wheel; where the drive brakes the gear helps, and tau_i eta is the bound. With
    `allocation.keep` sum a wheel may get more than that, in place of one with a motor that ends
    before.
    """
    driver = seen.driver
    sensors = seen.sensors
    tires = seen.tires
    total, speed = driver.drive_torque, sensors.wheels.velocity
    if p.friction == KnownBy.TRUTH:
        friction, load = tires.friction_coefficient, tires.load
    else:
        # Without the plant's numbers loads follow from the accelerations.
        load = wheel_loads(car, sensors.imu)
        friction = friction_estimate.estimated_friction(
            p.estimate, car, s.estimate, period, total, sensors
        )
    front_left = p.error_factor * grip(car, 0, total, friction[0], load[0], speed[0])
    front_right = p.error_factor * grip(car, 1, total, friction[1], load[1], speed[1])
    rear_left = p.error_factor * grip(car, 2, total, friction[2], load[2], speed[2])
    rear_right = p.error_factor * grip(car, 3, total, friction[3], load[3], speed[3])
    # Left and right first, so that a mirrored car gets exactly mirrored torques.
    carried = (front_left + front_right) + (rear_left + rear_right)
    # More than all tyres hold together would only spin them.
    if p.limit:
        total = min(max(total, -carried), carried)
    # No grip at all: no torque, and nothing to divide by.
    if carried <= 0.0:
        total, carried = 0.0, 1.0
    drive = Wheels(
        total * (front_left / carried),
        total * (front_right / carried),
        total * (rear_left / carried),
        total * (rear_right / carried),
    )
    request = WheelTorqueRequest(drive, split_brake(p.brake, driver))
    return allocated(p.allocation, car, sensors.wheels, request)


@compilable
def grip(car: Car, wheel: int, total: float, friction: float, load: float, speed: float) -> float:
    """Command [N m] at which a driven wheel gets the torque phi F r that its tyre can take."""
    torque = friction * load * car.wheel_radius
    if not car.driven[wheel]:
        return 0.0
    if total * speed >= 0.0:
        return torque / car.motor.gear_efficiency
    return torque * car.motor.gear_efficiency


@dataclass(frozen=True, slots=True)
class SteeringCorrectionParameters:
    """Corrected axle, gain and limit; the source gives neither gain nor limit."""

    axle: CorrectedAxle = parameter(
        CorrectedAxle.AUTOMATIC,
        about="axle with different torques; automatic: front if both its wheels are driven, each "
        "on its own, else rear",
        source="Tatar & Chudzik: front of front and all-wheel drive, rear of rear drive",
    )
    gain: float = parameter(
        1.5915494309189535,
        unit="1/rad",
        low=0.0,
        high=20.0,
        about="change of each wheel's torque over its equal share, per road-wheel angle; the "
        "default is 50 % at pi/10",
    )
    largest_correction: float = parameter(
        1.0,
        unit="1",
        low=0.0,
        high=1.0,
        about="limit of that change; 1 takes all torque from the inner wheel",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


def corrected_axle_driven(parameters: SteeringCorrectionParameters, vehicle: Vehicle) -> str:
    """Both wheels of the axle that is corrected must be driven."""
    front_lacks = FRONT_WHEELS_DRIVEN(parameters, vehicle)
    is_front = parameters.axle == CorrectedAxle.FRONT or (
        parameters.axle == CorrectedAxle.AUTOMATIC and not front_lacks
    )
    return front_lacks if is_front else REAR_WHEELS_DRIVEN(parameters, vehicle)


@differential("steering_correction", needs=(corrected_axle_driven, own_motors_to_allocate))
@compilable
def steering_correction(
    p: SteeringCorrectionParameters,
    car: Car,
    driver: DriverCommand,
    column: SteeringColumnState,
    wheels: WheelStates,
) -> WheelTorqueRequest:
    """Move drive torque to the outer wheel of an axle in proportion to the road-wheel angle.

    T_left = T (1 - c), T_right = T (1 + c), c = gain delta within +-largest_correction, with the
    equal share T [N m] and the mean road-wheel angle delta [rad], left positive. The sum is the
    driver's; a negative torque is shared in the same proportion, and then turns the car out of the
    bend (assumption). Tatar & Chudzik describe the correction in words only.
    """
    equal = split(p.brake, car, driver, 0.0)
    correction = min(
        max(p.gain * column.road_wheel_angle, -p.largest_correction), p.largest_correction
    )
    front_left, front_right, rear_left, rear_right = equal.drive
    # Behind a differential both wheels get the same torque, whatever is asked of them.
    front_can = car.driven[0] and car.driven[1] and not car.differential[0]
    if p.axle == CorrectedAxle.FRONT or (p.axle == CorrectedAxle.AUTOMATIC and front_can):
        moved = front_left * correction
        front_left, front_right = front_left - moved, front_left + moved
    else:
        moved = rear_left * correction
        rear_left, rear_right = rear_left - moved, rear_left + moved
    drive = Wheels(front_left, front_right, rear_left, rear_right)
    return allocated(p.allocation, car, wheels, WheelTorqueRequest(drive, equal.brake))
