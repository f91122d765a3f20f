"""Heat in winding and power stage: one capacity each, one resistance to the coolant."""

from __future__ import annotations

from ev_msgs_py.can.faults import INVERTER_TEMPERATURE, WINDING_TEMPERATURE
from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.elementary import exp
from ev_sim.inverter.machine import Machine
from ev_sim.inverter.parameters import ThermalParameters
from ev_sim.inverter.state import Inverter

_COOLANT = 60.0e3 / (3.5e3 * 1.06e3)  # K per W at 1 l/min: water with glycol, 3.5 kJ/(kg K), 1.06 kg/l, in l/min


@compilable
def advance_temperatures(p: ThermalParameters, machine: Machine, s: Inverter, period: float) -> None:
    """Heat by the torque that there is: C T' = P - (T - T_coolant)/R, exactly over `period` [s]."""
    torque = s.torque
    copper = machine.copper_loss * torque * torque
    stage = machine.inverter_torque_loss * abs(torque)
    s.temperatures.winding = _heated(s.temperatures.winding, copper, p.winding_capacity, p.winding_resistance, period)
    s.temperatures.inverter = _heated(
        s.temperatures.inverter, stage, p.inverter_capacity, p.inverter_resistance, period
    )


@compilable
def _heated(rise: float, power: float, capacity: float, resistance: float, period: float) -> float:
    final = power * resistance
    return final + (rise - final) * exp(-period / (capacity * resistance))


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
    heat = s.temperatures.winding / p.winding_resistance + s.temperatures.inverter / p.inverter_resistance
    return p.coolant + heat * _COOLANT / p.coolant_flow


@compilable
def derating(p: ThermalParameters, s: Inverter) -> float:
    """Share of the torque that temperatures leave [1]: 1 up to the warm ones, 0 at the limits."""
    winding = (p.winding_limit - winding_temperature(p, s)) / (p.winding_limit - p.winding_warm)
    stage = (p.inverter_limit - inverter_temperature(p, s)) / (p.inverter_limit - p.inverter_warm)
    return min(max(min(winding, stage), 0.0), 1.0)


@compilable
def temperature_faults(p: ThermalParameters, s: Inverter) -> int:
    """The bits of what is too hot."""
    bits = WINDING_TEMPERATURE if winding_temperature(p, s) > p.winding_limit else 0
    return bits | (INVERTER_TEMPERATURE if inverter_temperature(p, s) > p.inverter_limit else 0)
