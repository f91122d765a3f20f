"""The car as a law sees it: the numbers of the vehicle description, and what follows from them alone."""

from __future__ import annotations

from typing import Any

from ev_core.elementary import copysign, hypot
from ev_core.parameters.declaration import number_tree
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import drive_train_numbers, wheel_inertias
from ev_msgs_py.compilable import compilable, inlined
from ev_msgs_py.contract.signals import BodyVelocity
from ev_msgs_py.contract.wheels import WHEEL_NAMES

GRAVITY = 9.81  # [m/s^2], as in all sources


class Car(Vehicle):
    """What a law may ask of `car`; for annotations only, the object itself is a tree of numbers."""

    driven: list[float]
    number_driven: float
    driven_wheel_inertia: list[float]
    rolling_resistance_growth: float
    pitch_height: float
    roll_height: float
    gear: list[float]
    motors: list[float]
    differential: list[float]
    axle_preload: list[float]
    axle_locking: list[float]
    centre_preload: float
    centre_locking: float
    one_input: float
    engine_driven: float


def car_numbers(vehicle: Vehicle) -> dict[str, Any]:
    """The numbers of a vehicle as a tree, and with them

    - `driven`: 1 for a wheel with a motor, else 0, in the order of Wheels, and `number_driven`, their sum,
    - `driven_wheel_inertia`: of each wheel, where it is driven with its rotors behind their gear [kg m^2],
    - `rolling_resistance_growth`: of the rolling resistance coefficient over V^2 [s^2/m^2],
    - `front_roll_share`: of the front axle in the lateral load transfer [1], by roll stiffness where that is given,
    - `pitch_height`, `roll_height`: height of the centre of mass [m] by which longitudinal and lateral acceleration
      move the wheel loads, 0 for what `load_transfer` leaves out,
    - those of its drives, `driveline.drive_train_numbers`.
    """
    driven = [float(name in vehicle.driven_wheels) for name in WHEEL_NAMES]
    return {
        **number_tree(vehicle),
        "driven": driven,
        "number_driven": sum(driven),
        "driven_wheel_inertia": wheel_inertias(vehicle),
        "rolling_resistance_growth": vehicle.rolling_resistance_growth,
        "front_roll_share": vehicle.front_share_of_roll,
        "pitch_height": vehicle.centre_of_mass_height if vehicle.load_transfer == "both" else 0.0,
        **drive_train_numbers(vehicle),
        "roll_height": 0.0 if vehicle.load_transfer == "none" else vehicle.centre_of_mass_height,
    }


@compilable
def speed_along_path(body: BodyVelocity) -> float:
    """Speed of the centre of mass along its path, negative in reverse [m/s]."""
    return copysign(hypot(body.longitudinal, body.lateral), body.longitudinal)


@inlined
def front_wheel_tangents(mean: float, wheelbase: float, front_track: float, parallel: float) -> tuple[float, float]:
    """Tangents of the left and the right front wheel's angle from that of the mean one; a number or an array (n,).

    Ackermann geometry, or with `parallel` 1 both alike, as `steering_geometry` of the vehicle says; left positive,
    lengths in m. With the mean tangent in the numerator straight ahead needs no case of its own. Source: Shchur 2019,
    eq 8.
    """
    outward = mean * (0.5 * front_track) * (1.0 - parallel)
    return wheelbase * mean / (wheelbase - outward), wheelbase * mean / (wheelbase + outward)
