"""One value per wheel, always by name."""

from __future__ import annotations

from typing import NamedTuple


class Wheels(NamedTuple):
    """One value per wheel; left is positive y (REP-103)."""

    front_left: float
    front_right: float
    rear_left: float
    rear_right: float

    @classmethod
    def all(cls, value: float) -> Wheels:
        """The same value on every wheel."""
        return cls(value, value, value, value)

    @classmethod
    def front(cls, left: float, right: float) -> Wheels:
        """Values on the front axle, zero on the rear axle."""
        return cls(left, right, 0.0, 0.0)

    @classmethod
    def rear(cls, left: float, right: float) -> Wheels:
        """Values on the rear axle, zero on the front axle."""
        return cls(0.0, 0.0, left, right)


WHEEL_NAMES = Wheels._fields
FRONT_LEFT, FRONT_RIGHT, REAR_LEFT, REAR_RIGHT = range(len(WHEEL_NAMES))  # places in Wheels
NO_WHEELS = Wheels.all(0.0)
