"""The driveline of a vehicle.

Gears, differentials and clutches between its motors or its engine and the wheels. Behind the
declaration stands what follows from motors, driveline and engine together, wheel by wheel.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ev_core.parameters.declaration import parameter, setting
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError

COUPLINGS = ("individual", "open", "limited_slip", "clutch", "centre")
AXLES = ("front", "rear")
TORSENS = ("torsen_1", "torsen_2", "torsen_3")
_SURVEY = "dissertation, section 1.2"

# Lock coefficient K = M_slow/M_fast (eq 1.1) of what locks by its torque alone, smallest and
# largest, by its place.
LOCK_COEFFICIENTS = {
    ("torsen_1", "rear"): (2.5, 5.0),
    ("torsen_1", "centre"): (2.5, 3.5),
    ("torsen_2", "front"): (1.4, 2.5),
    ("torsen_2", "rear"): (2.0, 3.0),
    ("torsen_2", "centre"): (1.5, 2.5),
    ("torsen_3", "centre"): (1.0, 1.9),
    ("dccd", "centre"): (1.0, 1.9),
}


def _coefficient(place: str) -> Any:
    return parameter(
        0.0,
        unit="1",
        low=0.0,
        high=100.0,
        about=f"K of a Torsen or DCCD as {place} differential; 0 for the middle of what it is made "
        "for",
        source=f"{_SURVEY}: Torsen 1, 2, 3 and DCCD by place",
    )


def _axle(place: str) -> Any:
    return setting(
        "same",
        choices=("same", *COUPLINGS[:3], *TORSENS),
        about=f"`coupling` of the {place} axle, if it has its own",
    )


def _gear(place: str) -> Any:
    return setting(
        1.0,
        unit="1",
        low=0.01,
        high=100.0,
        about=f"gear ratio of the {place} axle over the vehicle's `gear_ratio`",
    )


def _size(place: str) -> Any:
    return setting(
        1.0,
        unit="1",
        low=0.01,
        high=100.0,
        about=f"torque, power, losses and inertia of each {place} motor over those of `motor`: 2 "
        "is two side by side",
    )


@dataclass(frozen=True, slots=True)
class Driveline:
    """Path of the drive torque to the wheels.

    An axle without a value of its own has that of the car.
    """

    coupling: str = setting(
        "individual",
        choices=COUPLINGS,
        about="individual: a motor for each driven wheel; open, limited_slip: a motor for each "
        "driven axle, with a "
        "differential; clutch: one motor with clutches that share its torque as commanded; centre: "
        "one motor, with a "
        "centre differential and one in each axle",
    )
    front: str = _axle("front")
    rear: str = _axle("rear")
    centre: str = setting(
        "open",
        choices=("open", "limited_slip", *TORSENS, "dccd"),
        about="the centre differential, if there is one",
    )
    front_share: float = setting(
        0.5,
        unit="1",
        low=0.01,
        high=0.99,
        about="of the torque of an open centre differential that goes to the front",
    )
    front_lock: float = _coefficient("front")
    rear_lock: float = _coefficient("rear")
    centre_lock: float = _coefficient("centre")
    preload: float = setting(
        50.0,
        unit="N m",
        low=0.0,
        high=1e4,
        about="locking torque of a limited-slip differential at no drive torque",
    )
    locking_ratio: float = setting(
        0.3,
        unit="1",
        low=0.0,
        high=1.0,
        about="locking torque over drive torque of a limited-slip differential",
    )
    locking_speed: float = setting(
        1.0,
        unit="rad/s",
        low=0.1,
        high=100.0,
        about="speed difference at which 76 % of the locking torque acts",
    )
    clutch_lag: float = setting(
        0.1, unit="s", low=1e-3, high=10.0, about="time constant of the torque shares"
    )
    front_gear: float = _gear("front")
    rear_gear: float = _gear("rear")
    front_size: float = _size("front")
    rear_size: float = _size("rear")

    def __post_init__(self) -> None:
        for place in (*AXLES, "centre"):
            device = getattr(self, place)
            lock = getattr(self, f"{place}_lock")
            made = LOCK_COEFFICIENTS.get((device, place))
            if device in TORSENS and made is None:
                places = [where for what, where in LOCK_COEFFICIENTS if what == device]
                made_as = f"{' and '.join(places)} differential"
                raise ParameterError(f"{place}: {device} is refused, it is made as {made_as}")
            # 0 stands for the middle of what the device is made for.
            if lock and not (made and made[0] <= lock <= made[1]):
                allowed = f"0: K is that of a Torsen or DCCD, not {device}"
                if made:
                    allowed = f"{made[0]:g} to {made[1]:g}"
                raise ParameterError(f"{place}_lock: {lock:g} is refused, expected {allowed}")
        if self.has_one_input:
            if self.coupling == "clutch" and (self.front, self.rear) != ("same", "same"):
                raise ParameterError(
                    "front and rear are refused with coupling clutch: its clutches are the axles'"
                )
            if "individual" in (self.front, self.rear):
                raise ParameterError(
                    "front and rear: individual is refused with coupling centre, that has one motor"
                )
            if {self.front_gear, self.rear_gear, self.front_size, self.rear_size} != {1.0}:
                raise ParameterError(
                    f"gear and size of an axle: expected 1 with coupling {self.coupling}, one motor"
                )

    @property
    def has_one_input(self) -> bool:
        """True if one motor drives all driven wheels, of both axles."""
        return self.coupling in ("clutch", "centre")

    def of_axle(self, axle: str) -> str:
        """Coupling of the two wheels of an axle, if both are driven."""
        own: str = getattr(self, axle)
        if own != "same":
            return own
        return "open" if self.coupling == "centre" else self.coupling

    def locking(self, place: str) -> tuple[float, float]:
        """Locking torque of a differential at no drive torque [N m], and over its drive torque [1].

        K of eq 1.1 is (1 + s)/(1 - s) of that share s, so s = (K - 1)/(K + 1).
        """
        device = self.centre if place == "centre" else self.of_axle(place)
        if device == "limited_slip":
            return self.preload, self.locking_ratio
        made = LOCK_COEFFICIENTS.get((device, place))
        if made is None:
            return 0.0, 0.0
        coefficient = getattr(self, f"{place}_lock") or 0.5 * (made[0] + made[1])
        return 0.0, (coefficient - 1.0) / (coefficient + 1.0)


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
            "engine needs one shaft that it drives: "
            "driveline.coupling clutch or centre, or one driven axle with a differential"
        )
    if (driveline.front_size, driveline.rear_size) != (1.0, 1.0):
        raise ParameterError(
            "driveline.front_size and rear_size are those of motors, and refused with an engine"
        )
    if vehicle.blend_brakes:
        raise ParameterError(
            "blend_brakes is refused with an engine, which cannot brake as motors do"
        )


def drive_train_numbers(vehicle: Vehicle) -> dict[str, Any]:
    """The numbers of `car` about its drives.

    - `gear`: motor speed over wheel speed of each wheel [1], and `motors`: how many of `motor`
      there are at it [1],
    - `differential`: 1 for an axle with a differential, front and rear, with its locking torque at
      no drive torque `axle_preload` [N m] and over its drive torque `axle_locking` [1];
      `centre_preload`, `centre_locking` likewise,
    - `one_input`: 1 if one motor drives all wheels, and `engine_driven`: 1 if an engine stands in
      the place of motors.
    """
    driveline = vehicle.driveline
    locking = [driveline.locking(axle) for axle in AXLES]
    front = driveline.front_gear * vehicle.gear_ratio
    rear = driveline.rear_gear * vehicle.gear_ratio
    centre_preload, centre_locking = driveline.locking("centre")
    return {
        "gear": [front, front, rear, rear],
        "motors": [
            driveline.front_size,
            driveline.front_size,
            driveline.rear_size,
            driveline.rear_size,
        ],
        "differential": [float(_coupled(vehicle, axle)) for axle in AXLES],
        "axle_preload": [preload for preload, _ in locking],
        "axle_locking": [share for _, share in locking],
        "centre_preload": centre_preload,
        "centre_locking": centre_locking,
        "one_input": float(driveline.has_one_input),
        "engine_driven": float(vehicle.engine.peak_power > 0.0),
    }


def single_wheels(vehicle: Vehicle) -> tuple[str, ...]:
    """Driven wheels with a motor or a clutch of their own.

    A law can choose their torques one by one.
    """
    if vehicle.driveline.coupling == "clutch":
        return vehicle.driven_wheels
    if vehicle.driveline.coupling == "centre":
        return ()
    coupled: set[str] = set()
    for axle in AXLES:
        if _coupled(vehicle, axle):
            coupled.update(_wheels(axle))
    return tuple(wheel for wheel in vehicle.driven_wheels if wheel not in coupled)


def has_own_motors(vehicle: Vehicle) -> bool:
    """Return whether each driven wheel has a motor, and nothing between that and the wheel."""
    # Clutches give single torques, but of one motor.
    is_shared = vehicle.driveline.coupling == "clutch"
    return not is_shared and single_wheels(vehicle) == vehicle.driven_wheels


def couplings(vehicle: Vehicle) -> tuple[str, ...]:
    """Couplings of wheels that have no torque of their own, in words."""
    centre = ("a centre differential",) if vehicle.driveline.coupling == "centre" else ()
    return (
        *centre,
        *(f"a differential in the {axle} axle" for axle in AXLES if _coupled(vehicle, axle)),
    )


def has_equal_motors(vehicle: Vehicle) -> bool:
    """Return whether the drives of all wheels are the vehicle's `motor` behind its `gear_ratio`."""
    of = vehicle.driveline
    ratios = {of.front_gear, of.rear_gear, of.front_size, of.rear_size}
    return vehicle.engine.peak_power == 0.0 and ratios == {1.0}


def wheel_inertias(vehicle: Vehicle) -> list[float]:
    """Inertia of each wheel, with its rotors where it is driven [kg m^2].

    J = J_w + n i^2 J_r with the gear ratio i.
    """
    numbers = drive_train_numbers(vehicle)
    rotor = vehicle.motor.rotor_inertia
    found: list[float] = []
    for i, name in enumerate(WHEEL_NAMES):
        gear = numbers["gear"][i]
        motors = numbers["motors"][i]
        if name in vehicle.driven_wheels:
            wheel = vehicle.wheel_inertia + vehicle.carried_inertia
            found.append(wheel + gear * gear * rotor * motors)
        else:
            bare = vehicle.wheel_inertia * vehicle.undriven_inertia_ratio
            found.append(bare + vehicle.carried_inertia)
    return found


def wheel_inertia(vehicle: Vehicle, wheel: str) -> float:
    """That of one wheel [kg m^2]."""
    return wheel_inertias(vehicle)[WHEEL_NAMES.index(wheel)]


def motors_behind(vehicle: Vehicle, wheel: str) -> float:
    """Number of motors that can drive a wheel.

    Clutches and differentials may lie between.
    """
    axle = AXLES[0] if wheel in _wheels(AXLES[0]) else AXLES[1]
    # Through clutches and differentials the motors of all driven wheels may pull at one.
    size: float = getattr(vehicle.driveline, f"{axle}_size")
    alone = wheel in single_wheels(vehicle) and vehicle.driveline.coupling != "clutch"
    return size * (1 if alone else len(vehicle.driven_wheels))


def _coupled(vehicle: Vehicle, axle: str) -> bool:
    kind = vehicle.driveline.of_axle(axle)
    return kind not in ("individual", "clutch") and set(_wheels(axle)) <= set(vehicle.driven_wheels)


def _wheels(axle: str) -> tuple[str, str]:
    return WHEEL_NAMES[:2] if axle == AXLES[0] else WHEEL_NAMES[2:]
