"""Numbers with a unit as people write them, "80 km/h", made into the unit in which a parameter is declared.

A list and no algebra of units: what is accepted can be read here, and stands in what a refusal says.
"""

from __future__ import annotations

import math
import re

# By declared unit, what may be written instead: a number is multiplied by the first and divided by the second.
_TURN, _KILO = 2.0 * math.pi, (1e3, 1.0)
ACCEPTED: dict[str, dict[str, tuple[float, float]]] = {
    "1": {"%": (1.0, 100.0)},
    "m": {"mm": (1.0, 1e3), "cm": (1.0, 100.0), "km": _KILO},
    "m^2": {"cm^2": (1.0, 1e4)},
    "m/s": {"km/h": (1.0, 3.6), "mph": (0.44704, 1.0)},
    "s": {"ms": (1.0, 1e3), "min": (60.0, 1.0), "h": (3600.0, 1.0)},
    "kg": {"t": _KILO, "g": (1.0, 1e3)},
    "rad": {"deg": (math.pi, 180.0)},
    "rad/s": {"deg/s": (math.pi, 180.0), "rpm": (_TURN, 60.0), "1/min": (_TURN, 60.0)},
    "N": {"kN": _KILO},
    "N m": {"Nm": (1.0, 1.0), "kN m": _KILO, "kNm": _KILO},
    "N/m": {"kN/m": _KILO, "N/mm": _KILO},
    "N/rad": {"kN/rad": _KILO, "N/deg": (180.0, math.pi), "kN/deg": (180e3, math.pi)},
    "W": {"kW": _KILO, "MW": (1e6, 1.0)},
    "J": {"kJ": _KILO, "Wh": (3600.0, 1.0), "kWh": (3.6e6, 1.0)},
    "A h": {"Ah": (1.0, 1.0)},
    "V": {"kV": _KILO},
    "ohm": {"mohm": (1.0, 1e3)},
    "Hz": {"kHz": _KILO},
}
_FORM = re.compile(r"\s*(?P<number>[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?)\s*(?P<unit>\S.*?)\s*")


def units_for(unit: str) -> tuple[str, ...]:
    """The units in which a parameter of a declared unit may be written; none for texts and such."""
    return (*((unit,) if unit not in ("", "1") else ()), *ACCEPTED.get(unit, ()))


def number_of(text: str, unit: str) -> float | None:
    """The number in the declared unit, or None if the text is no number with a unit that is accepted for it."""
    found = _FORM.fullmatch(text)
    if found is None or found["unit"] not in units_for(unit):
        return None
    multiplier, divisor = ACCEPTED.get(unit, {}).get(found["unit"], (1.0, 1.0))
    return float(found["number"]) * multiplier / divisor
