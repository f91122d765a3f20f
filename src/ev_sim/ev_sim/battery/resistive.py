"""A battery as a voltage source over the state of charge, behind one resistance."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import sqrt
from ev_msgs_py.vehicle.battery import Battery


@inlined
def open_circuit_voltage(table: tuple[float, ...], state_of_charge: float) -> float:
    """Voltage without current [V], linear in a table at equally spaced states of charge from 0 to 1."""
    last = len(table) - 1
    place = min(max(state_of_charge, 0.0), 1.0) * last
    index = min(int(place), last - 1)
    return table[index] + (place - index) * (table[index + 1] - table[index])


@inlined
def current_at_power(voltage: float, resistance: float, power: float) -> float:
    """Current [A] that gives a power [W] at the terminals, both positive out of the battery.

    I = (E - sqrt(E^2 - 4 R P)) / (2 R), the solution of (E - R I) I = P on the efficient side. A power above
    E^2/(4 R), which no current gives, gets the current of the largest power.
    """
    return (voltage - sqrt(max(voltage * voltage - 4.0 * resistance * power, 0.0))) / (2.0 * resistance)


@inlined
def power_limits(battery: Battery, voltage: float, state_of_charge: float) -> tuple[float, float]:
    """Largest power out of and into the battery [W]; nothing out of an empty one, nothing into a full one."""
    most = min(battery.discharge_power, voltage * voltage / (4.0 * battery.resistance))
    give = most if state_of_charge > 0.0 else 0.0
    take = battery.charge_power if state_of_charge < 1.0 else 0.0
    return give, take
