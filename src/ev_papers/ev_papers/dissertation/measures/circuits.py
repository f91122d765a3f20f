"""Circuits of a car in a recording, each a driven wheel with its motor ("п" and "л" in the source).

Eqs 2.37 to 2.40 divide sums over the samples in traction by each other. `circuit_shares` has what
each sample adds to the sums of a circuit, `CircuitSums` the sums with the equations.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import has_equal_motors, has_own_motors, wheel_inertia
from ev_core.vehicle.losses import loss_power, map_loss_power
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.measures.metric import NotMeasured, channel
from ev_stack.recording.recording import Recording

_FREE = {"front": "rear", "rear": "front"}  # by driven axle the one with the wheels that roll


@dataclass(frozen=True, slots=True)
class CircuitSums:
    """Sums over the samples that count, each times the period; the equations divide one by another.

    torque, resistance: drive torque M_k of the wheel and moment of its rolling resistance M_f [N m
    s] turned, free_turned: angles that it and the free wheel on its side turned [rad] wheel_work,
    useful_work: of M_k along the wheel, and of M_k - M_f along the free wheel [J] shaft_work,
    electrical_work: of the motor at its shaft, and what it took from the battery [J] time: how long
    the samples last [s]
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
        """Efficiency of slip, sum w_free/sum w_k: eq 2.37 without rolling resistance in M_f [1]."""
        return _ratio(self.free_turned, self.turned, "the wheel did not turn")

    @property
    def efficiency(self) -> float:
        """Wheel efficiency, (sum M_k - sum M_f)/sum M_k * sum w_free/sum w_k [1]; eq 2.37."""
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
        """Eq 2.40 with n the samples in traction: mean power times the time of the cycle [s], [J].

        With n the samples of the whole cycle, t_c/n is the time of a sample and eq 2.40 is
        `electrical_work`.
        """
        return _ratio(self.electrical_work, self.time, "there was no traction") * cycle_time


def _ratio(part: float, whole: float, reason: str) -> float:
    if whole <= 0.0:
        raise NotMeasured(f"{reason} in the traction windows")
    return part / whole


@dataclass(frozen=True, slots=True, eq=False)
class CircuitShares:
    """Part of each sample in the sums of a circuit, (n,) each, named and in units as there."""

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
        """Sums over the samples that are counted, (n,) bool."""
        found = {of.name: float(getattr(self, of.name)[counted].sum()) for of in fields(self)}
        return CircuitSums(**found)

    def running_efficiency(self, counted: np.ndarray) -> np.ndarray:
        """Wheel efficiency up to each sample, (n,) [1]; NaN before the wheel is driven; eq 2.37."""
        torque = _summed(self.torque, counted)
        force = _quotient(torque - _summed(self.resistance, counted), torque)
        free = _summed(self.free_turned, counted)
        return force * _quotient(free, _summed(self.turned, counted))

    def running_drive_efficiency(self, counted: np.ndarray) -> np.ndarray:
        """Drive efficiency (eq 2.38) up to each sample, (n,) [1]; NaN before the battery gives."""
        work = _summed(self.shaft_work, counted)
        return _quotient(work, _summed(self.electrical_work, counted))


def _summed(values: np.ndarray, counted: np.ndarray) -> np.ndarray:
    """Sum from the start up to each sample, (n,)."""
    return np.cumsum(np.where(counted, values, 0.0))


def _quotient(part: np.ndarray, whole: np.ndarray) -> np.ndarray:
    return np.divide(part, whole, out=np.full(len(whole), np.nan), where=whole > 0.0)


def circuit_shares(run: Recording, vehicle: Vehicle) -> dict[str, CircuitShares]:
    """Shares of each circuit, by the name of its wheel.

    M_f follows from the balance of the wheel, M_f = M_k - F_x r - J w'. A motor takes its power at
    the shaft and the losses of motor and inverter by the vehicle's loss model or map, as
    torque-controlled drives do; on a test bench torque, speed, voltage and current are the measured
    ones. NotMeasured if there is no free wheel beside a driven one, or if the motors are no
    circuits that are alike.
    """
    if not (has_own_motors(vehicle) and has_equal_motors(vehicle)):
        raise NotMeasured("a circuit is one of equal motors, each of one wheel")
    period = np.diff(run.time, prepend=run.time[:1])
    shares = {}
    for wheel in vehicle.driven_wheels:
        speed = channel(run, f"wheel_states.velocity.{wheel}")
        free = channel(run, f"wheel_states.velocity.{free_wheel_beside(wheel, vehicle)}")
        torque = channel(run, f"wheel_states.effort.{wheel}")
        force = channel(run, f"tire_forces.longitudinal_force.{wheel}")
        gained = wheel_inertia(vehicle, wheel) * np.diff(speed, prepend=speed[:1])
        resistance = (torque - _radius(vehicle, wheel) * force) * period - gained
        motor, shaft_speed, electrical = _drive(run, vehicle, wheel)
        shares[wheel] = CircuitShares(
            torque=torque * period,
            resistance=resistance,
            turned=speed * period,
            free_turned=free * period,
            wheel_work=torque * speed * period,
            useful_work=(torque * period - resistance) * free,
            shaft_work=motor * shaft_speed * period,
            electrical_work=electrical * period,
            time=period,
        )
    return shares


def _drive(
    run: Recording, vehicle: Vehicle, wheel: str
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Torque [N m] and speed [rad/s] at the shaft, and the power that was taken [W], (n,) each."""
    if f"bench.shafts.torque.{wheel}" in run.channels:
        torque = channel(run, f"bench.shafts.torque.{wheel}")
        speed = channel(run, f"bench.shafts.speed.{wheel}")
        voltage = channel(run, f"bench.electrical.voltage.{wheel}")
        return torque, speed, voltage * channel(run, f"bench.electrical.current.{wheel}")
    torque = channel(run, f"motor_states.effort.{wheel}")
    speed = channel(run, f"motor_states.velocity.{wheel}")
    return torque, speed, torque * speed + _losses(vehicle, torque, speed)


def circuits(run: Recording, vehicle: Vehicle, counted: np.ndarray) -> dict[str, CircuitSums]:
    """Sums of each circuit over the samples that are counted, (n,) bool, by its wheel."""
    return {wheel: shares.sums(counted) for wheel, shares in circuit_shares(run, vehicle).items()}


def free_wheel_beside(wheel: str, vehicle: Vehicle) -> str:
    """Name of the wheel on the same side that rolls freely; NotMeasured if it is driven, too."""
    axle, _, side = wheel.partition("_")
    free = f"{_FREE[axle]}_{side}"
    if free in vehicle.driven_wheels:
        raise NotMeasured(f"there is no free wheel beside {wheel}")
    return free


def slip_energy(run: Recording, vehicle: Vehicle, counted: np.ndarray) -> float:
    """Work lost by slip along the driven wheels in counted samples, sum F_x r (w - w_free) [J]."""
    period = np.diff(run.time, prepend=run.time[:1])
    lost = 0.0
    for wheel in vehicle.driven_wheels:
        force = channel(run, f"tire_forces.longitudinal_force.{wheel}")
        speed = channel(run, f"wheel_states.velocity.{wheel}")
        free = channel(run, f"wheel_states.velocity.{free_wheel_beside(wheel, vehicle)}")
        gap = speed - free
        lost += float((force * _radius(vehicle, wheel) * gap * period)[counted].sum())
    return lost


def battery_power(run: Recording) -> np.ndarray:
    """Power of the battery at its terminals, (n,) [W]."""
    return -channel(run, "battery.voltage") * channel(run, "battery.current")


def _radius(vehicle: Vehicle, wheel: str) -> float:
    return vehicle.wheel_radius * vehicle.wheel_radius_ratio[WHEEL_NAMES.index(wheel)]


def _losses(vehicle: Vehicle, torque: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Losses of one motor and its inverter at shaft torques [N m] and speeds [rad/s], (n,) [W]."""
    motor = vehicle.motor
    if motor.map_efficiency:
        tables = (motor.map_speed, motor.map_torque, motor.map_efficiency)
        points = zip(torque, speed, strict=True)
        return np.array([map_loss_power(float(m), float(w), *tables) for m, w in points])
    return loss_power(motor, torque, speed)
