"""Efficiency of a wheel and its drive over the traction windows of a cycle (dissertation, eqs 2.37 to 2.40)."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from ev_sim.report.metric import NotMeasured


@dataclass(frozen=True, slots=True)
class CircuitSums:
    """Sums over the samples that count, each times the period: what the equations divide by each other.

    torque, resistance: drive torque M_k of the wheel and moment of its rolling resistance M_f [N m s]
    turned, free_turned: angles that it and the free wheel on its side turned [rad]
    wheel_work, useful_work: of M_k along the wheel, and of M_k - M_f along the free wheel [J]
    shaft_work, electrical_work: of the motor at its shaft, and what it took from the battery [J]
    time: how long the samples last [s]
    """

    torque: float
    resistance: float
    turned: float
    free_turned: float
    wheel_work: float
    useful_work: float
    shaft_work: float
    electrical_work: float
    time: float

    @property
    def speed_efficiency(self) -> float:
        """What slip leaves, sum w_free/sum w_k: eq 2.37 without rolling resistance in M_f [1]."""
        return _ratio(self.free_turned, self.turned, "the wheel did not turn")

    @property
    def efficiency(self) -> float:
        """Wheel efficiency, (sum M_k - sum M_f)/sum M_k * sum w_free/sum w_k (eq 2.37, a product of ratios) [1]."""
        force = _ratio(self.torque - self.resistance, self.torque, "the wheel was not driven")
        return force * self.speed_efficiency

    @property
    def power_efficiency(self) -> float:
        """Eq 2.37 with summed powers instead, sum (M_k - M_f) w_free/sum M_k w_k [1]."""
        return _ratio(self.useful_work, self.wheel_work, "the wheel was not driven")

    @property
    def drive_efficiency(self) -> float:
        """Drive efficiency, sum M w/sum U I at the motor (eq 2.38) [1]."""
        return _ratio(self.shaft_work, self.electrical_work, "the battery gave nothing")

    @property
    def total_efficiency(self) -> float:
        """Wheel times drive efficiency (eq 2.39) [1]."""
        return self.efficiency * self.drive_efficiency

    def energy(self, cycle_time: float) -> float:
        """Mean electrical power over the samples times the time of the cycle [s] (eq 2.40 as printed) [J].

        The energy that was taken is `electrical_work`, which is this with the time of the samples instead.
        """
        return _ratio(self.electrical_work, self.time, "there was no traction") * cycle_time


def _ratio(part: float, whole: float, reason: str) -> float:
    if whole <= 0.0:
        raise NotMeasured(f"{reason} in the traction windows")
    return part / whole


@dataclass(frozen=True, slots=True, eq=False)
class CircuitShares:
    """What each sample adds to the sums of a circuit, (n,) each, in their units; `sums` has what they are."""

    torque: np.ndarray
    resistance: np.ndarray
    turned: np.ndarray
    free_turned: np.ndarray
    wheel_work: np.ndarray
    useful_work: np.ndarray
    shaft_work: np.ndarray
    electrical_work: np.ndarray
    time: np.ndarray

    def sums(self, counted: np.ndarray) -> CircuitSums:
        """The sums over the samples that are counted, (n,) bool."""
        return CircuitSums(**{of.name: float(getattr(self, of.name)[counted].sum()) for of in fields(self)})

    def running_efficiency(self, counted: np.ndarray) -> np.ndarray:
        """Wheel efficiency (eq 2.37) from the start up to each sample, (n,) [1]; NaN before the wheel is driven."""
        torque, resistance, turned, free = (
            np.cumsum(np.where(counted, values, 0.0))
            for values in (self.torque, self.resistance, self.turned, self.free_turned)
        )
        return _running(torque - resistance, torque) * _running(free, turned)

    def running_drive_efficiency(self, counted: np.ndarray) -> np.ndarray:
        """Drive efficiency (eq 2.38) from the start up to each sample, (n,) [1]; NaN before the battery gives."""
        work, taken = (np.cumsum(np.where(counted, values, 0.0)) for values in (self.shaft_work, self.electrical_work))
        return _running(work, taken)


def _running(part: np.ndarray, whole: np.ndarray) -> np.ndarray:
    return np.divide(part, whole, out=np.full(len(whole), np.nan), where=whole > 0.0)
