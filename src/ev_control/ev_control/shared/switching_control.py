"""Switching control with a boundary layer, which changes a wheel's torque until its slip is right (Ge & Ni 2005)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import compilable, copysign, parameter, setting


@compilable
def slip_ratio(wheel_speed: float, ground_speed: float, slowest: float) -> float:
    """Slip ratio [1], positive in traction: (w R - V)/(w R) driving, (w R - V)/V braking (Ge & Ni 2005).

    `wheel_speed` is w R and `ground_speed` the velocity V of the wheel's centre along the wheel [m/s]; the divisor is
    the larger of both magnitudes, and at least `slowest` [m/s], above zero, so that a car at rest has no slip.
    """
    return (wheel_speed - ground_speed) / max(abs(wheel_speed), abs(ground_speed), slowest)


READINGS = ("rate", "offset", "increment")
RATE, OFFSET, INCREMENT = range(len(READINGS))


@dataclass(frozen=True, slots=True)
class SwitchingControlParameters:
    """Gains and boundary layer, and what the control changes, which the source's damaged scan leaves open."""

    reading: str = parameter(
        "rate",
        choices=READINGS,
        about="what the switching control changes: the torque per second (rate), the torque itself (offset), or the "
        "torque per control period (increment)",
        source="Ge & Ni 2005; the scan leaves it open",
    )
    k_inner: float = parameter(
        50.0,
        unit="N m",
        low=0.0,
        high=10000.0,
        about="switching gain of the inner wheel, k_L of a left turn, and of both straight ahead; for the reading rate "
        "per second",
        source="Ge & Ni 2005",
    )
    k_outer: float = parameter(
        100.0,
        unit="N m",
        low=0.0,
        high=10000.0,
        about="switching gain of the outer wheel, k_R of a left turn; for the reading rate per second",
        source="Ge & Ni 2005",
    )
    boundary_layer: bool = setting(True, about="whether the control is linear within the boundary layer")
    layer_width: float = parameter(
        0.001, unit="1", low=1e-6, high=1.0, about="half width of the boundary layer, phi", source="Ge & Ni 2005"
    )
    largest_correction: float = parameter(
        0.5,
        unit="1",
        low=0.0,
        high=1.0,
        about="limit of each wheel's change of torque over its equal share, so that no torque comes without the pedal",
    )


@compilable
def corrected(
    p: SwitchingControlParameters, period: float, correction: float, outer: bool, error: float, limit: float
) -> float:
    """The next correction c of a wheel [N m] by its slip error D [1], within the limit [N m].

    s = k sat(D/phi), or k sgn(D) without boundary layer: dc/dt = s (reading rate), c = s (offset), or c grows by s in
    each control period (increment). Ge & Ni (2005), whose printed k = D/phi drops the gain.
    """
    gain = p.k_outer if outer else p.k_inner
    if p.boundary_layer == 1.0:
        switched = min(max(error / p.layer_width, -1.0), 1.0)
    else:
        switched = copysign(1.0, error) if error != 0.0 else 0.0
    change = gain * (period if p.reading == RATE else 1.0) * switched
    return min(max(change if p.reading == OFFSET else correction + change, -limit), limit)
