"""Faults by name, as parameters put them into an inverter."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from types import MappingProxyType

from ev_sim.inverter.state import Injected

# Entry of `Injected` and the value that makes a fault of it, with the thresholds of the default parameters.
INJECTIONS = MappingProxyType(
    {
        "trip": ("trip", 1.0),
        "dc_link_loss": ("supply_lost", 1.0),
        "hot_winding": ("winding_rise", 120.0),
        "hot_inverter": ("inverter_rise", 80.0),
        "over_voltage": ("voltage_rise", 200.0),
        "over_current": ("current_rise", 700.0),
        "silent": ("silent", 1.0),
        "wrong_crc": ("wrong_crc", 1.0),
        "frozen_counter": ("frozen_counter", 1.0),
    }
)


def inject(s: Injected, names: Iterable[str]) -> None:
    """Put these faults in, and take all others away."""
    for field in fields(s):
        setattr(s, field.name, 0.0)
    for name in names:
        entry, value = INJECTIONS[name]
        setattr(s, entry, value)
