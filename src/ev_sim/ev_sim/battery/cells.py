"""A battery of equal cells in series: relaxation of the voltage, limits of the current by temperature.

    U = n (E(SoC) - R_0 I) - U_1,    tau U_1' = n R_1 I - U_1

The first-order model of Thevenin, as in Plett, Battery Management Systems, volume 1, 2015, chapter 2.
"""

from __future__ import annotations

from collections.abc import Sequence

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.vehicle.battery import Battery


@inlined
def relaxed(voltage: float, current: float, resistance: float, share: float) -> float:
    """U_1 [V] after a step at a current [A], exactly, with share = 1 - exp(-h/tau); resistance of the whole string."""
    return voltage + share * (resistance * current - voltage)


@inlined
def temperature_share(corners: Sequence[float], temperature: float) -> float:
    """Share of the current that a temperature [degC] leaves [1]: linear between 0, 1, 1 and 0 at four corners."""
    warm_enough = (temperature - corners[0]) / (corners[1] - corners[0])
    cool_enough = (corners[3] - temperature) / (corners[3] - corners[2])
    return min(max(min(warm_enough, cool_enough), 0.0), 1.0)


@inlined
def cell_power_limits(
    battery: Battery, voltage: float, resistance: float, state_of_charge: float, discharging: float, charging: float
) -> tuple[float, float]:
    """Largest power out of and into the battery [W], by the limits of current and by those of power.

    `voltage` [V] behind the resistance [ohm] of the string; nothing out of an empty one, nothing into a full one.
    `discharging` and `charging` are the shares of the currents that the temperature leaves [1].
    """
    out = min(battery.cells.discharge_current * discharging, voltage / (2.0 * resistance))
    into = battery.cells.charge_current * charging
    give = min((voltage - resistance * out) * out, battery.discharge_power)
    take = min((voltage + resistance * into) * into, battery.charge_power)
    return give if state_of_charge > 0.0 else 0.0, take if state_of_charge < 1.0 else 0.0
