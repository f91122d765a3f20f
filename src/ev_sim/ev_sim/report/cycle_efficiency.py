"""Efficiency of wheels and drives over the traction windows of a cycle (dissertation, eqs 2.37 to 2.40)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ev_msgs_py.parameters import build
from ev_msgs_py.vehicle import Vehicle
from ev_sim.driver.cycle_modes import TRACTION, CycleModes, CycleModesParameters
from ev_sim.driver.profile import Profile
from ev_sim.recording.recording import Recording
from ev_sim.report.metric import NotMeasured
from ev_sim.report.samples import channel

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


def traction(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    """Whether each sample lies in a window of traction, (n,) bool; `driver` are the parameters of its driver.

    NotMeasured if the driver has no cycle.
    """
    if "modes.begin" not in driver:
        raise NotMeasured("the driver drives no cycle with windows of traction")
    modes = build(CycleModesParameters, {name: driver[f"modes.{name}"] for name in ("begin", "mode")})
    profile = Profile(*(driver[f"speed_profile.{name}"] for name in ("time", "speed", "interpolation")))
    period = float(run.time[1] - run.time[0]) if len(run.time) > 1 else 1.0
    at = CycleModes(modes, profile, period).at
    return np.array([at(t) == TRACTION for t in run.time.tolist()])


def wheel_sums(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> dict[str, WheelSums]:
    """The sums of each driven wheel, by its name.

    M_f follows from the balance of the wheel, M_f = M - F_x r - J w'. NotMeasured if every wheel is driven.
    """
    inside = traction(run, driver)
    period = np.diff(run.time, prepend=run.time[0])
    inertia = vehicle.wheel_inertia + vehicle.gear_ratio**2 * vehicle.motor.rotor_inertia
    sums = {}
    for wheel in vehicle.driven_wheels:
        axle, _, side = wheel.partition("_")
        free = f"{_FREE[axle]}_{side}"
        if free in vehicle.driven_wheels:
            raise NotMeasured(f"there is no free wheel beside {wheel}")
        speed = channel(run, f"wheel_states.velocity.{wheel}")
        torque = channel(run, f"wheel_states.effort.{wheel}")
        force = channel(run, f"tire_forces.longitudinal_force.{wheel}")
        gained = inertia * np.diff(speed, prepend=speed[0])
        resistance = (torque - vehicle.wheel_radius * force) * period - gained
        sums[wheel] = WheelSums(
            float((torque * period)[inside].sum()),
            float(resistance[inside].sum()),
            float((speed * period)[inside].sum()),
            float((channel(run, f"wheel_states.velocity.{free}") * period)[inside].sum()),
        )
    return sums


def energies(run: Recording, driver: Mapping[str, Any]) -> tuple[float, float]:
    """Work of the motors at their shafts and of the battery at its terminals in the traction windows [J]."""
    inside = traction(run, driver)
    period = np.diff(run.time, prepend=run.time[0])
    wheels = ("front_left", "front_right", "rear_left", "rear_right")
    shaft = sum(
        channel(run, f"motor_states.effort.{wheel}") * channel(run, f"motor_states.velocity.{wheel}")
        for wheel in wheels
    )
    battery = -channel(run, "battery.voltage") * channel(run, "battery.current")
    return float((shaft * period)[inside].sum()), float((battery * period)[inside].sum())


def slip_energy(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> float:
    """Work lost by slip along the driven wheels in the traction windows, sum F_x r (w - w_free) [J]."""
    inside = traction(run, driver)
    period = np.diff(run.time, prepend=run.time[0])
    lost = 0.0
    for wheel in vehicle.driven_wheels:
        axle, _, side = wheel.partition("_")
        force = channel(run, f"tire_forces.longitudinal_force.{wheel}")
        gap = channel(run, f"wheel_states.velocity.{wheel}") - channel(
            run, f"wheel_states.velocity.{_FREE[axle]}_{side}"
        )
        lost += float((force * vehicle.wheel_radius * gap * period)[inside].sum())
    return lost
