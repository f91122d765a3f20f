"""The driveline of a vehicle."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.parameters.declaration import parameter


@dataclass(frozen=True, slots=True)
class Driveline:
    """How the drive torque of an axle reaches its wheels."""

    coupling: str = parameter(
        "individual",
        choices=("individual", "open", "limited_slip", "clutch"),
        about="individual: a motor for each driven wheel; open, limited_slip: a motor for each driven axle, with a "
        "differential; clutch: one motor, whose torque clutches share out as commanded",
    )
    preload: float = parameter(
        50.0, unit="N m", low=0.0, high=1e4, about="locking torque of the limited-slip differential at no drive torque"
    )
    locking_ratio: float = parameter(
        0.3, unit="1", low=0.0, high=1.0, about="locking torque over drive torque of the limited-slip differential"
    )
    locking_speed: float = parameter(
        1.0, unit="rad/s", low=0.1, high=100.0, about="speed difference at which 76 % of the locking torque acts"
    )
    clutch_lag: float = parameter(
        0.1, unit="s", low=1e-3, high=10.0, about="time constant of the torque shares", source="Zhileykin 2018"
    )
