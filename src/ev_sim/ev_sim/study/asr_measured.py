"""What is measured of one traction control on one road, by the true slips and forces of the driven wheels."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ev_core.elementary import hypot
from ev_core.vehicle.description import Vehicle
from ev_sim.driver.path import nearest, path_of, point_at
from ev_sim.measures import motion
from ev_sim.measures.handling import slip_powers
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.motion import distance_on_path, heading
from ev_sim.measures.samples import channel
from ev_sim.recording.recording import Recording
from ev_sim.scenarios.scenario import Run

SET_POINT = "speed_command.speed."
PERIOD = 0.005  # of control, with which the runs are driven [s]
ASKED = 0.5  # when the driver begins to pull away [s]
REACHED = 30 / 3.6  # [m/s]
SERVED = 0.9  # of the request [1], from which on the torque counts as back
GRIP, GRIP_TIME = 0.8, 0.5  # friction in use below which for so long nothing had to be limited [1, s]
RIPPLE_WINDOW = 0.1  # [s]
TRACE_STEP = 0.02  # [s]
PATH_STEP = 0.05  # [s], between two samples that are compared with the path


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """The quantities of the table, by the true slips and forces, and the slip of the front left wheel over time.

    None is what a run has no number for, such as one that ends before the driver pulls away.
    """
    time = recording.time
    vehicle = run.configurations["asr"].common.vehicle
    wheels = [_wheel(recording, name, vehicle) for name in vehicle.driven_wheels]
    step = samples_in(TRACE_STEP, recording)
    slips = np.array([wheel["slip"] for wheel in wheels])
    asked = slips[:, time >= ASKED]
    ripples = [wheel["ripple"] for wheel in wheels]
    return {
        "time_to_30": _time_to_30(recording),
        "distance": float(distance_on_path(recording)[-1]),
        "peak_slip": float(asked.max()) if asked.size else None,
        "mean_slip": float(asked.mean()) if asked.size else None,
        "slip_energy": float(sum(wheel["energy"] for wheel in wheels)) / 1e3,
        "heading_deviation": math.degrees(float(np.abs(heading(recording)).max())),
        "off_the_path": _farthest(recording, run),
        "torque_ripple": None if None in ripples else float(np.mean(ripples)),
        "false_triggers": int(sum(wheel["false_triggers"] for wheel in wheels)),
        "recovery": _recovery(recording, vehicle),
        "trace_time": time[::step],
        "trace_slip": slips[0, ::step],
    }


def samples_in(seconds: float, recording: Recording) -> int:
    """How many samples a time takes, one at least."""
    return max(round(seconds * (len(recording.time) - 1) / recording.duration), 1)


def _time_to_30(recording: Recording) -> float | None:
    try:
        return motion.crossing_time(recording.time, motion.speed(recording), REACHED, "30 km/h")
    except NotMeasured:
        return None


def _given(recording: Recording, name: str, vehicle: Vehicle) -> tuple[np.ndarray, np.ndarray]:
    """The torque that the control gives a wheel [N m], and where it limits it; a drive in speed mode has its own."""
    command = channel(recording, f"torque_command.drive.{name}")
    if SET_POINT + name not in recording.channels:
        return command, command < channel(recording, f"torque_request.drive.{name}")
    in_reach = channel(recording, SET_POINT + name) < vehicle.motor.maximum_speed / vehicle.gear_ratio
    return channel(recording, f"wheel_states.effort.{name}") / vehicle.motor.gear_efficiency, in_reach


def _farthest(recording: Recording, run: Run) -> float:
    """The largest distance of the centre of mass from the driver's path [m]."""
    path, leg, farthest = path_of(run.configurations["driver"].parameters.path), 0, 0.0
    step = samples_in(PATH_STEP, recording)
    x, y = (channel(recording, f"pose.{of}")[::step].tolist() for of in ("x", "y"))
    for at_x, at_y in zip(x, y, strict=True):
        distance, leg = nearest(path, at_x, at_y, leg)
        on_x, on_y = point_at(path, distance, leg)
        farthest = max(farthest, hypot(at_x - on_x, at_y - on_y))
    return farthest


def _wheel(recording: Recording, name: str, vehicle: Vehicle) -> dict[str, Any]:
    """What is measured of one driven wheel: energy [J], ripple [N m], false triggers, and its slip over time."""
    time = recording.time
    force, slip = (channel(recording, f"tire_forces.{of}.{name}") for of in ("longitudinal_force", "slip_ratio"))
    load, friction = (channel(recording, f"tire_forces.{of}.{name}") for of in ("load", "friction_coefficient"))
    given, limited = _given(recording, name, vehicle)
    begins = np.flatnonzero(limited[1:] & ~limited[:-1]) + 1
    use = np.abs(force) / np.maximum(load * friction, 1.0)
    before = samples_in(GRIP_TIME, recording)
    return {
        "slip": slip,
        "energy": float(np.trapezoid(np.maximum(slip_powers(recording, vehicle, name)[0], 0.0), time)),
        "ripple": ripple(given, time),
        "false_triggers": sum(float(use[max(i - before, 0) : i + 1].max()) < GRIP for i in begins),
    }


def ripple(values: np.ndarray, time: np.ndarray) -> float | None:
    """Root mean square of values less their mean over RIPPLE_WINDOW around each instant, in their unit."""
    half, middle = RIPPLE_WINDOW / 2, (time[:-1] + time[1:]) / 2  # of a period, in which a command holds
    inner = (middle >= time[0] + half) & (middle <= time[-1] - half)
    if not inner.any():
        return None
    held = np.concatenate(([0.0], np.cumsum(values[:-1] * np.diff(time))))
    before, after = (np.interp(middle[inner] + side * half, time, held) for side in (-1.0, 1.0))
    return float(np.sqrt(np.mean((values[:-1][inner] - (after - before) / RIPPLE_WINDOW) ** 2)))


def _recovery(recording: Recording, vehicle: Vehicle) -> float | None:
    """From where the friction has risen under a wheel until it gets most of its request, the longest time [s]."""
    times = []
    for name in vehicle.driven_wheels:
        rises = np.flatnonzero(np.diff(channel(recording, f"tire_forces.friction_coefficient.{name}")) > 0.0)
        if len(rises):
            least = SERVED * channel(recording, f"torque_request.drive.{name}")
            risen = rises[-1] + 1
            back = np.flatnonzero((_given(recording, name, vehicle)[0] >= least)[risen:])
            times.append(float(recording.time[risen + back[0]] - recording.time[risen]) if len(back) else math.inf)
    return max(times) if times and max(times) < math.inf else None
