"""Launches of the dissertation's car with traction controls.

Noise of the sensors, 5 ms, straight ahead.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from helpers.traction import PERIOD

from ev_stack.recording.offline import run_offline
from ev_stack.scenarios.scenario import Overrides, load_scenario

SURFACE_NAMES = ("ice", "packed_snow_1", "wet_asphalt_1", "dry_asphalt")
HELD_SURFACES = ("packed_snow_1", "wet_asphalt_1")  # a slip of 0.1 can be held there, and matters
PEAK_SLIP = {"wet_asphalt_1": 0.1308, "packed_snow_1": 0.0907}
NOISE = (
    ("plant", "sensors.wheel_speed.noise", 0.03),  # rad/s
    ("plant", "sensors.wheel_torque.noise", 0.5),  # N m
)
Channels = dict[str, np.ndarray]


@cache
def driven(duration: float, *values: tuple) -> Channels:
    """Channels of the launch with these values of nodes' parameters."""
    every = [("*", "control_period", PERIOD), *values]
    run = load_scenario("launch_split_mu", Overrides((), every, duration)).runs[0]
    return run_offline(run.configurations, run.duration).channels


def launch(
    method: str,
    surfaces: tuple[str, ...],
    torque: float,
    ramp: float,
    duration: float,
    lengths=(),
    more=(),
) -> Channels:
    """Channels of a launch with a drive torque that rises from 0.5 s on."""
    return driven(
        duration,
        ("plant", "road.left", surfaces),
        ("plant", "road.right", surfaces),
        *(
            (("plant", "road.pattern", "segments"), ("plant", "road.length", lengths))
            if lengths
            else ()
        ),
        ("driver", "pedals.time", (0.0, 0.5, 0.5 + ramp)),
        ("driver", "pedals.drive_torque", (0.0, 0.0, torque)),
        ("driver", "pedals.brake_torque", (0.0, 0.0, 0.0)),
        ("asr", "method", method),
        *NOISE,
        *more,
    )


def full_throttle(method: str, surface: str) -> Channels:
    """3000 N m within a second.

    More than any of these roads carries but dry asphalt, and nearly that.
    """
    return launch(method, (surface,), 3000.0, 1.0, 5.0)


def pulled_away(observer: str) -> Channels:
    """pi_slip with a slip observer on packed snow; noise of the wheel speeds only."""
    return driven(
        6.0,
        ("plant", "road.left", ("packed_snow_1",)),
        ("plant", "road.right", ("packed_snow_1",)),
        NOISE[0],
        ("driver", "pedals.time", (0.0, 0.5, 1.5)),
        ("driver", "pedals.drive_torque", (0.0, 0.0, 3000.0)),
        ("driver", "pedals.brake_torque", (0.0, 0.0, 0.0)),
        ("asr", "method", "pi_slip"),
        ("asr", "regulator.slip.observer", observer),
    )


def slip_of(channels: Channels, wheel: str = "front_left") -> np.ndarray:
    return channels[f"tire_forces.slip_ratio.{wheel}"]


def friction_use(channels: Channels, wheel: str) -> np.ndarray:
    """Longitudinal force over what the road could carry [1]."""
    carried = (
        channels[f"tire_forces.load.{wheel}"]
        * channels[f"tire_forces.friction_coefficient.{wheel}"]
    )
    return channels[f"tire_forces.longitudinal_force.{wheel}"] / carried


def is_limited(channels: Channels, wheel: str) -> np.ndarray:
    return channels[f"torque_command.drive.{wheel}"] < channels[f"torque_request.drive.{wheel}"]
