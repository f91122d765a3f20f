"""What is measured of one traction control on one road, by the true slips and forces of the driven wheels."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ev_sim.report.quantities.motion import distance_on_path, heading
from ev_sim.report.samples import channel
from ev_sim.running.recording.recording import Recording
from ev_sim.running.scenarios.scenario import Run

PERIOD = 0.005  # of control, with which the runs are driven [s]
REACHED = 30 / 3.6  # [m/s]
SERVED = 0.9  # of the request [1], from which on the torque counts as back
GRIP, GRIP_TIME = 0.8, 0.5  # friction in use below which for so long nothing had to be limited [1, s]
RIPPLE_WINDOW = 0.1  # [s]
TRACE_STEP = 0.02  # [s]


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """The quantities of the table, by the true slips and forces, and the slip of the front left wheel over time."""
    time, speed = recording.time, channel(recording, "twist.longitudinal")
    fast = np.flatnonzero(speed >= REACHED)
    vehicle = run.configurations["asr"].common.vehicle
    wheels = [_wheel(recording, name, vehicle.wheel_radius) for name in vehicle.driven_wheels]
    step = round(TRACE_STEP / PERIOD)
    slips = np.array([wheel["slip"] for wheel in wheels])
    asked = slips[:, time >= 0.5]
    return {
        "time_to_30": float(time[fast[0]]) if len(fast) else None,
        "distance": float(distance_on_path(recording)[-1]),
        "peak_slip": float(asked.max()),
        "mean_slip": float(asked.mean()),
        "slip_energy": float(sum(wheel["energy"] for wheel in wheels)) / 1e3,
        "heading_deviation": math.degrees(float(np.abs(heading(recording)).max())),
        "torque_ripple": float(np.mean([wheel["ripple"] for wheel in wheels])),
        "false_triggers": int(sum(wheel["false_triggers"] for wheel in wheels)),
        "recovery": _recovery(recording, vehicle.driven_wheels),
        "trace_time": time[::step],
        "trace_slip": slips[0, ::step],
    }


def _wheel(recording: Recording, name: str, radius: float) -> dict[str, Any]:
    """What is measured of one driven wheel: energy [J], ripple [N m], false triggers, and its slip over time."""
    force, slip = (channel(recording, f"tire_forces.{of}.{name}") for of in ("longitudinal_force", "slip_ratio"))
    load, friction = (channel(recording, f"tire_forces.{of}.{name}") for of in ("load", "friction_coefficient"))
    command = channel(recording, f"torque_command.drive.{name}")
    tread = radius * channel(recording, f"wheel_states.velocity.{name}")
    limited = command < channel(recording, f"torque_request.drive.{name}")
    begins = np.flatnonzero(limited[1:] & ~limited[:-1]) + 1
    use = np.abs(force) / np.maximum(load * friction, 1.0)
    before = round(GRIP_TIME / PERIOD)
    window = round(RIPPLE_WINDOW / PERIOD)
    smooth = np.convolve(command, np.full(window, 1 / window), "same")[window:-window]
    return {
        "slip": slip,
        "energy": float(np.sum(np.maximum(force * slip * tread, 0.0)) * PERIOD),
        "ripple": float(np.sqrt(np.mean((command[window:-window] - smooth) ** 2))),
        "false_triggers": sum(float(use[max(i - before, 0) : i + 1].max()) < GRIP for i in begins),
    }


def _recovery(recording: Recording, wheels: Sequence[str]) -> float | None:
    """From where the friction has risen under a wheel until it gets most of its request, the longest time [s]."""
    times = []
    for name in wheels:
        rises = np.flatnonzero(np.diff(channel(recording, f"tire_forces.friction_coefficient.{name}")) > 0.0)
        if len(rises):
            least = SERVED * channel(recording, f"torque_request.drive.{name}")
            back = np.flatnonzero((channel(recording, f"torque_command.drive.{name}") >= least)[rises[-1] + 1 :])
            times.append(float(back[0]) * PERIOD if len(back) else math.inf)
    return max(times) if times and max(times) < math.inf else None
