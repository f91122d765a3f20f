"""Every traction control on every road: pulling away, split friction, jumps of friction, a hill."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ev_msgs_py.lockstep.methods import methods_of, node_package
from ev_sim.report.figures.panels import Curve, Panel
from ev_sim.report.metric import Metric, metric
from ev_sim.report.quantities.motion import distance_on_path, heading
from ev_sim.report.samples import channel
from ev_sim.report.text_table import text_table
from ev_sim.run.recording.recording import Recording
from ev_sim.run.scenarios.scenario import Run
from ev_sim.study.asr_situations import SITUATIONS
from ev_sim.study.case import Case
from ev_sim.study.study import Results

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ABOUT = "All traction controls pulling away on ice, snow, wet and dry roads, split friction, jumps of friction, a hill"
SCENARIO, RUN = "launch_split_mu", "steered"
DURATION, PERIOD = 8.0, 0.005  # [s]
NOISE = {"wheel_speed": 0.03, "wheel_torque": 0.5, "imu_acceleration": 0.05, "imu_yaw_rate": 0.002}
REACHED = 30 / 3.6  # [m/s]
SERVED = 0.9  # of the request [1], from which on the torque counts as back
GRIP, GRIP_TIME = 0.8, 0.5  # friction in use below which for so long nothing had to be limited [1, s]
RIPPLE_WINDOW = 0.1  # [s]
TRACE_STEP = 0.02  # [s]
TRACED = ("snow", "wet", "snow, then dry", "dry, then ice")
DRAWN = ("off", "least_squares", "slip_window", "pi_slip")

QUANTITIES = {  # what is measured -> heading of its column and digits
    "time_to_30": ("to 30 km/h [s]", 2),
    "distance": ("distance [m]", 1),
    "peak_slip": ("peak slip", 2),
    "mean_slip": ("mean slip", 3),
    "slip_energy": ("slip energy [kJ]", 1),
    "heading_deviation": ("heading [deg]", 1),
    "torque_ripple": ("ripple [N m]", 1),
    "false_triggers": ("false triggers", 0),
    "recovery": ("torque back after [s]", 2),
}
COLUMNS = ("road", "asr", *(heading_ for heading_, _ in QUANTITIES.values()))
SUMS = ("distance_", "mean_slip_", "slip_energy_", "false_triggers_")


def controls() -> list[str]:
    """All traction controls of the package that brings the node, none first."""
    names = [name for name, method in methods_of("asr").items() if method.package == node_package("asr")]
    return sorted(names, key=lambda name: (name != "off", name))


def add_options(parser: argparse.ArgumentParser) -> None:
    """A part of the controls and roads instead of all."""
    parser.add_argument("--controls", nargs="+", choices=controls(), metavar="ASR", help="these only; default: all")
    parser.add_argument("--roads", nargs="+", choices=list(SITUATIONS), metavar="ROAD", help="these only; default: all")


def _chosen(given: argparse.Namespace) -> tuple[list[str], list[str]]:
    """Roads and controls of the study."""
    return getattr(given, "roads", None) or list(SITUATIONS), getattr(given, "controls", None) or controls()


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every control on every road."""
    common = (
        ("*", "control_period", PERIOD),
        *(("plant", f"sensors.{sensor}.noise", deviation) for sensor, deviation in NOISE.items()),
    )
    roads, names = _chosen(given)
    return [
        Case(
            name_of(road, control),
            SCENARIO,
            (*common, *SITUATIONS[road].values(), ("asr", "method", control)),
            RUN,
            duration=DURATION,
        )
        for road in roads
        for control in names
    ]


def name_of(road: str, control: str) -> str:
    """Name of a case."""
    return f"{road}: {control}"


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


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """For each control the sums over all roads."""
    roads, names = _chosen(given)

    def all_of(control: str, quantity: str) -> list[float]:
        found = (results[name_of(road, control)].measured.get(quantity) for road in roads)
        return [math.nan if value is None else value for value in found]

    summed = {}
    for name in names:
        summed[f"distance_{name}"] = metric(lambda n=name: sum(all_of(n, "distance")), "m")
        summed[f"mean_slip_{name}"] = metric(lambda n=name: np.mean(all_of(n, "mean_slip")), "1")
        summed[f"slip_energy_{name}"] = metric(lambda n=name: sum(all_of(n, "slip_energy")) * 1e3, "J")
        summed[f"false_triggers_{name}"] = metric(lambda n=name: sum(all_of(n, "false_triggers")), "1")
    return summed


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Road, control and what was measured; a dash where 30 km/h were not reached."""

    def shown(value: float | None, digits: int) -> str:
        return "–" if value is None else f"{value:.{digits}f}"

    def numbers(of: Mapping[str, Any]) -> tuple[str, ...]:
        return tuple(shown(of.get(key), digits) for key, (_, digits) in QUANTITIES.items())

    return [(*name.split(": "), *numbers(result.measured)) for name, result in results.items()]


def tables(given: argparse.Namespace, results: Results) -> str:
    """The rows as aligned text."""
    return text_table(COLUMNS, rows(given, results), left=COLUMNS[:2])


def figures(given: argparse.Namespace, results: Results) -> dict[str, Figure]:
    """The slip of the front left wheel over time on some roads, with some controls."""
    from ev_sim.report.figures.drawing import sheet

    roads, names = _chosen(given)
    panels = []
    for road in [road for road in TRACED if road in roads] or roads[:1]:
        drawn = [results[name_of(road, name)] for name in DRAWN if name in names]
        curves = [
            Curve(result.measured["trace_time"], result.measured["trace_slip"], result.name.partition(": ")[2])
            for result in drawn
            if result.measured
        ]
        panels.append(Panel(f"{road}: slip of the front left wheel", "1", tuple(curves)))
    return {"slip": sheet(panels, "time [s]")}
