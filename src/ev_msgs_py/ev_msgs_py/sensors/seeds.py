"""One seed for everything random: the seeds that a method has of its own go with that of its node."""

from __future__ import annotations

import dataclasses
import zlib
from typing import Any, TypeVar

from ev_msgs_py.sensors.random_numbers import philox

P = TypeVar("P")

FOR_SEED = 4  # the last word of the counter; sensors and faults have those below
_OWN = "seed"


def seeded(parameters: P, seed: int, prefix: str = "") -> P:
    """Parameters as their method is told them: with the node's seed 0 as they are, else with other own seeds.

    An own seed is a parameter `seed` of a group, such as `road.seed`; its name, its value and the node's seed make the
    new one. A group whose `is_random` is false keeps it, and so remains what it is.
    """
    changed: dict[str, Any] = {}
    of: Any = parameters
    for field in dataclasses.fields(of):
        value, name = getattr(of, field.name), prefix + field.name
        if dataclasses.is_dataclass(value):
            made = seeded(value, seed, f"{name}.")
            if made is not value:
                changed[field.name] = made
        elif field.name == _OWN and seed != 0 and getattr(of, "is_random", True):
            changed[_OWN] = philox(value, 0, 0, FOR_SEED, seed, zlib.crc32(name.encode()))[0] >> 1
    made_anew: P = dataclasses.replace(of, **changed) if changed else parameters
    return made_anew
