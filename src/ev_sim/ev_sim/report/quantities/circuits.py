"""The circuits of a car in a recording: what each driven wheel with its motor did; "п" and "л" in the source."""

from __future__ import annotations

import numpy as np

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.vehicle.description import Vehicle
from ev_msgs_py.vehicle.drive_train import has_equal_motors, has_own_motors, wheel_inertia
from ev_sim.drives.losses import loss_power
from ev_sim.drives.losses_over_time import map_loss_powers
from ev_sim.report.metric import NotMeasured
from ev_sim.report.quantities.circuit_sums import CircuitShares, CircuitSums
from ev_sim.report.samples import channel
from ev_sim.running.recording.recording import Recording

_FREE = {"front": "rear", "rear": "front"}  # axle whose wheels roll where the other one is driven


def circuit_shares(run: Recording, vehicle: Vehicle) -> dict[str, CircuitShares]:
    """The shares of each circuit, by the name of its wheel.

    M_f follows from the balance of the wheel, M_f = M_k - F_x r - J w'. What a motor takes is its power at the shaft
    and the losses of motor and inverter by the vehicle's loss model or map, as for torque-controlled drives; on a test
    bench torque, speed, voltage and current are those that were measured.
    NotMeasured if there is no free wheel beside a driven one, or if the motors are no circuits that are alike.
    """
    if not (has_own_motors(vehicle) and has_equal_motors(vehicle)):
        raise NotMeasured("a circuit is one of equal motors, each of one wheel")
    period = np.diff(run.time, prepend=run.time[0])
    shares = {}
    for wheel in vehicle.driven_wheels:
        speed = channel(run, f"wheel_states.velocity.{wheel}")
        free = channel(run, f"wheel_states.velocity.{free_wheel_beside(wheel, vehicle)}")
        torque = channel(run, f"wheel_states.effort.{wheel}")
        force = channel(run, f"tire_forces.longitudinal_force.{wheel}")
        gained = wheel_inertia(vehicle, wheel) * np.diff(speed, prepend=speed[0])
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


def _drive(run: Recording, vehicle: Vehicle, wheel: str) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Torque [N m] and speed [rad/s] at the shaft, and the power that was taken [W], (n,) each."""
    if f"bench.shafts.torque.{wheel}" in run.channels:
        torque, speed = (channel(run, f"bench.shafts.{of}.{wheel}") for of in ("torque", "speed"))
        voltage, current = (channel(run, f"bench.electrical.{of}.{wheel}") for of in ("voltage", "current"))
        return torque, speed, voltage * current
    torque, speed = (channel(run, f"motor_states.{of}.{wheel}") for of in ("effort", "velocity"))
    return torque, speed, torque * speed + _losses(vehicle, torque, speed)


def circuits(run: Recording, vehicle: Vehicle, counted: np.ndarray) -> dict[str, CircuitSums]:
    """The sums of each circuit over the samples that are counted, (n,) bool, by the name of its wheel."""
    return {wheel: shares.sums(counted) for wheel, shares in circuit_shares(run, vehicle).items()}


def free_wheel_beside(wheel: str, vehicle: Vehicle) -> str:
    """The wheel on the same side that rolls freely; NotMeasured if it is driven, too."""
    axle, _, side = wheel.partition("_")
    free = f"{_FREE[axle]}_{side}"
    if free in vehicle.driven_wheels:
        raise NotMeasured(f"there is no free wheel beside {wheel}")
    return free


def slip_energy(run: Recording, vehicle: Vehicle, counted: np.ndarray) -> float:
    """Work lost by slip along the driven wheels in the samples that are counted, sum F_x r (w - w_free) [J]."""
    period = np.diff(run.time, prepend=run.time[0])
    lost = 0.0
    for wheel in vehicle.driven_wheels:
        free = free_wheel_beside(wheel, vehicle)
        force = channel(run, f"tire_forces.longitudinal_force.{wheel}")
        gap = channel(run, f"wheel_states.velocity.{wheel}") - channel(run, f"wheel_states.velocity.{free}")
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
        return map_loss_powers(torque, speed, motor.map_speed, motor.map_torque, motor.map_efficiency)
    return loss_power(motor, torque, speed)
