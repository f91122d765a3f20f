"""The averaged drive: two phases in series on a continuously adjustable voltage, without commutation.

    2 L i' = u - 2 R i - 2 p psi omega,    M = 2 p psi i

It is what the switched drive does between two commutations, averaged over the chopping of the converter (Pillay and
Krishnan, Modeling, simulation, and analysis of permanent-magnet motor drives, part II, IEEE Trans. Ind. Appl. 25,
1989). The converter is lossless, takes what the motor regenerates, and sets the voltage without delay.

It holds while the bus leaves room for the current control. Beyond, where the EMF exceeds the bus voltage, the sign
of the torque is still right, but only the switched drive knows that the phase reactance p omega L limits the current.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ev_core.law import ParameterError, compilable, group, setting
from ev_sim.drives.brushless_motor import DriveState, MotorParameters, torque_constant


@dataclass(frozen=True, slots=True)
class CurrentControllerParameters:
    """Current controller; Shchur (2019) gives none, so its structure and its parameters are assumptions."""

    bandwidth: float = setting(
        3000.0,
        unit="rad/s",
        low=1.0,
        high=1e5,
        about="bandwidth of the closed current loop; the zero of the controller cancels the pole -R/L of the motor",
    )
    emf_feedforward: float = setting(
        1.0, unit="1", low=0.0, high=1.0, about="share of the EMF that the controller adds from the measured speed"
    )


@compilable
def controlled_voltage(
    s: DriveState,
    controller: CurrentControllerParameters,
    motor: MotorParameters,
    current_reference: float,
    current: float,
    speed: float,
    bus_voltage: float,
    sampling_period: float,
) -> float:
    """Voltage across the two phases for the next sampling period, within -bus_voltage..bus_voltage [V].

    Advances `s.voltage_integral`. Where the bus limits the voltage, the integral takes only as much of the error
    as the motor has seen (back-calculation). Currents in A, shaft speed in rad/s.
    """
    proportional_gain = controller.bandwidth * 2.0 * motor.inductance
    integral_gain = controller.bandwidth * 2.0 * motor.resistance
    error = current_reference - current
    emf = torque_constant(motor) * speed
    wanted = proportional_gain * error + s.voltage_integral + controller.emf_feedforward * emf
    voltage = min(max(wanted, -bus_voltage), bus_voltage)
    s.voltage_integral += sampling_period * integral_gain * (error + (voltage - wanted) / proportional_gain)
    return voltage


@dataclass(frozen=True, slots=True)
class AveragedDriveParameters:
    """Averaged drive; all of it is assumed."""

    sampling_period: float = setting(
        1e-4, unit="s", low=1e-6, high=1e-3, about="longest time between two samples of the current controller"
    )
    current_controller: CurrentControllerParameters = group(CurrentControllerParameters)

    def __post_init__(self) -> None:
        if self.sampling_period * self.current_controller.bandwidth > 1.0:
            raise ParameterError(
                f"current_controller.bandwidth: {self.current_controller.bandwidth!r} is refused, allowed is at most "
                f"1 / sampling_period = {1 / self.sampling_period:g} rad/s, beyond which the sampled loop overshoots"
            )


@compilable
def advance_averaged(
    s: DriveState,
    motor: MotorParameters,
    averaged: AveragedDriveParameters,
    torque_reference: float,
    speed: float,
    bus_voltage: float,
    duration: float,
) -> None:
    """Advance the current under its control and set the outputs of the state; see `drive.advance_drive`.

    Implicit midpoint rule: electrical energy = copper loss + mechanical work + change of magnetic energy up to
    rounding.
    """
    constant = torque_constant(motor)
    current_reference = torque_reference / constant
    emf = constant * speed
    samples = max(1, math.ceil(duration / averaged.sampling_period - 1e-9))
    period = duration / samples
    half_decay = period * motor.resistance / (2.0 * motor.inductance)
    current = s.current
    charge = 0.0
    energy = 0.0
    for _ in range(samples):
        voltage = controlled_voltage(
            s, averaged.current_controller, motor, current_reference, current, speed, bus_voltage, period
        )
        drive = period * (voltage - emf) / (2.0 * motor.inductance)
        next_current = (current * (1.0 - half_decay) + drive) / (1.0 + half_decay)
        passed = period * (current + next_current) / 2.0
        charge += passed
        energy += voltage * passed
        current = next_current
    s.current = current
    s.torque = constant * current
    s.mean_torque = constant * charge / duration
    s.electrical_power = energy / duration
