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
loss of current control at too low a bus voltage, and uncontrolled braking by the diodes come out of the circuit.

    L i_k' = v_k - v_n - e_k - R i_k,    e_k = p psi omega f_k,    M = p psi sum(f_k i_k),    sum(i_k) = 0

with the neutral's voltage v_n from the sum of the conducting phases (Pillay and Krishnan, Modeling, simulation, and
analysis of permanent-magnet motor drives, part II, IEEE Trans. Ind. Appl. 25, 1989). Assumed: ideal transistors,
diodes and Hall sensors, no dead time, and a rotor that starts in the middle of sector 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ev_msgs_py.parameters import ParameterError, group, parameter
from ev_sim.compiled import compiled
from ev_sim.drives.current_controller import CurrentControllerParameters, controlled_voltage
from ev_sim.drives.motor import torque_constant

CURRENT_CONTROLS = ("hysteresis", "pwm")
HYSTERESIS = CURRENT_CONTROLS.index("hysteresis")
SECTOR = math.pi / 3.0  # width of a Hall sector, as an electrical angle [rad]


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


@compiled
def advance_switched(state, motor, switched, torque_reference, speed, bus_voltage, duration):
    """Advance the circuit under its current control and set the outputs of `state`; see `drive.advance_drive`.

    Implicit midpoint rule: electrical energy = copper loss + mechanical work + change of magnetic energy up to
    rounding.
    """
    current_reference = torque_reference / torque_constant(motor)
    if switched.current_control == HYSTERESIS:
        impulse, energy = _chop_by_hysteresis(state, motor, switched, current_reference, speed, bus_voltage, duration)
    else:
        impulse, energy = _chop_by_pwm(state, motor, switched, current_reference, speed, bus_voltage, duration)
    state.current = pair_current(state.high_current, state.off_current)
    crossing = _crossing_shape(state.sector, state.sector_angle)
    state.torque = _torque(motor, crossing, state.high_current, state.off_current)
    state.mean_torque = impulse / duration
    state.electrical_power = energy / duration


@compiled
def pair_current(high_current, off_current):
    """The current that is controlled [A]: of the high and the low phase the one that carries more, in from high to low.

    That is the phase which a commutation leaves on, so the current is measured without a jump in both directions of
    rotation. The low phase carries back what flows in by the other two.
    """
    returned = high_current + off_current
    return high_current if abs(high_current) > abs(returned) else returned


@compiled
def _chop_by_hysteresis(state, motor, switched, current_reference, speed, bus_voltage, duration):
    """Exchange the rails whenever the current leaves its band; angular impulse [N m s] and electrical energy [J]."""
    impulse = 0.0
    energy = 0.0
    remaining = duration
    while remaining > 0.0:
        limit = current_reference + state.voltage_sign * switched.hysteresis_band
        elapsed, more_impulse, more_energy = _conduct(
            state, motor, switched.micro_step, state.voltage_sign, limit, speed, bus_voltage, remaining
        )
        impulse += more_impulse
        energy += more_energy
        remaining -= elapsed
        if remaining > 0.0:
            state.voltage_sign = -state.voltage_sign
    return impulse, energy


@compiled
def _chop_by_pwm(state, motor, switched, current_reference, speed, bus_voltage, duration):
    """Exchange the rails by a centred carrier; angular impulse [N m s] and electrical energy [J].

    The current is sampled where the carrier turns: there it equals its mean over the chopping.
    """
    impulse = 0.0
    energy = 0.0
    carriers = max(1, round(duration * switched.pwm_frequency))
    period = duration / carriers
    for _ in range(carriers):
        current = pair_current(state.high_current, state.off_current)
        voltage = controlled_voltage(
            state, switched.current_controller, motor, current_reference, current, speed, bus_voltage, period
        )
        positive = period * (1.0 + voltage / bus_voltage) / 2.0
        negative = (period - positive) / 2.0
        for sign, span in ((-1.0, negative), (1.0, positive), (-1.0, negative)):
            _, more_impulse, more_energy = _conduct(
                state, motor, switched.micro_step, sign, sign * math.inf, speed, bus_voltage, span
            )
            impulse += more_impulse
            energy += more_energy
    return impulse, energy


@compiled
def _conduct(state, motor, micro_step, sign, limit, speed, bus_voltage, duration):
    """Let the circuit run with high on the upper rail (sign 1) or on the lower (sign -1) until the current limit.

    Returns the elapsed time, at most `duration` [s], and over it the angular impulse [N m s] and the electrical energy
    from the bus [J]. A step ends early where the rotor enters the next sector, where a freewheeling current reaches
    zero, and where the current reaches the limit.
    """
    electrical_speed = motor.pole_pairs * speed
    emf = motor.flux_linkage * electrical_speed
    high_voltage = bus_voltage if sign > 0.0 else 0.0
    low_voltage = bus_voltage - high_voltage
    impulse = 0.0
    energy = 0.0
    remaining = duration
    while remaining > 0.0:
        _enter_sector(state, electrical_speed)
        high, off = state.high_current, state.off_current
        current = pair_current(high, off)
        if sign * (current - limit) >= 0.0:
            break

        to_edge = _time_to_edge(state.sector_angle, electrical_speed)
        step = min(remaining, micro_step, to_edge)
        middle = state.sector_angle + electrical_speed * step / 2.0
        crossing = _crossing_shape(state.sector, middle)
        off_conducts, off_voltage = _off_phase(off, emf * crossing, bus_voltage)
        if off_conducts:
            neutral = (bus_voltage + off_voltage - emf * crossing) / 3.0
            off_drive = off_voltage - neutral - emf * crossing
        else:
            neutral = bus_voltage / 2.0
            off_drive = 0.0
        high_drive = high_voltage - neutral - emf

        next_off = _after(off, off_drive, motor, step)
        blocks = off * next_off < 0.0
        if blocks:
            step = off * motor.inductance / (off * motor.resistance / 2.0 - off_drive)
            next_off = 0.0
        next_high = _after(high, high_drive, motor, step)
        next_current = pair_current(next_high, next_off)
        at_limit = sign * (next_current - limit) > 0.0
        if at_limit:
            step *= (limit - current) / (next_current - current)
            next_off = _after(off, off_drive, motor, step)
            next_high = _after(high, high_drive, motor, step)

        mean_high = (high + next_high) / 2.0
        mean_off = (off + next_off) / 2.0
        impulse += step * _torque(motor, crossing, mean_high, mean_off)
        energy += step * (high_voltage * mean_high - low_voltage * (mean_high + mean_off) + off_voltage * mean_off)
        state.high_current = next_high
        state.off_current = next_off
        state.sector_angle = _turned(state.sector_angle, electrical_speed, step, step == to_edge)
        remaining -= step
        if at_limit:
            break
    return duration - remaining, impulse, energy


@compiled
def _crossing_shape(sector, sector_angle):
    """EMF of the off phase over that of the flats: from 1 down to -1 in even sectors, up in odd ones."""
    falling = 1.0 - 2.0 * sector_angle / SECTOR
    return falling if sector % 2 == 0 else -falling


@compiled
def _torque(motor, crossing, high_current, off_current):
    """Electromagnetic torque p psi (i_high - i_low + f_off i_off) [N m], where i_low = -(i_high + i_off)."""
    weighted = 2.0 * high_current + (1.0 + crossing) * off_current
    return motor.pole_pairs * motor.flux_linkage * weighted


@compiled
def _off_phase(off_current, off_emf, bus_voltage):
    """Whether a diode of the off phase conducts, and the terminal's voltage above the lower rail [V].

    A current into the motor comes from the lower rail, one out of it goes to the upper rail. Without current the
    terminal floats at half the bus voltage, where the neutral is, plus its EMF.
    """
    floating = bus_voltage / 2.0 + off_emf
    if off_current > 0.0 or (off_current == 0.0 and floating < 0.0):
        return True, 0.0
    if off_current < 0.0 or floating > bus_voltage:
        return True, bus_voltage
    return False, floating


@compiled
def _after(current, drive, motor, step):
    """Phase current after a step of the implicit midpoint rule for L i' = drive - R i [A]."""
    half_decay = step * motor.resistance / (2.0 * motor.inductance)
    return (current * (1.0 - half_decay) + step * drive / motor.inductance) / (1.0 + half_decay)


@compiled
def _time_to_edge(sector_angle, electrical_speed):
    """Time until the rotor enters the next sector [s]; infinite at rest."""
    if electrical_speed > 0.0:
        return (SECTOR - sector_angle) / electrical_speed
    if electrical_speed < 0.0:
        return sector_angle / -electrical_speed
    return math.inf


@compiled
def _turned(sector_angle, electrical_speed, step, at_edge):
    """Angle within the sector after a step [rad], exactly on the edge where the step was cut to end there."""
    if at_edge:
        return SECTOR if electrical_speed > 0.0 else 0.0
    return min(max(sector_angle + electrical_speed * step, 0.0), SECTOR)


@compiled
def _enter_sector(state, electrical_speed):
    """Commutate if the rotor stands on the edge that it moves across: one phase takes over from the off phase.

    Between an even sector and the next one high stays, between an odd one and the next low stays.
    """
    if electrical_speed > 0.0 and state.sector_angle >= SECTOR:
        lower_sector = state.sector
        state.sector = (state.sector + 1) % 6
        state.sector_angle = 0.0
    elif electrical_speed < 0.0 and state.sector_angle <= 0.0:
        lower_sector = (state.sector + 5) % 6
        state.sector = lower_sector
        state.sector_angle = SECTOR
    else:
        return
    if lower_sector % 2 == 0:
        state.off_current = -(state.high_current + state.off_current)
    else:
        state.high_current, state.off_current = state.off_current, state.high_current
