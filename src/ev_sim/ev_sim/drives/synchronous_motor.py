"""A synchronous machine behind its inverter: its limits, and speed control.

The limits are those of current, voltage, torque and power. In the frame of the rotor, amplitudes,
with equal inductances and w_e = p w:

    T = 3/2 p psi i_q,    u_d = R i_d - w_e L i_q,    u_q = R i_q + w_e (psi + L i_d)
    i_d^2 + i_q^2 <= I^2,    w_e^2 ((psi + L i_d)^2 + (L i_q)^2) <= U^2,    U = share V_dc/sqrt(3)

The limits leave out R, for which `voltage_share` leaves room. Schroeder, Elektrische Antriebe -
Regelung von Antriebssystemen, 4th ed. 2015, chapter on synchronous machines.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import compilable, inlined, parameter, sqrt
from ev_core.vehicle.motor import Motor, Winding, driving_torque, generating_torque

ROOT_2 = 1.4142135623730951
_ROOT_3 = 1.7320508075688772
_STANDSTILL = 1e-9  # rad/s


# Overshoot of the thermal state over which the peak torque shrinks to the nominal one; it softens a
# corner.
HEAT_FADE = 0.1


@inlined
def torque_per_current(winding: Winding) -> float:
    """3/2 p psi: torque over the amplitude of i_q [N m/A]."""
    return 1.5 * winding.pole_pairs * winding.flux_linkage


@inlined
def _reach(winding: Winding, voltage: float, speed: float) -> float:
    """U/|w_e|: flux linkage [Wb] that a DC-link voltage [V] can hold at a shaft speed [rad/s]."""
    return (
        winding.voltage_share
        * voltage
        / _ROOT_3
        / (winding.pole_pairs * max(abs(speed), _STANDSTILL))
    )


@inlined
def voltage_limited_torque(winding: Winding, voltage: float, speed: float) -> float:
    """Largest torque either way [N m] at a DC-link voltage [V] and a shaft speed [rad/s].

    Up to w_e = U/sqrt(psi^2 + (L I)^2) that of the largest current; then where the circles of
    current and voltage cross, i_d = ((U/w_e)^2 - psi^2 - (L I)^2)/(2 psi L); from i_d = -psi/L on
    the top of the circle of voltage.
    """
    flux = winding.flux_linkage
    inductance = winding.inductance
    most = ROOT_2 * winding.largest_current
    reach = _reach(winding, voltage, speed)
    # i_d where both circles meet, kept between no weakening and the middle of the circle of
    # voltage.
    crossing = (reach * reach - flux * flux - inductance * most * inductance * most) / (
        2.0 * flux * inductance
    )
    direct = min(max(crossing, -flux / inductance), 0.0)
    left = flux + inductance * direct
    # i_q^2 within the circle of current, and within that of voltage.
    by_current = most * most - direct * direct
    by_voltage = (reach * reach - left * left) / (inductance * inductance)
    return torque_per_current(winding) * sqrt(max(min(by_current, by_voltage), 0.0))


@inlined
def is_weakened(winding: Winding, voltage: float, speed: float) -> bool:
    """True if a DC-link voltage [V] leaves less torque than the largest current gives.

    The speed is that of the shaft [rad/s].
    """
    most, held = (
        ROOT_2 * winding.largest_current * winding.inductance,
        winding.voltage_share * voltage,
    )
    turns = winding.pole_pairs * speed
    return (
        # Both sides squared, and times 3 for the root in U = share V/sqrt(3): no root, no division.
        3.0 * turns * turns * (winding.flux_linkage * winding.flux_linkage + most * most)
        > held * held
    )


@inlined
def weakening_current(winding: Winding, torque: float, voltage: float, speed: float) -> float:
    """i_d [A], amplitude, never positive: the least that leaves room for a torque [N m]."""
    flux, inductance = winding.flux_linkage, winding.inductance
    across = inductance * torque / torque_per_current(winding)
    reach = _reach(winding, voltage, speed)
    direct = (sqrt(max(reach * reach - across * across, 0.0)) - flux) / inductance
    return min(max(direct, -ROOT_2 * winding.largest_current), 0.0)


@inlined
def weakening_loss(motor: Motor, torque: float, voltage: float, speed: float) -> float:
    """Copper loss [W] of i_d, on top of `copper_loss` T^2; convex in the torque [N m]."""
    current = torque_per_current(motor.winding) * weakening_current(
        motor.winding, torque, voltage, speed
    )
    return motor.copper_loss * current * current


@inlined
def phase_values(motor: Motor, torque: float, voltage: float, speed: float) -> tuple[float, float]:
    """Current [A] and voltage [V] of a phase, rms, in steady state.

    R = copper_loss (3/2 p psi)^2/(3/2).
    """
    winding, constant = motor.winding, torque_per_current(motor.winding)
    resistance = motor.copper_loss * constant * constant / 1.5
    turns = winding.pole_pairs * speed
    d, q = weakening_current(winding, torque, voltage, speed), torque / constant
    u_d = resistance * d - turns * winding.inductance * q
    u_q = resistance * q + turns * (winding.flux_linkage + winding.inductance * d)
    return sqrt(0.5 * (d * d + q * q)), sqrt(0.5 * (u_d * u_d + u_q * u_q))


@inlined
def limited_torque(motor: Motor, wanted: float, speed: float, heat: float) -> float:
    """Torque [N m] that the inverter goes for when `wanted` [N m] is asked at a speed [rad/s].

    Driving: peak torque (nominal once `heat`, the filtered squared torque over its nominal value
    [1], is above 1), peak power, none beyond the maximum speed. Generating: generator torque and
    power. At rest both agree on the torque limits, so the direction of travel needs no case.
    """
    magnitude = abs(wanted)
    turns = abs(speed)
    hot = min(max((heat - 1.0) / HEAT_FADE, 0.0), 1.0)
    lasting = min(motor.nominal_torque, motor.peak_torque)
    torque_limit = motor.peak_torque + hot * (lasting - motor.peak_torque)
    if wanted * speed >= 0.0:
        limit = driving_torque(motor, torque_limit, 1.0, turns)
    else:
        limit = generating_torque(motor, torque_limit, 1.0, turns)
    limited = min(magnitude, limit)
    return limited if wanted >= 0.0 else -limited


@dataclass(frozen=True, slots=True)
class SpeedModeParameters:
    """Gains of a drive in speed mode, both assumed: the sources that command speeds give none."""

    gain: float = parameter(
        3.0,
        unit="N m s/rad",
        low=0.0,
        high=1000.0,
        about="proportional gain at the shaft; with the inertia J of wheel and rotor there the "
        "speed follows at gain/J",
    )
    integral_time: float = parameter(
        1.0,
        unit="s",
        low=1e-3,
        high=1e3,
        about="integral time; less lets the car swing: a wheel carries its inertia",
    )


class SpeedControl(NamedTuple):
    """Gains of a speed control, its period, and the torques between which it may ask."""

    gain: float  # [N m s/rad]
    integral_time: float  # [s]
    period: float  # [s]
    least: float  # [N m]
    most: float  # [N m]


@compilable
def speed_control(control: SpeedControl, integral: float, error: float) -> tuple[float, float]:
    """Torque that is asked for [N m], not limited, and its integral part within the limits [N m].

    `error` is the set-point less the speed [rad/s], held over the period [s].
    """
    gain = control.gain
    integral += gain * error * control.period / control.integral_time
    integral = min(max(integral, control.least), control.most)
    return gain * error + integral, integral


@compilable
def speed_control_without_windup(
    control: SpeedControl, integral: float, error: float
) -> tuple[float, float]:
    """Torque and integral as `speed_control` has them, but without windup.

    Conditional integration (Astrom and Murray, Feedback Systems, section on integral windup): a
    drive waits at its limit for as long as the car takes to gain speed. A load machine of the bench
    is there for some milliseconds only.
    """
    held = min(max(integral, control.least), control.most)
    asked, moved = speed_control(control, integral, error)
    # Beyond a limit the integral may only go back.
    grows = asked > control.most and moved > held
    falls = asked < control.least and moved < held
    if grows or falls:
        return control.gain * error + held, held
    return asked, moved
