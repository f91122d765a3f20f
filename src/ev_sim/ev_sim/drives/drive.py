"""The brushless drives by one interface, and the switched one, transistor by transistor.

Torque reference and shaft speed go in; torque, current and electrical power come out.

How the switched drive works, by six-step commutation:

Hall sensors divide the electrical turn into six sectors. In each of them one phase is on its
positive EMF flat (high), one on its negative flat (low), and the EMF of the third (off) crosses
from one flat to the other:

    sector  0  1  2  3  4  5
    high    a  a  b  b  c  c
    low     b  c  c  a  a  b
    off     c  b  a  c  b  a

The converter connects high and low to the bus, one to each rail, and chops by exchanging the rails.
That works for both signs of current and of speed. Both transistors of the off phase block: its
current freewheels through a diode until it is zero, and a diode conducts again whenever the
terminal leaves the range of the bus. So commutation ripple, loss of current control at too low a
bus voltage, and uncontrolled braking by the diodes come out of the circuit (below). Assumed: ideal
transistors, diodes and Hall sensors, no dead time, and a rotor that starts in the middle of sector
0.

The circuit of converter and motor: how the currents of the three phases go on while no transistor
switches.

    L i_k' = v_k - v_n - e_k - R i_k,    e_k = p psi omega f_k,
    M = p psi sum(f_k i_k),              sum(i_k) = 0

with the neutral's voltage v_n from the sum of the conducting phases (Pillay and Krishnan, Modeling,
simulation, and analysis of permanent-magnet motor drives, part II, IEEE Trans. Ind. Appl. 25,
1989).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ev_core.law import ParameterError, compilable, group, setting
from ev_sim.drives import brushless_motor
from ev_sim.drives.brushless_motor import (
    DriveState,
    Held,
    MotorParameters,
    Phase,
    crossing_shape,
    phase_of,
    torque_constant,
)

CURRENT_CONTROLS = ("hysteresis", "pwm")
HYSTERESIS, PWM = range(len(CURRENT_CONTROLS))
DRIVE_MODELS = ("ideal", "averaged", "switched")
IDEAL_DRIVE, AVERAGED_DRIVE, SWITCHED_DRIVE = range(len(DRIVE_MODELS))


@dataclass(frozen=True, slots=True)
class SwitchedDriveParameters:
    """Switched drive; all of it is assumed."""

    current_control: str = setting(
        "hysteresis", choices=CURRENT_CONTROLS, about="how the converter chops"
    )
    hysteresis_band: float = setting(
        0.5,
        unit="A",
        low=0.01,
        high=100.0,
        about="hysteresis: half of the width that the current moves in",
    )
    pwm_frequency: float = setting(
        20e3,
        unit="Hz",
        low=1e3,
        high=1e5,
        about="pwm: carrier frequency, rounded to whole periods in a sub-step",
    )
    current_controller: brushless_motor.CurrentControllerParameters = group(
        brushless_motor.CurrentControllerParameters
    )
    micro_step: float = setting(
        5e-6,
        unit="s",
        low=1e-7,
        high=1e-4,
        about="longest integration step; every switching instant also ends a step",
    )

    def __post_init__(self) -> None:
        if self.current_controller.bandwidth > self.pwm_frequency:
            raise ParameterError(
                f"current_controller.bandwidth: {self.current_controller.bandwidth!r} is refused, "
                f"expected at most "
                f"pwm_frequency = {self.pwm_frequency:g} in rad/s, beyond which the sampled loop "
                f"overshoots"
            )


@dataclass(frozen=True, slots=True)
class DriveParameters:
    """Drive model with its motor; a plant's parameters inherit from it to have the same names."""

    drive: str = setting("ideal", choices=DRIVE_MODELS, about="depth of detail of the drives")
    motor: MotorParameters = group(MotorParameters)
    averaged: brushless_motor.AveragedDriveParameters = group(
        brushless_motor.AveragedDriveParameters
    )
    switched: SwitchedDriveParameters = group(SwitchedDriveParameters)


@compilable
def pair_current(high_current: float, off_current: float) -> float:
    """The controlled current [A], in from high to low: that of the phase which carries more.

    Of high and low it is the phase which a commutation leaves on, so the current is measured
    without a jump in both directions of rotation. The low phase carries back what flows in by the
    other two.
    """
    returned = high_current + off_current
    return high_current if abs(high_current) > abs(returned) else returned


@compilable
def conduct(
    s: DriveState,
    p: DriveParameters,
    sign: float,
    limit: float,
    held: Held,
    duration: float,
) -> tuple[float, float, float]:
    """Let the circuit run until the current comes to its limit [A].

    High is on the upper rail (sign 1) or on the lower (sign -1). Returns the elapsed time, at most
    `duration` [s], and over it the angular impulse [N m s] and the electrical energy from the bus
    [J]. A step ends early where the rotor enters the next sector, where a freewheeling current
    reaches zero, and where the current reaches the limit.
    """
    motor = p.motor
    phase = phase_of(motor)
    bus_voltage = held.bus_voltage
    electrical_speed = motor.pole_pairs * held.speed
    emf = phase.flux_linkage * electrical_speed
    high_voltage = bus_voltage if sign > 0.0 else 0.0
    low_voltage = bus_voltage - high_voltage
    impulse = 0.0
    energy = 0.0
    remaining = duration
    while remaining > 0.0:
        brushless_motor.enter_sector(s, electrical_speed)
        high, off = s.high_current, s.off_current
        current = pair_current(high, off)
        # At its limit already, or beyond by a commutation: the rails are exchanged without delay.
        if sign * (current - limit) >= 0.0:
            break

        to_edge = brushless_motor.time_to_edge(s.sector_angle, electrical_speed)
        step = min(remaining, p.switched.micro_step, to_edge)
        # The EMF of the off phase in the middle of the step, as the midpoint rule has it.
        middle = s.sector_angle + electrical_speed * step / 2.0
        crossing = crossing_shape(s.sector, middle)
        off_conducts, off_voltage = _off_phase(off, emf * crossing, bus_voltage)
        # The mean of what all conducting phases have of the bus less their EMFs; those of high and
        # low cancel, so with two phases half of the bus is left.
        if off_conducts:
            neutral = (bus_voltage + off_voltage - emf * crossing) / 3.0
            off_drive = off_voltage - neutral - emf * crossing
        else:
            neutral = bus_voltage / 2.0
            off_drive = 0.0
        high_drive = high_voltage - neutral - emf

        next_off = _after(off, off_drive, phase, step)
        blocks = off * next_off < 0.0
        if blocks:
            # -L i/h = drive - R i/2: the midpoint rule, solved for the step that ends without
            # current.
            step = off * phase.inductance / (off * phase.resistance / 2.0 - off_drive)
            next_off = 0.0
        next_high = _after(high, high_drive, phase, step)
        next_current = pair_current(next_high, next_off)
        at_limit = sign * (next_current - limit) > 0.0
        if at_limit:
            # Within a step the current is as good as straight, so the instant follows by
            # proportion.
            step *= (limit - current) / (next_current - current)
            next_off = _after(off, off_drive, phase, step)
            next_high = _after(high, high_drive, phase, step)

        mean_high = (high + next_high) / 2.0
        mean_off = (off + next_off) / 2.0
        impulse += step * phase_torque(motor, crossing, mean_high, mean_off)
        # The low phase carries back the sum of the two others.
        power = high_voltage * mean_high - low_voltage * (mean_high + mean_off)
        energy += step * (power + off_voltage * mean_off)
        s.high_current = next_high
        s.off_current = next_off
        # A step that was cut at the edge ends on it exactly: rounding short of it, the rotor would
        # never enter the next sector.
        s.sector_angle = brushless_motor.turned(
            s.sector_angle, electrical_speed, step, step == to_edge
        )
        remaining -= step
        if at_limit:
            break
    return duration - remaining, impulse, energy


@compilable
def phase_torque(
    motor: MotorParameters, crossing: float, high_current: float, off_current: float
) -> float:
    """Electromagnetic torque p psi (i_high - i_low + f_off i_off) [N m].

    The currents sum up to zero: i_low = -(i_high + i_off).
    """
    weighted = 2.0 * high_current + (1.0 + crossing) * off_current
    return motor.pole_pairs * phase_of(motor).flux_linkage * weighted


@compilable
def _off_phase(off_current: float, off_emf: float, bus_voltage: float) -> tuple[bool, float]:
    """True if a diode of the off phase conducts, and the terminal's voltage [V].

    The voltage is that above the lower rail. A current into the motor comes from the lower rail,
    one out of it goes to the upper rail. Without current the terminal floats at half the bus
    voltage, where the neutral is, plus its EMF.
    """
    floating = bus_voltage / 2.0 + off_emf
    if off_current > 0.0 or (off_current == 0.0 and floating < 0.0):
        return True, 0.0
    if off_current < 0.0 or floating > bus_voltage:
        return True, bus_voltage
    return False, floating


@compilable
def _after(current: float, drive: float, phase: Phase, step: float) -> float:
    """Phase current after a step of the implicit midpoint rule for L i' = drive - R i [A]."""
    half_decay = step * phase.resistance / (2.0 * phase.inductance)
    return (current * (1.0 - half_decay) + step * drive / phase.inductance) / (1.0 + half_decay)


@compilable
def advance_switched(
    s: DriveState, p: DriveParameters, torque_reference: float, held: Held, duration: float
) -> None:
    """Advance the circuit under its current control, and set the outputs of the state.

    Implicit midpoint rule: electrical energy = copper loss + mechanical work + change of magnetic
    energy up to rounding.
    """
    reference = torque_reference / torque_constant(p.motor)
    if p.switched.current_control == HYSTERESIS:
        impulse, energy = _chop_in_band(s, p, reference, held, duration)
    else:
        impulse, energy = _chop_by_carrier(s, p, reference, held, duration)
    s.current = pair_current(s.high_current, s.off_current)
    crossing = crossing_shape(s.sector, s.sector_angle)
    s.torque = phase_torque(p.motor, crossing, s.high_current, s.off_current)
    s.mean_torque = impulse / duration
    s.electrical_power = energy / duration


@compilable
def _chop_in_band(
    s: DriveState, p: DriveParameters, reference: float, held: Held, duration: float
) -> tuple[float, float]:
    """Exchange the rails whenever the current leaves its band; impulse [N m s] and energy [J]."""
    impulse = energy = 0.0
    remaining = duration
    while remaining > 0.0:
        limit = reference + s.voltage_sign * p.switched.hysteresis_band
        elapsed, more_impulse, more_energy = conduct(s, p, s.voltage_sign, limit, held, remaining)
        impulse += more_impulse
        energy += more_energy
        remaining -= elapsed
        if remaining > 0.0:
            s.voltage_sign = -s.voltage_sign
    return impulse, energy


@compilable
def _chop_by_carrier(
    s: DriveState, p: DriveParameters, reference: float, held: Held, duration: float
) -> tuple[float, float]:
    """Exchange the rails by a centred carrier; impulse [N m s] and energy [J].

    Where the carrier turns the sampled current equals its mean over the chopping.
    """
    impulse = energy = 0.0
    controller = p.switched.current_controller
    carriers = max(1, round(duration * p.switched.pwm_frequency))
    period = duration / carriers
    for _ in range(carriers):
        error = reference - pair_current(s.high_current, s.off_current)
        voltage = brushless_motor.controlled_voltage(s, controller, p.motor, error, held, period)
        positive = period * (1.0 + voltage / held.bus_voltage) / 2.0
        negative = (period - positive) / 2.0
        # A limit out of reach: only the carrier exchanges the rails.
        for sign, span in ((-1.0, negative), (1.0, positive), (-1.0, negative)):
            _, more_impulse, more_energy = conduct(s, p, sign, sign * math.inf, held, span)
            impulse += more_impulse
            energy += more_energy
    return impulse, energy


@compilable
def advance_drive(
    s: DriveState,
    p: DriveParameters,
    torque_reference: float,
    speed: float,
    bus_voltage: float,
    duration: float,
) -> None:
    """Advance one drive over `duration` [s], the shaft speed held [rad/s].

    The reference [N m] is positive forwards and is limited to the motor's torque limit;
    `bus_voltage` is above zero [V].
    """
    held = Held(speed, bus_voltage)
    most = p.motor.torque_limit
    reference = min(max(torque_reference, -most), most)
    if p.drive == IDEAL_DRIVE:
        # The current is the one that the torque needs; the bus voltage limits nothing.
        s.torque = s.mean_torque = reference
        s.current = reference / torque_constant(p.motor)
        s.electrical_power = reference * speed
    elif p.drive == AVERAGED_DRIVE:
        brushless_motor.advance_averaged(s, p, reference, held, duration)
    else:
        advance_switched(s, p, reference, held, duration)
