"""The C interface of laws, derived from the declared signals: what its structs hold, and a check number.

All numbers are float64 in SI units, so a struct is a row of them without gaps.
"""

from __future__ import annotations

import zlib
from collections.abc import Mapping
from functools import cache
from typing import Any

from ev_msgs_py.contract.roles import EXTRA, ROLES, RoleKind
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.contract.wheels import WHEEL_NAMES

VERSION = 2  # of what the functions are given and what is declared beside them; the signals are in `layout`

# What laws in C may play: the roles that answer, without those of the test bench.
LAW_ROLES = tuple(
    role.name for role in ROLES.values() if role.kind is RoleKind.ANSWERS and not EXTRA.intersection(role.writes)
)

CAR = (  # names of numbers of the vehicle (`vehicle.car.car_numbers`); those of `BY_WHEEL` have one for each wheel
    "mass",
    "yaw_inertia",
    "wheelbase",
    "centre_of_mass_to_rear_axle",
    "centre_of_mass_height",
    "front_track",
    "rear_track",
    "wheel_radius",
    "driven_wheel_inertia",
    "gear_ratio",
    "steering_ratio",
    "number_driven",
    "driven",
)
BY_WHEEL = ("driven_wheel_inertia", "driven")


def member(signal: type) -> str:
    """The name of a signal in C, after its topic."""
    return TOPICS[signal].name.replace("/", "_")


def reads_of(role: str) -> tuple[type, ...]:
    """The signals in the inputs of a role, in order."""
    return tuple(signal for signal in ROLES[role].reads if signal is not Instant)


def size_of(signals: tuple[type, ...]) -> int:
    """How many numbers signals have together."""
    return sum(TOPICS[signal].shape.size for signal in signals)


@cache
def signals() -> tuple[type, ...]:
    """Every signal of the interface; its place is that of its bit in what a law says it reads."""
    every = (signal for role in LAW_ROLES for signal in (*reads_of(role), *ROLES[role].writes))
    return tuple(dict.fromkeys(every))


def bit(signal: type) -> int:
    """The bit by which a law says that it reads a signal."""
    return 1 << signals().index(signal)


@cache
def layout() -> int:
    """A check number of all names and their order, 32 bits."""
    words = [*CAR, *WHEEL_NAMES]
    for role in LAW_ROLES:
        for signal in (*reads_of(role), *ROLES[role].writes):
            words += [role, member(signal), *TOPICS[signal].shape.channels]
    return zlib.crc32("\0".join(words).encode())


def car_row(tree: Mapping[str, Any]) -> list[float]:
    """The numbers of a vehicle in the order of `CAR`, from the tree of `car_numbers`."""
    row: list[float] = []
    for name in CAR:
        row += tree[name] if isinstance(tree[name], list) else [tree[name]]
    return row
