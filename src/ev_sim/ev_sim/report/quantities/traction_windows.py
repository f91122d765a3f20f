"""The windows of a cycle: in which samples the car is driven (dissertation, section 2.6)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ev_msgs_py.parameters.values import build
from ev_sim.profiles.cycle_modes import MODES, TRACTION, CycleModes, CycleModesParameters, cycle_modes
from ev_sim.profiles.over_time import modes_at, values_at
from ev_sim.profiles.profile import Profile, profile_of
from ev_sim.report.metric import NotMeasured
from ev_sim.report.samples import channel
from ev_sim.running.recording.recording import Recording


def windows(driver: Mapping[str, Any]) -> tuple[Profile, CycleModes]:
    """The cycle [m/s over s] and its windows, of the parameters of a driver; NotMeasured if it drives no cycle."""
    if "modes.begin" not in driver:
        raise NotMeasured("the driver drives no cycle with windows of traction")
    modes = build(CycleModesParameters, {name: driver[f"modes.{name}"] for name in ("begin", "mode")})
    points = (driver[f"speed_profile.{name}"] for name in ("time", "speed", "interpolation"))
    return profile_of(*points), cycle_modes(modes)


def cycle_time(driver: Mapping[str, Any]) -> float:
    """The time of the whole cycle, t_c of eq 2.40 [s]; NotMeasured if the driver drives no cycle."""
    profile, _ = windows(driver)
    return profile.time[-1]


def modes_over_time(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    """The mode of the cycle at each sample, (n,) str; NotMeasured if the driver drives no cycle."""
    return np.array(MODES)[_modes(run, driver)]


def _modes(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    """The same as places in `MODES`."""
    profile, modes = windows(driver)
    period = float(run.time[1] - run.time[0]) if len(run.time) > 1 else 1.0
    return modes_at(modes, profile, run.time, period)


def wanted_speed(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    """The speed of the cycle at each sample, (n,) [m/s]; NotMeasured if the driver drives no cycle."""
    profile, _ = windows(driver)
    return values_at(profile, run.time)


def in_windows(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    """Whether the period that ends at a sample lies in a window of traction, (n,) bool.

    `driver` are the parameters of the driver; NotMeasured if it drives no cycle.
    """
    return _of_the_period_before(_modes(run, driver) == TRACTION)


def traction(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    """Whether besides the accelerator has been pressed over that period, (n,) bool.

    Where the pedal is released within a window of traction no torque acts, and rolling resistance is all that there is.
    """
    pressed = _of_the_period_before(channel(run, "driver.command.drive_torque") > 0.0)
    return in_windows(run, driver) & pressed


def _of_the_period_before(answered: np.ndarray) -> np.ndarray:
    """What holds from each sample on, said of the samples at which its period ends."""
    return np.concatenate(([False], answered[:-1]))
