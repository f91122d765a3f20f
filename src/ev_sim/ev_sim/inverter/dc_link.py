"""The DC link: charged through a resistor, then connected by a contactor."""

from __future__ import annotations

from ev_core.elementary import exp
from ev_core.law import compilable
from ev_msgs_py.can.drive_states import QUICK_STOP_ACTIVE, READY_TO_SWITCH_ON, SWITCH_ON, SWITCHED_ON
from ev_msgs_py.can.frames import DC_LINK_LOSS, DC_OVER_VOLTAGE, PRECHARGE_TIMEOUT
from ev_sim.inverter.parameters import DcLinkParameters
from ev_sim.inverter.state import Inverter


@compilable
def advance_dc_link(p: DcLinkParameters, s: Inverter, period: float) -> None:
    """Charge, hold or discharge the capacitor over `period` [s].

    V' = (V_supply - V)/(R C) while it charges, from the command to switch on until the contactor closes; the contactor
    stays closed until the voltage is disabled or there is a fault.
    """
    link, state = s.dc_link, int(s.state)
    powered = READY_TO_SWITCH_ON <= state <= QUICK_STOP_ACTIVE
    charging = state == READY_TO_SWITCH_ON and int(s.command.controlword) & SWITCH_ON != 0 and link.contactor == 0.0
    if s.injected.supply_lost != 0.0 or not powered:
        link.contactor = 0.0
    if link.contactor != 0.0:
        link.voltage = p.supply_voltage
    elif charging and s.injected.supply_lost == 0.0:
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
    """The bits of what is wrong with the DC link; its contactor is watched as well as its voltage."""
    state, voltage = int(s.state), s.dc_link.voltage + s.injected.voltage_rise
    bits = 0
    if SWITCHED_ON <= state <= QUICK_STOP_ACTIVE:
        if s.dc_link.contactor == 0.0 or voltage < p.least_share * p.supply_voltage:
            bits |= DC_LINK_LOSS
    elif s.injected.supply_lost != 0.0:
        bits |= DC_LINK_LOSS
    if voltage > p.highest_share * p.supply_voltage:
        bits |= DC_OVER_VOLTAGE
    if s.dc_link.charging_time > p.precharge_timeout:
        bits |= PRECHARGE_TIMEOUT
    return bits
