"""The electrical side: battery, and the heat that losses of motor and inverter bring.

The battery is a source behind one resistance, or equal cells in series: relaxation of the voltage,
limits of the current by temperature.

    U = n (E(SoC) - R_0 I) - U_1,    tau U_1' = n R_1 I - U_1

The first-order model of Thevenin, as in Plett, Battery Management Systems, volume 1, 2015, chapter
2.

Winding and power stage have one capacity each, and one resistance to one coolant. The winding takes
the copper loss, the power stage what grows with the torque; iron, windage and the idle loss of the
electronics go from the housing into the air (assumption).
"""

from __future__ import annotations

from collections.abc import Sequence

from ev_core.law import inlined, sqrt
from ev_core.vehicle.battery import Battery
from ev_core.vehicle.motor import ThermalParameters

# K per W at 1 l/min: water with glycol, 3.5 kJ/(kg K), 1.06 kg/l, in l/min
COOLANT = 60.0e3 / (3.5e3 * 1.06e3)


@inlined
def open_circuit_voltage(table: tuple[float, ...], state_of_charge: float) -> float:
    """Voltage without current [V], by a table at equally spaced states of charge from 0 to 1."""
    last = len(table) - 1
    place = min(max(state_of_charge, 0.0), 1.0) * last
    # A full battery is at the end of the last interval, not at the begin of one behind it.
    index = min(int(place), last - 1)
    return table[index] + (place - index) * (table[index + 1] - table[index])


@inlined
def current_at_power(voltage: float, resistance: float, power: float) -> float:
    """Current [A] that gives a power [W] at the terminals, both positive out of the battery.

    I = (E - sqrt(E^2 - 4 R P)) / (2 R), the solution of (E - R I) I = P on the efficient side. A
    power above E^2/(4 R), which no current gives, gets the current of the largest power.
    """
    return (voltage - sqrt(max(voltage * voltage - 4.0 * resistance * power, 0.0))) / (
        2.0 * resistance
    )


@inlined
def power_limits(battery: Battery, voltage: float, state_of_charge: float) -> tuple[float, float]:
    """Largest power out of and into the battery [W].

    Nothing comes out of an empty one, nothing goes into a full one.
    """
    most = min(battery.discharge_power, voltage * voltage / (4.0 * battery.resistance))
    give = most if state_of_charge > 0.0 else 0.0
    take = battery.charge_power if state_of_charge < 1.0 else 0.0
    return give, take


@inlined
def relaxed(voltage: float, current: float, resistance: float, share: float) -> float:
    """U_1 [V] after a step at a current [A], exactly, with share = 1 - exp(-h/tau).

    The resistance is that of the whole string.
    """
    return voltage + share * (resistance * current - voltage)


@inlined
def temperature_share(corners: Sequence[float], temperature: float) -> float:
    """Share of the current that a temperature [degC] leaves [1].

    It is linear between 0, 1, 1 and 0 at four corners.
    """
    # The two slopes; beyond 1 they meet the flat part between the middle corners.
    warm_enough = (temperature - corners[0]) / (corners[1] - corners[0])
    cool_enough = (corners[3] - temperature) / (corners[3] - corners[2])
    return min(max(min(warm_enough, cool_enough), 0.0), 1.0)


@inlined
def cell_power_limits(
    battery: Battery,
    voltage: float,
    resistance: float,
    state_of_charge: float,
    discharging: float,
    charging: float,
) -> tuple[float, float]:
    """Largest power out of and into the battery [W], by limits of current and of power.

    `voltage` [V] behind the resistance [ohm] of the string; nothing out of an empty one, nothing
    into a full one. `discharging` and `charging` are the shares of the currents that the
    temperature leaves [1].
    """
    # E/(2 R) gives the largest power; more current would give less.
    out = min(battery.cells.discharge_current * discharging, voltage / (2.0 * resistance))
    into = battery.cells.charge_current * charging
    give = min((voltage - resistance * out) * out, battery.discharge_power)
    take = min((voltage + resistance * into) * into, battery.charge_power)
    return give if state_of_charge > 0.0 else 0.0, take if state_of_charge < 1.0 else 0.0


@inlined
def heated(rise: float, power: float, resistance: float, left: float) -> float:
    """Rise above the coolant [K] after a step under a power [W].

    C T' = P - T/R, exactly, with left = exp(-h/(R C)).
    """
    final = power * resistance
    return final + (rise - final) * left


@inlined
def coolant_outlet_temperature(
    p: ThermalParameters, winding_rise: float, inverter_rise: float
) -> float:
    """Temperature of the coolant behind winding and power stage [degC], at their rises [K].

    It is warmer than at the inlet by the heat that both give off.
    """
    heat = winding_rise / p.winding_resistance + inverter_rise / p.inverter_resistance
    return p.coolant + heat * COOLANT / p.coolant_flow


@inlined
def derating_share(p: ThermalParameters, winding: float, inverter: float) -> float:
    """Share of the torque [1] that temperatures [degC] leave: 1 if not warm, 0 at the limits."""
    of_winding = (p.winding_limit - winding) / (p.winding_limit - p.winding_warm)
    of_inverter = (p.inverter_limit - inverter) / (p.inverter_limit - p.inverter_warm)
    return min(max(min(of_winding, of_inverter), 0.0), 1.0)
