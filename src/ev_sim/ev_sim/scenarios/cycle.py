"""Another speed cycle for a scenario whose driver drives one."""

from __future__ import annotations

import os
from itertools import pairwise
from typing import Any

from ev_core.parameters.data_file import config_folders
from ev_msgs_py.refusal import unknown_name
from ev_sim.profiles.speed_profile import SpeedProfileParameters, with_profile_from_file

LISTED = "trrl_1_1"  # whose windows the dissertation lists, and the scenarios with it
_ROOM = 1.1  # length of the road over that of the cycle: a driver who may be fast is somewhat ahead


def cycle_values(name: str) -> tuple[list[tuple[str, str, Any]], float]:
    """What a cycle changes in a scenario, as (node, parameter, value), and its duration [s].

    `name` is that of a file in config/cycles, its beginning if no other begins so, or the path of a CSV file. The
    windows are then found by rule (`driver.modes`), unless the scenario lists those of this cycle, and a random road is
    as long as the cycle. ParameterError that lists the known cycles for an unknown one.
    """
    file = name if os.sep in name or name.endswith(".csv") else f"cycles/{_known(name)}.csv"
    profile = with_profile_from_file(SpeedProfileParameters(file=file), "cycle")
    values: list[tuple[str, str, Any]] = [("driver", "speed_profile.file", file), ("plant", "imposed_speed.file", file)]
    if file != f"cycles/{LISTED}.csv":
        points = zip(profile.time, profile.speed, strict=True)
        length = sum(0.5 * abs(v0 + v1) * (t1 - t0) for (t0, v0), (t1, v1) in pairwise(points))
        values += [("driver", "modes.begin", []), ("driver", "modes.mode", [])]
        values += [("plant", "road.random_distance", max(_ROOM * length, 1.0))]
    return values, profile.time[-1]


def cycle_names() -> list[str]:
    """The cycles in the config folders."""
    return sorted({path.stem for folder in config_folders() for path in (folder / "cycles").glob("*.csv")})


def _known(name: str) -> str:
    names = cycle_names()
    meant = [name] if name in names else [each for each in names if each.startswith(name)]
    if len(meant) != 1:
        raise unknown_name("cycle", name, names)
    return meant[0]
