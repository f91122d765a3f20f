"""Torque by the grip of each wheel: method 5 of the dissertation's five."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.friction_estimate import (
    FrictionEstimateParameters,
    FrictionEstimateState,
    estimated_friction,
    unknown_road,
)
from ev_control.estimation.plausible import wheel_loads
from ev_control.estimation.reference_speed import free_wheels_for
from ev_control.law import AllocationParameters, BrakeSplitParameters, allocated, own_motors_to_allocate, split_brake
from ev_control.shared.axle_redistribution import SOURCES, TRUTH
from ev_core.law import Car, Wheels, compilable, each_driven, group, method, parameter, part
from ev_msgs_py.contract.signals import (
    DriverCommand,
    InertialMeasurement,
    SteeringColumnState,
    TireForces,
    WheelStates,
    WheelTorqueRequest,
)


@dataclass(frozen=True, slots=True)
class AdhesionShareParameters:
    """Where the friction comes from, and how wrong it is."""

    friction: str = parameter(
        "truth",
        choices=SOURCES,
        about="friction of the road: as the plant has it, or from slip and torque of the wheels",
        source="the dissertation takes it as known",
    )
    error_factor: float = parameter(
        1.0, unit="1", low=0.1, high=10.0, about="friction that the law believes in over that"
    )
    estimate: FrictionEstimateParameters = group(FrictionEstimateParameters)
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@dataclass(slots=True)
class AdhesionShareState:
    """What lasts between steps."""

    estimate: FrictionEstimateState = part(FrictionEstimateState)


def begin(p: AdhesionShareParameters) -> AdhesionShareState:
    """The state that knows nothing of the road."""
    return AdhesionShareState(unknown_road(p.estimate))


@method(
    "electronic_differential",
    "adhesion_share",
    AdhesionShareParameters,
    state=AdhesionShareState,
    start=begin,
    needs=(each_driven, free_wheels_for("estimate.reference"), own_motors_to_allocate),
    mirrored=True,
)
@compilable
def adhesion_share(
    p: AdhesionShareParameters,
    car: Car,
    s: AdhesionShareState,
    period: float,
    driver: DriverCommand,
    column: SteeringColumnState,
    wheels: WheelStates,
    imu: InertialMeasurement,
    tires: TireForces,
) -> WheelTorqueRequest:
    """Share the drive torque in proportion to the grip of the driven wheels, and give none of them more than that.

    tau_i = phi_i F_i r [N m] (dissertation, eq 1.2, at the wheel), M_i = min(M tau_i/sum(tau), tau_i/eta): a command
    counts before the gear, whose efficiency eta takes its part of it on the way to the wheel. With `truth` friction and
    load are the plant's; else they come from `estimated_friction` and the accelerations. Braking by the drives is
    shared in the same way, but there the gear helps, and tau_i eta is the bound. With `allocation.keep` sum a wheel may
    get more than its grip, in place of one whose motor ends before.
    """
    total = driver.drive_torque
    if p.friction == TRUTH:
        friction, load = tires.friction_coefficient, tires.load
    else:
        load = wheel_loads(car, imu)
        friction = estimated_friction(p.estimate, car, s.estimate, period, total, load, column, wheels, imu)
    front_left = p.error_factor * grip(car, 0, total, friction[0], load[0], wheels.velocity[0])
    front_right = p.error_factor * grip(car, 1, total, friction[1], load[1], wheels.velocity[1])
    rear_left = p.error_factor * grip(car, 2, total, friction[2], load[2], wheels.velocity[2])
    rear_right = p.error_factor * grip(car, 3, total, friction[3], load[3], wheels.velocity[3])
    # Left and right first, so that a mirrored car gets exactly mirrored torques.
    carried = (front_left + front_right) + (rear_left + rear_right)
    share = min(max(total / carried, -1.0), 1.0) if carried > 0.0 else 0.0
    drive = Wheels(share * front_left, share * front_right, share * rear_left, share * rear_right)
    return allocated(p.allocation, car, wheels, WheelTorqueRequest(drive, split_brake(p.brake, driver)))


@compilable
def grip(car: Car, wheel: int, total: float, friction: float, load: float, speed: float) -> float:
    """The command [N m] at which a driven wheel gets the torque phi F r that its tyre can take; of others none."""
    torque = friction * load * car.wheel_radius
    if car.driven[wheel] == 0.0:
        return 0.0
    return torque / car.motor.gear_efficiency if total * speed >= 0.0 else torque * car.motor.gear_efficiency
