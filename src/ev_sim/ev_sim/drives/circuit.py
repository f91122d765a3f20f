"""The circuit of converter and motor: how the currents of the three phases go on while no transistor switches.

    L i_k' = v_k - v_n - e_k - R i_k,    e_k = p psi omega f_k,    M = p psi sum(f_k i_k),    sum(i_k) = 0

with the neutral's voltage v_n from the sum of the conducting phases (Pillay and Krishnan, Modeling, simulation, and
analysis of permanent-magnet motor drives, part II, IEEE Trans. Ind. Appl. 25, 1989).
"""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_sim.drives.motor import MotorParameters
from ev_sim.drives.sectors import crossing_shape, enter_sector, time_to_edge, turned
from ev_sim.drives.state import DriveState


@compilable
def pair_current(high_current: float, off_current: float) -> float:
    """The current that is controlled [A]: of the high and the low phase the one that carries more, in from high to low.

    That is the phase which a commutation leaves on, so the current is measured without a jump in both directions of
    rotation. The low phase carries back what flows in by the other two.
    """
    returned = high_current + off_current
    return high_current if abs(high_current) > abs(returned) else returned


@compilable
def conduct(
    s: DriveState,
    motor: MotorParameters,
    micro_step: float,
    sign: float,
    limit: float,
    speed: float,
    bus_voltage: float,
    duration: float,
) -> tuple[float, float, float]:
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
        enter_sector(s, electrical_speed)
        high, off = s.high_current, s.off_current
        current = pair_current(high, off)
        if sign * (current - limit) >= 0.0:
            break

        to_edge = time_to_edge(s.sector_angle, electrical_speed)
        step = min(remaining, micro_step, to_edge)
        middle = s.sector_angle + electrical_speed * step / 2.0
        crossing = crossing_shape(s.sector, middle)
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
        impulse += step * phase_torque(motor, crossing, mean_high, mean_off)
        energy += step * (high_voltage * mean_high - low_voltage * (mean_high + mean_off) + off_voltage * mean_off)
        s.high_current = next_high
        s.off_current = next_off
        s.sector_angle = turned(s.sector_angle, electrical_speed, step, step == to_edge)
        remaining -= step
        if at_limit:
            break
    return duration - remaining, impulse, energy


@compilable
def phase_torque(motor: MotorParameters, crossing: float, high_current: float, off_current: float) -> float:
    """Electromagnetic torque p psi (i_high - i_low + f_off i_off) [N m], where i_low = -(i_high + i_off)."""
    weighted = 2.0 * high_current + (1.0 + crossing) * off_current
    return motor.pole_pairs * motor.flux_linkage * weighted


@compilable
def _off_phase(off_current: float, off_emf: float, bus_voltage: float) -> tuple[bool, float]:
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


@compilable
def _after(current: float, drive: float, motor: MotorParameters, step: float) -> float:
    """Phase current after a step of the implicit midpoint rule for L i' = drive - R i [A]."""
    half_decay = step * motor.resistance / (2.0 * motor.inductance)
    return (current * (1.0 - half_decay) + step * drive / motor.inductance) / (1.0 + half_decay)
