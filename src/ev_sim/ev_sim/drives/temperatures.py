"""Heat in winding and power stage: one capacity each, one resistance to one coolant, derating.

The winding takes the copper loss, the power stage what grows with the torque; iron, windage and the idle loss of the
electronics go from the housing into the air (assumption).
"""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.vehicle.thermal import ThermalParameters

_COOLANT = 60.0e3 / (3.5e3 * 1.06e3)  # K per W at 1 l/min: water with glycol, 3.5 kJ/(kg K), 1.06 kg/l, in l/min


@inlined
def heated(rise: float, power: float, resistance: float, left: float) -> float:
    """Rise above what cools [K] after a step under a power [W]: C T' = P - T/R, exactly, with left = exp(-h/(R C))."""
    final = power * resistance
    return final + (rise - final) * left


@inlined
def coolant_outlet_temperature(p: ThermalParameters, winding_rise: float, inverter_rise: float) -> float:
    """Warmer than the inlet by the heat that winding and power stage give off at these rises [K]: in degC."""
    heat = winding_rise / p.winding_resistance + inverter_rise / p.inverter_resistance
    return p.coolant + heat * _COOLANT / p.coolant_flow


@inlined
def derating_share(p: ThermalParameters, winding: float, inverter: float) -> float:
    """Share of the torque that temperatures [degC] leave [1]: 1 up to the warm ones, 0 at the limits."""
    of_winding = (p.winding_limit - winding) / (p.winding_limit - p.winding_warm)
    of_inverter = (p.inverter_limit - inverter) / (p.inverter_limit - p.inverter_warm)
    return min(max(min(of_winding, of_inverter), 0.0), 1.0)
