"""How much a wheel has gained on the car, by accelerations alone: what a gripping tyre needs is no slip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ev_control.shared.wheel_dynamics import WheelMotion
from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.parameters.declaration import parameter
from ev_msgs_py.vehicle.car import Car


@dataclass(frozen=True, slots=True)
class GainedSpeedParameters:
    """What a tyre that grips may gain: its slip, and the winding up of its carcass."""

    grip_slip: float = parameter(
        0.07,
        unit="1",
        low=0.0,
        high=0.5,
        about="share of its speed that a wheel may gain on the car while its tyre grips; dry asphalt carries half of "
        "the load at a slip of 0.03",
        source="assumption",
    )
    least_gain: float = parameter(
        0.3,
        unit="rad/s",
        low=0.0,
        high=100.0,
        about="what it may gain at any speed: noise, and a carcass that winds up at rest",
        source="assumption",
    )
    memory: float = parameter(
        1.0,
        unit="s",
        low=0.01,
        high=100.0,
        about="time constant with which the gained speed is forgotten, so that no offset adds up",
        source="assumption",
    )


@compilable
def has_gained(p: Any, car: Car, w: Any, period: float, motion: WheelMotion) -> bool:
    """Whether a wheel has gained more on the car than a tyre that grips; `w.gained` is what it has [rad/s]."""
    gain = motion.acceleration - motion.body_acceleration / car.wheel_radius
    w.gained = max(w.gained + gain * period, 0.0) * p.memory / (p.memory + period)
    gained: bool = w.gained > max(p.grip_slip * motion.speed, p.least_gain)
    return gained
