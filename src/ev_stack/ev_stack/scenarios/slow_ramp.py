"""The slow ramp by which the steering angles of a scenario fit another car than its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ev_core.lockstep.configuration import Configuration
from ev_core.parameters.declaration import parameter, setting
from ev_msgs_py.contract.roles import MASTER

COLUMN, ROBOT, SCALE = "steering_column", "steering_robot", "scale"
RAMP_READINGS = FITTED_LINE, AT_CROSSING = ("line", "crossing")
_REAR = "rear_steering"
_OF_THE_CAR = ("method", "initial_speed", "vehicle.", "road.", "rear_steering.")
# A longer cycle draws a longer random road, which is no other road for the ramp.
_HOW_A_ROAD_IS_DRAWN = ("road.seed", "road.random_distance")


@dataclass(frozen=True, slots=True)
class SlowRampParameters:
    """Rule for the steering angles of another car: in proportion to a reference angle."""

    lateral_acceleration: float = setting(
        0.0,
        unit="m/s^2",
        low=0.0,
        high=20.0,
        about="at which the angle is read, at the initial speed; 0: no ramp",
    )
    reference_angle: float = setting(
        1.0,
        unit="rad",
        low=1e-3,
        high=30.0,
        about="of the steering wheel at this acceleration, of the file's own car",
    )
    run: str = setting(
        "", about="run of the scenario that is such a ramp itself and keeps its angles"
    )
    rate: float = parameter(
        0.2356,
        unit="rad/s",
        low=1e-3,
        high=1.0,
        about="of the steering wheel, 13.5 deg/s",
        source="FMVSS 126, S7.6",
    )
    read: str = setting(
        FITTED_LINE,
        choices=RAMP_READINGS,
        about="from the line of FMVSS 126, S7.6, or where the acceleration is reached",
    )


def car_of(configurations: Mapping[str, Configuration]) -> dict[str, Any]:
    """All that steering angles depend on, by name: the car, its road, its speed."""
    values = configurations[MASTER].values()
    if _REAR in configurations:
        rear = configurations[_REAR].values()
        # A steered rear axle changes how far the front wheels have to turn.
        values |= {f"{_REAR}.{name}": value for name, value in rear.items()}
    found = {}
    for name, value in values.items():
        if name.startswith(_OF_THE_CAR) and name not in _HOW_A_ROAD_IS_DRAWN:
            found[name] = value
    return found
