"""The brushless DC motor of Shchur (2019): a star of three phases with trapezoidal EMF."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.parameters.declaration import parameter


@dataclass(frozen=True, slots=True)
class MotorParameters:
    """Motor with permanent magnets; without iron losses, friction or saturation, of which the source says nothing."""

    pole_pairs: int = parameter(10, unit="1", low=1, high=100, about="pole pairs, p", source="Shchur 2019")
    resistance: float = parameter(
        0.15, unit="ohm", low=0.0, high=100.0, about="resistance of one phase, R", source="Shchur 2019"
    )
    inductance: float = parameter(
        0.008,
        unit="H",
        low=1e-6,
        high=1.0,
        about="inductance of one phase less its mutual inductance to another, L (taken for the source's 8 mH)",
        source="Shchur 2019",
    )
    flux_linkage: float = parameter(
        0.2,
        unit="Wb",
        low=1e-4,
        high=10.0,
        about="flux linkage of a pole pair with one phase, psi: on its flats the EMF of a phase is p psi omega",
        source="Shchur 2019",
    )
    torque_limit: float = parameter(
        500.0,
        unit="N m",
        low=0.0,
        high=1e5,
        about="magnitude at the shaft that the torque reference is limited to; assumed, far above what the paper needs",
    )


@compilable
def torque_constant(motor: MotorParameters) -> float:
    """Torque of two conducting phases over their current, and their EMF over the shaft speed: 2 p psi [N m/A, V s]."""
    return 2.0 * motor.pole_pairs * motor.flux_linkage


@compilable
def limited_reference(motor: MotorParameters, torque_reference: float) -> float:
    """The torque reference at the shaft within the torque limit [N m]."""
    return min(max(torque_reference, -motor.torque_limit), motor.torque_limit)
