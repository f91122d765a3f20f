"""The winding of a motor: what the voltage of the DC link leaves of its torque."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.parameters.declaration import parameter

_YASA = "assumption for a YASA-400, whose curves (figure 1.22 of the dissertation) are lost"


@dataclass(frozen=True, slots=True)
class Winding:
    """A synchronous machine with magnets on the surface of its rotor: one inductance in both axes.

    Its resistance is not told twice: the motor's `copper_loss` and the torque constant 3/2 p psi give it.
    """

    pole_pairs: int = parameter(10, unit="1", low=1, high=100, about="pole pairs, p", source=_YASA)
    flux_linkage: float = parameter(
        0.0377,
        unit="Wb",
        low=1e-4,
        high=10.0,
        about="peak flux linkage of the magnets with a phase, psi: 0.8 N m for each rms ampere",
        source=_YASA,
    )
    inductance: float = parameter(
        1e-4, unit="H", low=1e-6, high=1.0, about="of a phase, alike in both axes, L", source=_YASA
    )
    largest_current: float = parameter(
        453.0, unit="A", low=1.0, high=1e4, about="rms phase current, what 360 N m need", source=_YASA
    )
    voltage_share: float = parameter(
        0.95,
        unit="1",
        low=0.1,
        high=1.0,
        about="of the largest phase voltage, V_dc/sqrt(3), that field weakening makes use of; the rest is left to the "
        "resistance of the winding and to the current control",
        source="assumption",
    )
