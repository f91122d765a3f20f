"""Heat in winding and power stage of an inverter as its sensors show it, and what is too hot."""

from __future__ import annotations

from ev_msgs_py.can.faults import INVERTER_TEMPERATURE, WINDING_TEMPERATURE
from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.elementary import exp
from ev_msgs_py.vehicle.thermal import ThermalParameters
from ev_sim.drives.temperatures import coolant_outlet_temperature, derating_share, heated
from ev_sim.inverter.machine import Machine
from ev_sim.inverter.state import Inverter


@compilable
def advance_temperatures(p: ThermalParameters, machine: Machine, s: Inverter, period: float) -> None:
    """Heat by the torque that there is: C T' = P - (T - T_coolant)/R, exactly over `period` [s]."""
    torque = s.torque
    copper = machine.copper_loss * torque * torque + s.weakening_loss
    stage = machine.inverter_torque_loss * abs(torque)
    winding_left = exp(-period / (p.winding_capacity * p.winding_resistance))
    inverter_left = exp(-period / (p.inverter_capacity * p.inverter_resistance))
    s.temperatures.winding = heated(s.temperatures.winding, copper, p.winding_resistance, winding_left)
    s.temperatures.inverter = heated(s.temperatures.inverter, stage, p.inverter_resistance, inverter_left)


@compilable
def winding_temperature(p: ThermalParameters, s: Inverter) -> float:
    """As its sensor says [degC]."""
    return p.coolant + s.temperatures.winding + s.injected.winding_rise


@compilable
def inverter_temperature(p: ThermalParameters, s: Inverter) -> float:
    """As its sensor says [degC]."""
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
def temperature_faults(p: ThermalParameters, s: Inverter) -> int:
    """The bits of what is too hot."""
    bits = WINDING_TEMPERATURE if winding_temperature(p, s) > p.winding_limit else 0
    return bits | (INVERTER_TEMPERATURE if inverter_temperature(p, s) > p.inverter_limit else 0)
