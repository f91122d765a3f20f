"""The driveline of a vehicle: gears, differentials and clutches between its motors or its engine and the wheels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ev_core.parameters.declaration import parameter, setting
from ev_msgs_py.refusal import ParameterError

COUPLINGS = ("individual", "open", "limited_slip", "clutch", "centre")
AXLES = ("front", "rear")
TORSENS = ("torsen_1", "torsen_2", "torsen_3")
_SURVEY = "dissertation, section 1.2"

# Lock coefficient K = M_slow/M_fast (eq 1.1) of what locks by its torque alone, smallest and largest, by its place.
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
        about=f"K of a Torsen or DCCD as {place} differential; 0 for the middle of what it is made for",
        source=f"{_SURVEY}: Torsen 1, 2, 3 and DCCD by place",
    )


def _axle(place: str) -> Any:
    return setting(
        "same", choices=("same", *COUPLINGS[:3], *TORSENS), about=f"`coupling` of the {place} axle, if it has its own"
    )


def _gear(place: str) -> Any:
    return setting(
        1.0, unit="1", low=0.01, high=100.0, about=f"gear ratio of the {place} axle over the vehicle's `gear_ratio`"
    )


def _size(place: str) -> Any:
    return setting(
        1.0,
        unit="1",
        low=0.01,
        high=100.0,
        about=f"torque, power, losses and inertia of each {place} motor over those of `motor`: 2 is two side by side",
    )


@dataclass(frozen=True, slots=True)
class Driveline:
    """How drive torque reaches the wheels; what an axle does not say itself is that of the car."""

    coupling: str = setting(
        "individual",
        choices=COUPLINGS,
        about="individual: a motor for each driven wheel; open, limited_slip: a motor for each driven axle, with a "
        "differential; clutch: one motor, whose torque clutches share out as commanded; centre: one motor, with a "
        "centre differential and one in each axle",
    )
    front: str = _axle("front")
    rear: str = _axle("rear")
    centre: str = setting(
        "open", choices=("open", "limited_slip", *TORSENS, "dccd"), about="the centre differential, if there is one"
    )
    front_share: float = setting(
        0.5, unit="1", low=0.01, high=0.99, about="of the torque of an open centre differential that goes to the front"
    )
    front_lock: float = _coefficient("front")
    rear_lock: float = _coefficient("rear")
    centre_lock: float = _coefficient("centre")
    preload: float = setting(
        50.0, unit="N m", low=0.0, high=1e4, about="locking torque of a limited-slip differential at no drive torque"
    )
    locking_ratio: float = setting(
        0.3, unit="1", low=0.0, high=1.0, about="locking torque over drive torque of a limited-slip differential"
    )
    locking_speed: float = setting(
        1.0, unit="rad/s", low=0.1, high=100.0, about="speed difference at which 76 % of the locking torque acts"
    )
    clutch_lag: float = setting(0.1, unit="s", low=1e-3, high=10.0, about="time constant of the torque shares")
    front_gear: float = _gear("front")
    rear_gear: float = _gear("rear")
    front_size: float = _size("front")
    rear_size: float = _size("rear")

    def __post_init__(self) -> None:
        for place in (*AXLES, "centre"):
            device, lock = getattr(self, place), getattr(self, f"{place}_lock")
            made = LOCK_COEFFICIENTS.get((device, place))
            if device in TORSENS and made is None:
                places = [where for what, where in LOCK_COEFFICIENTS if what == device]
                raise ParameterError(f"{place}: {device} is refused, it is made as {' and '.join(places)} differential")
            if lock and not (made and made[0] <= lock <= made[1]):
                allowed = f"{made[0]:g} to {made[1]:g}" if made else f"0: K is that of a Torsen or DCCD, not {device}"
                raise ParameterError(f"{place}_lock: {lock:g} is refused, allowed is {allowed}")
        if self.has_one_input:
            if self.coupling == "clutch" and (self.front, self.rear) != ("same", "same"):
                raise ParameterError("front and rear are refused with coupling clutch, whose clutches are the axles'")
            if "individual" in (self.front, self.rear):
                raise ParameterError("front and rear: individual is refused with coupling centre, that has one motor")
            if {self.front_gear, self.rear_gear, self.front_size, self.rear_size} != {1.0}:
                raise ParameterError(f"gear and size of an axle: 1 is allowed with coupling {self.coupling}, one motor")

    @property
    def has_one_input(self) -> bool:
        """Whether one motor drives all driven wheels, wherever they are."""
        return self.coupling in ("clutch", "centre")

    def of_axle(self, axle: str) -> str:
        """What couples the two wheels of an axle, if both are driven."""
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
