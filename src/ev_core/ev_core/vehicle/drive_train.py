"""What follows from motors, driveline and engine of a vehicle together, wheel by wheel."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ev_core.vehicle.driveline import AXLES
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError

if TYPE_CHECKING:
    from ev_core.vehicle.description import Vehicle


def refuse_drive_train(vehicle: Vehicle) -> None:
    """ParameterError for what cannot be built."""
    driveline, engine, driven = vehicle.driveline, vehicle.engine, set(vehicle.driven_wheels)
    if driveline.coupling == "centre" and driven != set(WHEEL_NAMES):
        raise ParameterError("driveline.coupling centre needs all four driven_wheels")
    if engine.peak_power == 0.0:
        return
    axles = [axle for axle in AXLES if _coupled(vehicle, axle)]
    one_axle = len(axles) == 1 and driven == set(_wheels(axles[0]))
    if not (driven and (driveline.has_one_input or one_axle)):
        raise ParameterError(
            "engine needs one shaft that it drives: driveline.coupling clutch or centre, or one driven axle with a "
            "differential"
        )
    if (driveline.front_size, driveline.rear_size) != (1.0, 1.0):
        raise ParameterError("driveline.front_size and rear_size are those of motors, and refused with an engine")
    if vehicle.blend_brakes:
        raise ParameterError("blend_brakes is refused with an engine, which cannot brake as motors do")


def drive_train_numbers(vehicle: Vehicle) -> dict[str, Any]:
    """The numbers of `car` about its drives.

    - `gear`: motor speed over wheel speed of each wheel [1], and `motors`: how many of `motor` there are at it [1],
    - `differential`: 1 for an axle with a differential, front and rear, with its locking torque at no drive torque
      `axle_preload` [N m] and over its drive torque `axle_locking` [1]; `centre_preload`, `centre_locking` likewise,
    - `one_input`: 1 if one motor drives all wheels, and `engine_driven`: 1 if an engine stands in the place of motors.
    """
    driveline, locking = vehicle.driveline, [vehicle.driveline.locking(axle) for axle in AXLES]
    front, rear = driveline.front_gear * vehicle.gear_ratio, driveline.rear_gear * vehicle.gear_ratio
    centre_preload, centre_locking = driveline.locking("centre")
    return {
        "gear": [front, front, rear, rear],
        "motors": [driveline.front_size, driveline.front_size, driveline.rear_size, driveline.rear_size],
        "differential": [float(_coupled(vehicle, axle)) for axle in AXLES],
        "axle_preload": [preload for preload, _ in locking],
        "axle_locking": [share for _, share in locking],
        "centre_preload": centre_preload,
        "centre_locking": centre_locking,
        "one_input": float(driveline.has_one_input),
        "engine_driven": float(vehicle.engine.peak_power > 0.0),
    }


def single_wheels(vehicle: Vehicle) -> tuple[str, ...]:
    """The driven wheels whose torque a law can choose one by one, because of a motor or a clutch of their own."""
    if vehicle.driveline.coupling == "clutch":
        return vehicle.driven_wheels
    if vehicle.driveline.coupling == "centre":
        return ()
    coupled = {wheel for axle in AXLES if _coupled(vehicle, axle) for wheel in _wheels(axle)}
    return tuple(wheel for wheel in vehicle.driven_wheels if wheel not in coupled)


def has_own_motors(vehicle: Vehicle) -> bool:
    """Whether each driven wheel has a motor, and nothing between that and the wheel."""
    return vehicle.driveline.coupling != "clutch" and single_wheels(vehicle) == vehicle.driven_wheels


def couplings(vehicle: Vehicle) -> tuple[str, ...]:
    """In words what couples wheels that have no torque of their own."""
    centre = ("a centre differential",) if vehicle.driveline.coupling == "centre" else ()
    return (*centre, *(f"a differential in the {axle} axle" for axle in AXLES if _coupled(vehicle, axle)))


def has_equal_motors(vehicle: Vehicle) -> bool:
    """Whether the drives of all wheels are the vehicle's `motor` behind its `gear_ratio`."""
    of = vehicle.driveline
    return vehicle.engine.peak_power == 0.0 and {of.front_gear, of.rear_gear, of.front_size, of.rear_size} == {1.0}


def wheel_inertias(vehicle: Vehicle) -> list[float]:
    """Inertia of each wheel, with its rotors behind their gear where it is driven, J = J_w + n i^2 J_r [kg m^2]."""
    numbers, rotor = drive_train_numbers(vehicle), vehicle.motor.rotor_inertia
    return [
        vehicle.wheel_inertia + vehicle.carried_inertia + gear * gear * rotor * motors
        if name in vehicle.driven_wheels
        else vehicle.free_wheel_inertia
        for name, gear, motors in zip(WHEEL_NAMES, numbers["gear"], numbers["motors"], strict=True)
    ]


def wheel_inertia(vehicle: Vehicle, wheel: str) -> float:
    """That of one wheel [kg m^2]."""
    return wheel_inertias(vehicle)[WHEEL_NAMES.index(wheel)]


def motors_behind(vehicle: Vehicle, wheel: str) -> float:
    """How many of the vehicle's `motor` can drive a wheel, by clutches and differentials those of other wheels, too."""
    axle = AXLES[0] if wheel in _wheels(AXLES[0]) else AXLES[1]
    size: float = getattr(vehicle.driveline, f"{axle}_size")
    alone = wheel in single_wheels(vehicle) and vehicle.driveline.coupling != "clutch"
    return size * (1 if alone else len(vehicle.driven_wheels))


def _coupled(vehicle: Vehicle, axle: str) -> bool:
    kind = vehicle.driveline.of_axle(axle)
    return kind not in ("individual", "clutch") and set(_wheels(axle)) <= set(vehicle.driven_wheels)


def _wheels(axle: str) -> tuple[str, str]:
    return WHEEL_NAMES[:2] if axle == AXLES[0] else WHEEL_NAMES[2:]
