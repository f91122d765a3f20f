"""Bench beside virtual run: what makes a bench ideal, what the page's devices are, and how far two runs are apart."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ev_papers.dissertation.measures.traction_windows import in_windows
from ev_papers.dissertation.measures.urban_cases import Values
from ev_sim.measures.metric import NotMeasured
from ev_sim.recording.recording import Recording
from ev_sim.scenarios.scenario import Run

WHEEL = "front_right"
SAMPLING = 0.005  # s between the samples that are compared, as far as the control period divides it
_STIFF, _NO_LIMIT = 1e7, 1e9
_SENSORS = ("bench_torque", "bench_speed", "bench_load_speed", "bench_voltage", "bench_current", "bench_temperature")


def _bench(**values: float) -> Values:
    return tuple(("test_bench", name.replace("__", "."), value) for name, value in values.items())


# By what may differ from the virtual run; with all of them ideal nothing is left but the exchange by control periods.
IDEAL: Mapping[str, Values] = {
    "inverters": _bench(
        set_point__delay=0.0,
        set_point__torque_rate=_NO_LIMIT,
        set_point__torque_resolution=0.0,
        load_set_point__delay=0.0,
        load_set_point__speed_rate=_NO_LIMIT,
        load_set_point__speed_resolution=0.0,
    ),
    "load machine": (("plant", "wheel_speed", "virtual"),),  # it turns exactly as it is told
    "shaft": _bench(shaft__stiffness=_STIFF),
    "sensors": tuple(("test_bench", f"sensors.{name}.noise", 0.0) for name in _SENSORS),
}


def ideal(but: str = "") -> Values:
    """An ideal bench, but for one group that stays as the scenario has it."""
    return tuple(value for group, values in IDEAL.items() if group != but for value in values)


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Of the right circuit: torque at the shaft [N m], with the rotor and as a transducer shows it, and wheel speed.

    All of it at the `instants` [s]. NotMeasured if the run ends before the first traction window.
    """
    every = max(round(SAMPLING / run.configurations["plant"].common.control_period), 1)
    channels = recording.channels
    torque = channels[f"motor_states.effort.{WHEEL}"]
    shown = channels.get(f"bench.shafts.torque.{WHEEL}", torque)
    in_traction = in_windows(recording, run.configurations["driver"].values())
    if not in_traction.any():
        raise NotMeasured("the run has no traction window")
    return {
        "instants": recording.time[::every].copy(),
        "torque": torque[::every].copy(),
        "transducer": shown[::every].copy(),
        "speed": channels[f"wheel_states.velocity.{WHEEL}"][::every].copy(),
        "pressed": channels["driver.command.drive_torque"][::every] > 0.0,
        "in_traction": in_traction[::every].copy(),
        "distance": float(channels["pose.x"][-1]),
    }


def away_from_switches(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Samples, True where for two samples before and behind both drivers' feet stay and are alike."""
    count = min(len(one), len(other))
    feet = np.stack([one[:count], other[:count]])
    moves = np.diff(feet, axis=1, prepend=feet[:, :1]).any(axis=0) | (feet[0] != feet[1])
    return np.convolve(moves, np.ones(5), "same") == 0.0


def apart(one: np.ndarray, other: np.ndarray, counted: np.ndarray | None = None) -> float:
    """Mean difference of two series over the largest magnitude of the second [%]."""
    count = min(len(one), len(other))
    difference = np.abs(one[:count] - other[:count])
    largest = float(np.abs(other).max())
    mean = float((difference if counted is None else difference[counted[:count]]).mean())
    return 100.0 * mean / largest if largest > 0.0 else 0.0
