"""The windows of a cycle: in which samples the car is driven (dissertation, section 2.6)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ev_core.parameters.values import build
from ev_sim.profiles.cycle_windows import (
    MODES,
    TRACTION,
    CycleModes,
    CycleModesParameters,
    cycle_modes,
    modes_at,
    values_at,
)
from ev_sim.profiles.profile import Profile, profile_of
from ev_stack.measures.metric import NotMeasured, channel
from ev_stack.recording.recording import Recording


def windows(driver: Mapping[str, Any]) -> tuple[Profile, CycleModes]:
    """Cycle [m/s over s] and its windows, of the parameters of a driver.

    NotMeasured if it drives no cycle.
    """
    if "modes.begin" not in driver:
        raise NotMeasured("the driver drives no cycle with windows of traction")
    given = {
        name.removeprefix("modes."): value
        for name, value in driver.items()
        if name.startswith("modes.")
    }
    cycle = profile_of(
        driver["speed_profile.time"],
        driver["speed_profile.speed"],
        driver["speed_profile.interpolation"],
    )
    return cycle, cycle_modes(build(CycleModesParameters, given), cycle)


def cycle_time(driver: Mapping[str, Any]) -> float:
    """Time of the whole cycle, t_c of eq 2.40 [s]; NotMeasured if the driver drives no cycle."""
    profile, _ = windows(driver)
    return profile.time[-1]


def modes_over_time(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    """Mode of the cycle at each sample, (n,) str; NotMeasured if the driver drives no cycle."""
    return np.array(MODES)[_modes(run, driver)]


def _modes(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    """Mode of the cycle at each sample, as a place in `MODES`, (n,)."""
    _, modes = windows(driver)
    return modes_at(modes, run.time)


def wanted_speed(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    """Speed of the cycle at each sample, (n,) [m/s]; NotMeasured if the driver drives no cycle."""
    profile, _ = windows(driver)
    return values_at(profile, run.time)


def in_windows(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    """True where the period that ends at a sample lies in a window of traction, (n,) bool.

    `driver` are the parameters of the driver; NotMeasured if it drives no cycle.
    """
    return _of_the_period_before(_modes(run, driver) == TRACTION)


def traction(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    """True where the accelerator has been pressed over such a period, (n,) bool.

    Where the pedal is released within a window of traction no torque acts, and rolling resistance
    is all that there is.
    """
    pressed = _of_the_period_before(channel(run, "driver.command.drive_torque") > 0.0)
    return in_windows(run, driver) & pressed


def _of_the_period_before(answered: np.ndarray) -> np.ndarray:
    """An answer from each sample on, at the sample at which its period ends, (n,) bool."""
    return np.concatenate(([False], answered[:-1]))
