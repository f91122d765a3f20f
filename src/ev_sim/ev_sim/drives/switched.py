"""The switched drive: six-step commutation of a three-phase star with trapezoidal EMF, transistor by transistor.

Hall sensors divide the electrical turn into six sectors. In each of them one phase is on its positive EMF flat
(high), one on its negative flat (low), and the EMF of the third (off) crosses from one flat to the other:

    sector  0  1  2  3  4  5
    high    a  a  b  b  c  c
    low     b  c  c  a  a  b
    off     c  b  a  c  b  a

The converter connects high and low to the bus, one to each rail, and chops by exchanging the rails. That works for
both signs of current and of speed. Both transistors of the off phase block: its current freewheels through a diode
until it is zero, and a diode conducts again whenever the terminal leaves the range of the bus. So commutation ripple,
loss of current control at too low a bus voltage, and uncontrolled braking by the diodes come out of the circuit
(`circuit`). Assumed: ideal transistors, diodes and Hall sensors, no dead time, and a rotor that starts in the middle
of sector 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.parameters.declaration import ParameterError, group, parameter
from ev_sim.drives.circuit import conduct, pair_current, phase_torque
from ev_sim.drives.current_controller import CurrentControllerParameters, controlled_voltage
from ev_sim.drives.motor import MotorParameters, torque_constant
from ev_sim.drives.sectors import crossing_shape
from ev_sim.drives.state import DriveState

CURRENT_CONTROLS = ("hysteresis", "pwm")
HYSTERESIS, PWM = range(len(CURRENT_CONTROLS))


@dataclass(frozen=True, slots=True)
class SwitchedDriveParameters:
    """Switched drive; all of it is assumed."""

    current_control: str = parameter("hysteresis", choices=CURRENT_CONTROLS, about="how the converter chops")
    hysteresis_band: float = parameter(
        0.5, unit="A", low=0.01, high=100.0, about="hysteresis: half of the width that the current moves in"
    )
    pwm_frequency: float = parameter(
        20e3, unit="Hz", low=1e3, high=1e5, about="pwm: carrier frequency, rounded to whole periods in a sub-step"
    )
    current_controller: CurrentControllerParameters = group(CurrentControllerParameters)
    micro_step: float = parameter(
        5e-6, unit="s", low=1e-7, high=1e-4, about="longest integration step; every switching instant also ends a step"
    )

    def __post_init__(self) -> None:
        if self.current_controller.bandwidth > self.pwm_frequency:
            raise ParameterError(
                f"current_controller.bandwidth: {self.current_controller.bandwidth!r} is refused, allowed is at most "
                f"pwm_frequency = {self.pwm_frequency:g} in rad/s, beyond which the sampled loop overshoots"
            )


@compilable
def advance_switched(
    s: DriveState,
    motor: MotorParameters,
    switched: SwitchedDriveParameters,
    torque_reference: float,
    speed: float,
    bus_voltage: float,
    duration: float,
) -> None:
    """Advance the circuit under its current control and set the outputs of the state; see `drive.advance_drive`.

    Implicit midpoint rule: electrical energy = copper loss + mechanical work + change of magnetic energy up to
    rounding.
    """
    current_reference = torque_reference / torque_constant(motor)
    if switched.current_control == HYSTERESIS:
        impulse, energy = _chop_by_hysteresis(s, motor, switched, current_reference, speed, bus_voltage, duration)
    else:
        impulse, energy = _chop_by_pwm(s, motor, switched, current_reference, speed, bus_voltage, duration)
    s.current = pair_current(s.high_current, s.off_current)
    crossing = crossing_shape(s.sector, s.sector_angle)
    s.torque = phase_torque(motor, crossing, s.high_current, s.off_current)
    s.mean_torque = impulse / duration
    s.electrical_power = energy / duration


@compilable
def _chop_by_hysteresis(
    s: DriveState,
    motor: MotorParameters,
    switched: SwitchedDriveParameters,
    current_reference: float,
    speed: float,
    bus_voltage: float,
    duration: float,
) -> tuple[float, float]:
    """Exchange the rails whenever the current leaves its band; angular impulse [N m s] and electrical energy [J]."""
    impulse = 0.0
    energy = 0.0
    remaining = duration
    while remaining > 0.0:
        limit = current_reference + s.voltage_sign * switched.hysteresis_band
        elapsed, more_impulse, more_energy = conduct(
            s, motor, switched.micro_step, s.voltage_sign, limit, speed, bus_voltage, remaining
        )
        impulse += more_impulse
        energy += more_energy
        remaining -= elapsed
        if remaining > 0.0:
            s.voltage_sign = -s.voltage_sign
    return impulse, energy


@compilable
def _chop_by_pwm(
    s: DriveState,
    motor: MotorParameters,
    switched: SwitchedDriveParameters,
    current_reference: float,
    speed: float,
    bus_voltage: float,
    duration: float,
) -> tuple[float, float]:
    """Exchange the rails by a centred carrier; angular impulse [N m s] and electrical energy [J].

    The current is sampled where the carrier turns: there it equals its mean over the chopping.
    """
    impulse = 0.0
    energy = 0.0
    carriers = max(1, round(duration * switched.pwm_frequency))
    period = duration / carriers
    for _ in range(carriers):
        current = pair_current(s.high_current, s.off_current)
        voltage = controlled_voltage(
            s, switched.current_controller, motor, current_reference, current, speed, bus_voltage, period
        )
        positive = period * (1.0 + voltage / bus_voltage) / 2.0
        negative = (period - positive) / 2.0
        for sign, span in ((-1.0, negative), (1.0, positive), (-1.0, negative)):
            _, more_impulse, more_energy = conduct(
                s, motor, switched.micro_step, sign, sign * math.inf, speed, bus_voltage, span
            )
            impulse += more_impulse
            energy += more_energy
    return impulse, energy
