"""Efficiency of wheels and drives over the traction windows of a cycle (dissertation, eqs 2.37 to 2.40)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.parameters.values import build
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.profiles.cycle_modes import MODES, TRACTION, CycleModes, CycleModesParameters, cycle_modes
from ev_sim.profiles.over_time import modes_at, values_at
from ev_sim.profiles.profile import Profile, profile_of
from ev_sim.report.metric import NotMeasured
from ev_sim.report.samples import channel
from ev_sim.run.recording.recording import Recording

_FREE = {"front": "rear", "rear": "front"}  # axle whose wheels roll where the other one is driven


@dataclass(frozen=True, slots=True)
class WheelSums:
    """Sums over the traction windows for one driven wheel.

    Drive torque and the part of it that rolling resistance takes [N m s], angles that it and the free wheel on its
    side turned [rad].
    """

    torque: float
    resistance: float
    turned: float
    free_turned: float

    @property
    def speed_efficiency(self) -> float:
        """What slip leaves, sum w_free / sum w [1]."""
        if self.turned <= 0.0:
            raise NotMeasured("the wheel did not turn in the traction windows")
        return self.free_turned / self.turned

    @property
    def efficiency(self) -> float:
        """(sum M - sum M_f)/sum M * sum w_free/sum w (eq 2.37) [1]."""
        if self.torque <= 0.0:
            raise NotMeasured("the wheel was not driven in the traction windows")
        return (self.torque - self.resistance) / self.torque * self.speed_efficiency


@dataclass(frozen=True, slots=True, eq=False)
class WheelShares:
    """What each sample adds to the sums of a driven wheel, (n,) each, in their units; zero outside of the windows."""

    torque: np.ndarray
    resistance: np.ndarray
    turned: np.ndarray
    free_turned: np.ndarray

    def sums(self) -> WheelSums:
        """The sums over the whole run."""
        return WheelSums(*(float(values.sum()) for values in self._values))

    def running_efficiency(self) -> np.ndarray:
        """Efficiency (eq 2.37) from the start up to each sample, (n,) [1]; NaN before the wheel is driven and turns."""
        torque, resistance, turned, free_turned = (np.cumsum(values) for values in self._values)
        driven = (torque > 0.0) & (turned > 0.0)
        found = np.full(len(torque), np.nan)
        share = (torque[driven] - resistance[driven]) / torque[driven]
        found[driven] = share * free_turned[driven] / turned[driven]
        return found

    @property
    def _values(self) -> tuple[np.ndarray, ...]:
        return self.torque, self.resistance, self.turned, self.free_turned


def windows(driver: Mapping[str, Any]) -> tuple[Profile, CycleModes]:
    """The cycle [m/s over s] and its windows, of the parameters of a driver; NotMeasured if it drives no cycle."""
    if "modes.begin" not in driver:
        raise NotMeasured("the driver drives no cycle with windows of traction")
    modes = build(CycleModesParameters, {name: driver[f"modes.{name}"] for name in ("begin", "mode")})
    points = (driver[f"speed_profile.{name}"] for name in ("time", "speed", "interpolation"))
    return profile_of(*points), cycle_modes(modes)


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


def traction(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    """Whether the car is driven in a window of traction, for each sample, (n,) bool; `driver` are its parameters.

    Driven: the accelerator has been pressed over the period that ends at the sample. NotMeasured if the driver has no
    cycle.
    """
    pressed = channel(run, "driver.command.drive_torque") > 0.0
    answered = (_modes(run, driver) == TRACTION) & pressed
    return np.concatenate(([False], answered[:-1]))


def wheel_shares(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> dict[str, WheelShares]:
    """The shares of each driven wheel, by its name.

    M_f follows from the balance of the wheel, M_f = M - F_x r - J w'. NotMeasured if every wheel is driven.
    """
    inside = traction(run, driver)
    period = np.diff(run.time, prepend=run.time[0])
    inertia = vehicle.driven_wheel_inertia
    shares = {}
    for wheel in vehicle.driven_wheels:
        free = free_wheel_beside(wheel, vehicle)
        speed = channel(run, f"wheel_states.velocity.{wheel}")
        torque = channel(run, f"wheel_states.effort.{wheel}")
        force = channel(run, f"tire_forces.longitudinal_force.{wheel}")
        gained = inertia * np.diff(speed, prepend=speed[0])
        resistance = (torque - vehicle.wheel_radius * force) * period - gained
        free_speed = channel(run, f"wheel_states.velocity.{free}")
        values = (torque * period, resistance, speed * period, free_speed * period)
        shares[wheel] = WheelShares(*(np.where(inside, value, 0.0) for value in values))
    return shares


def free_wheel_beside(wheel: str, vehicle: Vehicle) -> str:
    """The wheel on the same side that rolls freely; NotMeasured if it is driven, too."""
    axle, _, side = wheel.partition("_")
    free = f"{_FREE[axle]}_{side}"
    if free in vehicle.driven_wheels:
        raise NotMeasured(f"there is no free wheel beside {wheel}")
    return free


def wheel_sums(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> dict[str, WheelSums]:
    """The sums of each driven wheel, by its name; NotMeasured without free wheels or a cycle."""
    return {wheel: shares.sums() for wheel, shares in wheel_shares(run, vehicle, driver).items()}


def powers(run: Recording) -> tuple[np.ndarray, np.ndarray]:
    """Power of all motors at their shafts and of the battery at its terminals, (n,) [W]."""
    shaft = sum(
        channel(run, f"motor_states.effort.{wheel}") * channel(run, f"motor_states.velocity.{wheel}")
        for wheel in WHEEL_NAMES
    )
    return shaft, -channel(run, "battery.voltage") * channel(run, "battery.current")


def energies_since_start(run: Recording, driver: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """Work of the motors at their shafts and of the battery in the windows up to each sample, (n,) [J]."""
    inside = traction(run, driver)
    period = np.diff(run.time, prepend=run.time[0])
    shaft, battery = (np.cumsum(np.where(inside, power * period, 0.0)) for power in powers(run))
    return shaft, battery


def energies(run: Recording, driver: Mapping[str, Any]) -> tuple[float, float]:
    """Work of the motors at their shafts and of the battery at its terminals in the traction windows [J]."""
    shaft, battery = energies_since_start(run, driver)
    return float(shaft[-1]), float(battery[-1])


def slip_energy(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> float:
    """Work lost by slip along the driven wheels in the traction windows, sum F_x r (w - w_free) [J]."""
    inside = traction(run, driver)
    period = np.diff(run.time, prepend=run.time[0])
    lost = 0.0
    for wheel in vehicle.driven_wheels:
        free = free_wheel_beside(wheel, vehicle)
        force = channel(run, f"tire_forces.longitudinal_force.{wheel}")
        gap = channel(run, f"wheel_states.velocity.{wheel}") - channel(run, f"wheel_states.velocity.{free}")
        lost += float((force * vehicle.wheel_radius * gap * period)[inside].sum())
    return lost
