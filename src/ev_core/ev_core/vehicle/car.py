"""The car as a law sees it.

The numbers of the vehicle description, and what follows from them alone. What a method needs of the
layout is declared, and checked before anything is made.
"""

from collections.abc import Callable
from typing import Any

from ev_core.elementary import copysign, hypot
from ev_core.parameters.declaration import number_tree
from ev_core.vehicle.description import GRAVITY as GRAVITY
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import (
    couplings,
    drive_train_numbers,
    has_equal_motors,
    single_wheels,
    wheel_inertias,
)
from ev_msgs_py.compilable import compilable, inlined
from ev_msgs_py.contract.signals import BodyVelocity
from ev_msgs_py.contract.wheels import WHEEL_NAMES


class Car(Vehicle):
    """Numbers that a law may ask of `car`.

    For annotations only, the object itself is a tree of numbers.
    """

    driven: list[float]
    number_driven: float
    driven_wheel_inertia: list[float]
    constant_rolling_resistance: float
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

    - `driven`: 1 for a wheel with a motor, else 0, in the order of Wheels, and `number_driven`,
      their sum,
    - `driven_wheel_inertia`: of each wheel, where it is driven with its rotors behind their gear
      [kg m^2],
    - `constant_rolling_resistance`: the rolling resistance coefficient at rest, f_0 or A/(m g) of
      the road load [1],
    - `rolling_resistance_growth`: of the rolling resistance coefficient over V^2 [s^2/m^2],
    - `front_roll_share`: of the front axle in the lateral load transfer [1], by roll stiffness
      where that is given,
    - `pitch_height`, `roll_height`: height [m] by which longitudinal and steady lateral
      acceleration move the wheel loads, 0 for what `load_transfer` leaves out; that of the centre
      of mass, for roll with the moment of the weight of a body that leans,
    - those of its drives, `driveline.drive_train_numbers`.
    """
    driven = [float(name in vehicle.driven_wheels) for name in WHEEL_NAMES]
    moved_by = vehicle.load_transfer
    # The road load of a dynamometer has the resistance as a force, laws count with a coefficient.
    of_road_load = vehicle.road_load.constant / (vehicle.mass * GRAVITY)
    return {
        **number_tree(vehicle),
        "driven": driven,
        "number_driven": sum(driven),
        "driven_wheel_inertia": wheel_inertias(vehicle),
        "constant_rolling_resistance": vehicle.rolling_resistance + of_road_load,
        "rolling_resistance_growth": vehicle.rolling_resistance_growth,
        "front_roll_share": vehicle.front_share_of_roll,
        "pitch_height": (
            vehicle.centre_of_mass_height if moved_by in ("both", "longitudinal") else 0.0
        ),
        **drive_train_numbers(vehicle),
        "roll_height": vehicle.height_of_roll if moved_by in ("both", "lateral") else 0.0,
    }


@compilable
def speed_along_path(body: BodyVelocity) -> float:
    """Speed of the centre of mass along its path, negative in reverse [m/s]."""
    return copysign(hypot(body.longitudinal, body.lateral), body.longitudinal)


@compilable
def turning_length(wheelbase: float, understeer: float, speed: float) -> float:
    """L + K u |u| [m] of the steady linear car r = u delta/(L + K u |u|).

    The speed u [m/s] is negative in reverse. K is the understeer gradient [rad s^2/m] of the tyres:
    they push against their way aside wherever they roll, so that in reverse the car turns more than
    a neutral one. At least L/10: beyond its critical speed it has no steady turn.
    """
    return max(wheelbase + understeer * speed * abs(speed), 0.1 * wheelbase)


@inlined
def front_wheel_tangents(
    mean: float, wheelbase: float, front_track: float, parallel: float
) -> tuple[float, float]:
    """Tangents of the left and the right front wheel's angle from that of the mean one.

    A number or an array (n,). Ackermann geometry, or with `parallel` 1 both alike, by
    `steering_geometry` of the vehicle; left positive, lengths in m. With the mean tangent in the
    numerator straight ahead needs no case of its own. Source: Shchur 2019, eq 8.
    """
    outward = mean * (0.5 * front_track) * (1.0 - parallel)
    return wheelbase * mean / (wheelbase - outward), wheelbase * mean / (wheelbase + outward)


# Says what a method with these parameters needs and this vehicle lacks; an empty text if there is
# nothing.
Need = Callable[[Any, Vehicle], str]


def driven(*needed: str) -> Need:
    """These wheels must be among the driven ones, each with a torque of its own."""

    def lacks(_parameters: Any, vehicle: Vehicle) -> str:
        if not set(needed) <= set(vehicle.driven_wheels):
            return f"{listed(needed)} among the driven wheels"
        if not set(needed) <= set(single_wheels(vehicle)):
            return f"a motor or a clutch for each of {listed(needed)}"
        return ""

    return lacks


def only_driven(*needed: str) -> Need:
    """These wheels must be the driven ones."""

    def lacks(_parameters: Any, vehicle: Vehicle) -> str:
        if set(needed) == set(vehicle.driven_wheels):
            return ""
        return f"{listed(needed)} as the only driven wheels"

    return lacks


def any_driven(_parameters: Any, vehicle: Vehicle) -> str:
    """Need at least one driven wheel."""
    return "" if vehicle.driven_wheels else "at least one driven wheel"


def each_driven(_parameters: Any, vehicle: Vehicle) -> str:
    """Need at least one driven wheel, each with a torque of its own."""
    if single_wheels(vehicle) != vehicle.driven_wheels:
        return "a motor or a clutch for each driven wheel"
    return any_driven(_parameters, vehicle)


def equal_motors(_parameters: Any, vehicle: Vehicle) -> str:
    """Need the same motor and gear at all driven wheels."""
    if has_equal_motors(vehicle):
        return ""
    return "equal motors and gears at all driven wheels, and no engine"


FRONT_WHEELS_DRIVEN = driven("front_left", "front_right")
REAR_WHEELS_DRIVEN = driven("rear_left", "rear_right")
ALL_WHEELS_DRIVEN = driven(*WHEEL_NAMES)


def listed(names: tuple[str, ...]) -> str:
    """Names in one phrase."""
    return f"{', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else names[0]


def refusal(
    role: str, method: str, needs: tuple[Need, ...], parameters: Any, vehicle: Vehicle
) -> str:
    """The line that refuses a layout, empty if it suits."""
    for need in needs:
        lacking = need(parameters, vehicle)
        if not isinstance(lacking, str | None):
            expected = "a text: what the vehicle lacks, or nothing"
            raise TypeError(f"a need gives {type(lacking).__name__}, expected {expected}")
        if lacking:
            drives = ", ".join(vehicle.driven_wheels) or "none"
            if single_wheels(vehicle) != vehicle.driven_wheels:
                drives += f" with {' and '.join(couplings(vehicle))}"
            needs_it = f"{role} method {method} needs {lacking}"
            return f"{needs_it}, vehicle {vehicle.name} drives {drives}"
    return ""
