"""The power side of an inverter: DC link, temperatures, and torque within limits.

How it works: `largest_torque` takes the limits that need roots and divisions, once in a cycle.
Within them `follow_reference` lets the torque follow, which a bench does several times in a cycle.
`advance_electrical` computes currents and losses at its end.
"""

from __future__ import annotations

from ev_bench.inverter.device import DcLinkParameters, Inverter, InverterParameters, Machine
from ev_core.law import compilable, exp
from ev_core.vehicle.losses import loss_power
from ev_core.vehicle.motor import SPEED_FADE, ThermalParameters
from ev_msgs_py.can import frames
from ev_msgs_py.can.drive_states import (
    OPERATION_ENABLED,
    QUICK_STOP_ACTIVE,
    READY_TO_SWITCH_ON,
    SWITCH_ON,
    SWITCHED_ON,
)
from ev_sim.drives import synchronous_motor
from ev_sim.drives.electrical_side import coolant_outlet_temperature, derating_share, heated

_COLD = 0.0  # heat of `limited_torque`: derating is by our own temperatures
_HALF_STEP = 1.0 / 64.0  # N m, of torques in the frames: less is rounding and no limit


@compilable
def advance_dc_link(p: DcLinkParameters, s: Inverter, period: float) -> None:
    """Charge, hold or discharge the capacitor over `period` [s].

    V' = (V_supply - V)/(R C) while it charges, from the command to switch on until the contactor
    closes; the contactor stays closed until the voltage is disabled or there is a fault.
    """
    link, state = s.dc_link, int(s.state)
    powered = READY_TO_SWITCH_ON <= state <= QUICK_STOP_ACTIVE
    charging = (
        state == READY_TO_SWITCH_ON
        and int(s.command.controlword) & SWITCH_ON != 0
        and link.contactor == 0.0
    )
    # The contactor drops out at once, and the voltage then falls with `discharge_time`.
    if s.injected.supply_lost != 0.0 or not powered:
        link.contactor = 0.0
    if link.contactor != 0.0:
        link.voltage = p.supply_voltage
    elif charging and s.injected.supply_lost == 0.0:
        # Exact over the period, which may be longer than R C.
        share = 1.0 - exp(-period / (p.precharge_resistance * p.capacitance))
        link.voltage += share * (p.supply_voltage - link.voltage)
        link.charging_time += period
        if link.voltage >= p.charged_share * p.supply_voltage:
            link.contactor = 1.0
    else:
        link.voltage *= exp(-period / p.discharge_time)
        if charging:
            link.charging_time += period
    if link.contactor != 0.0 or not charging:
        link.charging_time = 0.0


@compilable
def dc_link_faults(p: DcLinkParameters, s: Inverter) -> int:
    """Fault bits of the DC link, from its contactor and its voltage."""
    state, voltage = int(s.state), s.dc_link.voltage + s.injected.voltage_rise
    bits = 0
    if SWITCHED_ON <= state <= QUICK_STOP_ACTIVE:
        if s.dc_link.contactor == 0.0 or voltage < p.least_share * p.supply_voltage:
            bits |= frames.DC_LINK_LOSS
    # Before it is switched on the link may be empty, so only the supply itself is looked at.
    elif s.injected.supply_lost != 0.0:
        bits |= frames.DC_LINK_LOSS
    if voltage > p.highest_share * p.supply_voltage:
        bits |= frames.DC_OVER_VOLTAGE
    if s.dc_link.charging_time > p.precharge_timeout:
        bits |= frames.PRECHARGE_TIMEOUT
    return bits


@compilable
def advance_temperatures(
    p: ThermalParameters, machine: Machine, s: Inverter, period: float
) -> None:
    """Heat by the torque that there is: C T' = P - (T - T_coolant)/R, exactly over `period` [s]."""
    torque = s.torque
    copper = machine.copper_loss * torque * torque + s.weakening_loss
    stage = machine.inverter_torque_loss * abs(torque)
    winding_left = exp(-period / (p.winding_capacity * p.winding_resistance))
    inverter_left = exp(-period / (p.inverter_capacity * p.inverter_resistance))
    s.temperatures.winding = heated(
        s.temperatures.winding, copper, p.winding_resistance, winding_left
    )
    s.temperatures.inverter = heated(
        s.temperatures.inverter, stage, p.inverter_resistance, inverter_left
    )


@compilable
def winding_temperature(p: ThermalParameters, s: Inverter) -> float:
    """Temperature that its sensor measures [degC]."""
    return p.coolant + s.temperatures.winding + s.injected.winding_rise


@compilable
def inverter_temperature(p: ThermalParameters, s: Inverter) -> float:
    """Temperature that its sensor measures [degC]."""
    return p.coolant + s.temperatures.inverter + s.injected.inverter_rise


@compilable
def coolant_outlet(p: ThermalParameters, s: Inverter) -> float:
    """Warmer by the heat that winding and power stage give off [degC]."""
    return coolant_outlet_temperature(p, s.temperatures.winding, s.temperatures.inverter)


@compilable
def derating(p: ThermalParameters, s: Inverter) -> float:
    """Share of the torque that temperatures leave [1]: 1 up to the warm ones, 0 at the limits."""
    winding, inverter = winding_temperature(p, s), inverter_temperature(p, s)
    if winding <= p.winding_warm and inverter <= p.inverter_warm:  # as mostly, without a division
        return 1.0
    return derating_share(p, winding, inverter)


@compilable
def advance_torque(p: InverterParameters, s: Inverter, speed: float, period: float) -> None:
    """Let the torque follow its reference over `period` [s], and compute its electrical cost."""
    follow_reference(
        p, s, speed, period, share_of_lag(p.machine.torque_lag, period), largest_torque(p, s, speed)
    )
    advance_electrical(p, s, speed)


@compilable
def share_of_lag(lag: float, period: float) -> float:
    """Share of a step [1] that a first-order lag with a time constant [s] closes in a period."""
    return 1.0 - exp(-period / lag)


@compilable
def largest_torque(p: InverterParameters, s: Inverter, speed: float) -> float:
    """Torque [N m] within set-point, machine, temperatures and voltage; once in a cycle."""
    most = min(s.command.torque_limit, p.machine.peak_torque) * derating(p.thermal, s)
    winding, voltage = p.machine.winding, s.dc_link.voltage
    # Mostly the voltage suffices, and the roots of the circle need not be taken.
    if synchronous_motor.is_weakened(winding, voltage, speed):
        return min(most, synchronous_motor.voltage_limited_torque(winding, voltage, speed))
    current = synchronous_motor.ROOT_2 * winding.largest_current
    return min(most, synchronous_motor.torque_per_current(winding) * current)


@compilable
def follow_reference(
    p: InverterParameters, s: Inverter, speed: float, period: float, share: float, most: float
) -> None:
    """Let the torque follow its reference over `period` [s]; zero at once with the stage off.

    First order, T' = (T_ref - T)/tau: `share` is `share_of_lag`, `most` is `largest_torque`.
    """
    state = int(s.state)
    # Transistors that block end the current at once, without the lag of its control.
    if state not in (OPERATION_ENABLED, QUICK_STOP_ACTIVE):
        s.torque = s.speed_integral = s.limited = s.weakening_loss = 0.0
    else:
        reference = 0.0
        if state == OPERATION_ENABLED:
            asked = _asked(p, s, speed, period, most)
            reference = synchronous_motor.limited_torque(
                p.machine, min(max(asked, -most), most), speed, _COLD
            )
            s.limited = 1.0 if abs(asked - reference) > _HALF_STEP else 0.0
        s.torque += share * (reference - s.torque)


@compilable
def _asked(p: InverterParameters, s: Inverter, speed: float, period: float, most: float) -> float:
    """The torque [N m] that the set-point asks for, forwards positive."""
    sense = -1.0 if s.direction != 0.0 else 1.0
    if int(s.command.mode) == frames.SPEED_MODE and p.offers_speed_mode != 0.0:
        error = sense * s.command.speed - speed
        control = synchronous_motor.SpeedControl(
            p.speed_gain, p.speed_integral_time, period, -most, most
        )
        asked, s.speed_integral = synchronous_motor.speed_control(control, s.speed_integral, error)
        return asked
    s.speed_integral = 0.0  # what it held would be a jolt when speed mode comes again
    if int(s.command.mode) != frames.TORQUE_MODE:
        return 0.0
    asked, room = sense * s.command.torque, abs(s.command.speed) - abs(speed)
    # What slows the shaft down is allowed at any speed.
    if asked * speed < 0.0:
        return asked
    # No torque that would drive the shaft beyond its speed limit.
    return asked * min(max(room / (SPEED_FADE * p.machine.maximum_speed), 0.0), 1.0)


@compilable
def advance_electrical(p: InverterParameters, s: Inverter, speed: float) -> None:
    """Currents, voltage and loss of this torque.

    A power stage that is off takes nothing and sees the magnets alone.

    Once in a cycle is enough, at its end: sensors, faults and the heat of field weakening ask for
    them no oftener.
    """
    s.phase_current = s.dc_current = s.weakening_loss = 0.0
    winding = p.machine.winding
    s.phase_voltage = (
        winding.pole_pairs * abs(speed) * winding.flux_linkage / synchronous_motor.ROOT_2
    )
    if int(s.state) in (OPERATION_ENABLED, QUICK_STOP_ACTIVE) and s.dc_link.voltage > 1.0:
        s.phase_current, s.phase_voltage = synchronous_motor.phase_values(
            p.machine, s.torque, s.dc_link.voltage, speed
        )
        s.weakening_loss = synchronous_motor.weakening_loss(
            p.machine, s.torque, s.dc_link.voltage, speed
        )
        power = s.torque * speed + loss_power(p.machine, s.torque, speed) + s.weakening_loss
        s.dc_current = power / s.dc_link.voltage
