"""What is measured of one traction control on one road, by the true slips and forces of the driven wheels."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ev_msgs_py.elementary import hypot
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.driver.path import nearest, path_of, point_at
from ev_sim.report.quantities.motion import distance_on_path, heading
from ev_sim.report.samples import channel
from ev_sim.running.recording.recording import Recording
from ev_sim.running.scenarios.scenario import Run

SET_POINT = "speed_command.speed."
PERIOD = 0.005  # of control, with which the runs are driven [s]
REACHED = 30 / 3.6  # [m/s]
SERVED = 0.9  # of the request [1], from which on the torque counts as back
GRIP, GRIP_TIME = 0.8, 0.5  # friction in use below which for so long nothing had to be limited [1, s]
RIPPLE_WINDOW = 0.1  # [s]
TRACE_STEP = 0.02  # [s]
PATH_STEP = 10  # samples between two that are compared with the path


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """The quantities of the table, by the true slips and forces, and the slip of the front left wheel over time."""
    time, speed = recording.time, channel(recording, "twist.longitudinal")
    fast = np.flatnonzero(speed >= REACHED)
    vehicle = run.configurations["asr"].common.vehicle
    wheels = [_wheel(recording, name, vehicle) for name in vehicle.driven_wheels]
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
        "off_the_path": _farthest(recording, run),
        "torque_ripple": float(np.mean([wheel["ripple"] for wheel in wheels])),
        "false_triggers": int(sum(wheel["false_triggers"] for wheel in wheels)),
        "recovery": _recovery(recording, vehicle),
        "trace_time": time[::step],
        "trace_slip": slips[0, ::step],
    }


def _given(recording: Recording, name: str, vehicle: Vehicle) -> tuple[np.ndarray, np.ndarray]:
    """The torque that the control lets a wheel have [N m], and where it limits it; of a drive in speed mode its own."""
    command = channel(recording, f"torque_command.drive.{name}")
    if SET_POINT + name not in recording.channels:
        return command, command < channel(recording, f"torque_request.drive.{name}")
    in_reach = channel(recording, SET_POINT + name) < vehicle.motor.maximum_speed / vehicle.gear_ratio
    return channel(recording, f"wheel_states.effort.{name}") / vehicle.motor.gear_efficiency, in_reach


def _farthest(recording: Recording, run: Run) -> float:
    """The largest distance of the centre of mass from the driver's path [m]."""
    path, leg, farthest = path_of(run.configurations["driver"].parameters.path), 0, 0.0
    x, y = channel(recording, "pose.x")[::PATH_STEP].tolist(), channel(recording, "pose.y")[::PATH_STEP].tolist()
    for at_x, at_y in zip(x, y, strict=True):
        distance, leg = nearest(path, at_x, at_y, leg)
        on_x, on_y = point_at(path, distance, leg)
        farthest = max(farthest, hypot(at_x - on_x, at_y - on_y))
    return farthest


def _wheel(recording: Recording, name: str, vehicle: Vehicle) -> dict[str, Any]:
    """What is measured of one driven wheel: energy [J], ripple [N m], false triggers, and its slip over time."""
    force, slip = (channel(recording, f"tire_forces.{of}.{name}") for of in ("longitudinal_force", "slip_ratio"))
    load, friction = (channel(recording, f"tire_forces.{of}.{name}") for of in ("load", "friction_coefficient"))
    given, limited = _given(recording, name, vehicle)
    tread = vehicle.wheel_radius * channel(recording, f"wheel_states.velocity.{name}")
    begins = np.flatnonzero(limited[1:] & ~limited[:-1]) + 1
    use = np.abs(force) / np.maximum(load * friction, 1.0)
    before = round(GRIP_TIME / PERIOD)
    window = round(RIPPLE_WINDOW / PERIOD)
    smooth = np.convolve(given, np.full(window, 1 / window), "same")[window:-window]
    return {
        "slip": slip,
        "energy": float(np.sum(np.maximum(force * slip * tread, 0.0)) * PERIOD),
        "ripple": float(np.sqrt(np.mean((given[window:-window] - smooth) ** 2))),
        "false_triggers": sum(float(use[max(i - before, 0) : i + 1].max()) < GRIP for i in begins),
    }


def _recovery(recording: Recording, vehicle: Vehicle) -> float | None:
    """From where the friction has risen under a wheel until it gets most of its request, the longest time [s]."""
    times = []
    for name in vehicle.driven_wheels:
        rises = np.flatnonzero(np.diff(channel(recording, f"tire_forces.friction_coefficient.{name}")) > 0.0)
        if len(rises):
            least = SERVED * channel(recording, f"torque_request.drive.{name}")
            back = np.flatnonzero((_given(recording, name, vehicle)[0] >= least)[rises[-1] + 1 :])
            times.append(float(back[0]) * PERIOD if len(back) else math.inf)
    return max(times) if times and max(times) < math.inf else None
