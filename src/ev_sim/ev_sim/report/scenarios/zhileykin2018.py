"""Report on Zhileykin & Eranosyan (2018), figs 3 to 5: who spins on the way into a bend on ice with snow.

Runs: `rear_drive` with an open differential, the 4x4 by the law with `k05` and `k1`, `fixed_split` with a half for each
axle, and `k1_estimated`, where the law observes the slip angles instead of knowing them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ev_sim.report.figures.panels import Curve, panel
from ev_sim.report.metric import Metric, Reference, metric
from ev_sim.report.quantities import derived, motion
from ev_sim.report.quantities.handling import peak_sideslip
from ev_sim.report.samples import Runs, channel, run_named
from ev_sim.run.recording.recording import Recording

if TYPE_CHECKING:
    from matplotlib.figure import Figure

REAR_DRIVE = "rear_drive"
BY_LAW = ("k05", "k1", "k1_estimated")
LIMIT = math.radians(15.0)  # sideslip angle that a driver can still correct [rad]; assumed, the source gives none
SWING = 0.005  # [1], least way of a share between two reversals; what moves less is no oscillation
CALM = 1  # reversal of one share that entering the bend explains

ASSUMPTION = "drive force, steering angle, car but for its mass, slopes of the tyre curve"


def metrics(runs: Runs) -> dict[str, Metric]:
    """Peak sideslip angle, whether it is held, speed in the end, and reversals of the shares of the law."""
    result = {}
    for name in runs:
        result[f"peak_sideslip_{name}"] = metric(
            lambda name=name: peak_sideslip(run_named(runs, name)), "rad", _reference(name)
        )
        result[f"holds_{name}"] = metric(lambda name=name: peak_sideslip(run_named(runs, name)) < LIMIT, "1")
        result[f"final_speed_{name}"] = metric(lambda name=name: _speed(run_named(runs, name))[-1], "m/s")
    for name in BY_LAW:
        for share, values in SHARES.items():
            result[f"reversals_{share}_{name}"] = metric(
                lambda name=name, values=values: reversals(values(run_named(runs, name)), SWING),
                "1",
                Reference(0.0, (0.0, CALM), "printed in words: no self-oscillation (fig. 5)", ASSUMPTION),
            )
    return result


def _reference(name: str) -> Reference | None:
    """What the source says about the sideslip angle of a run."""
    if name == REAR_DRIVE:
        return Reference(LIMIT, (LIMIT, math.inf), "printed in words: the rear axle skids (fig. 3)", ASSUMPTION)
    if name in BY_LAW:
        words = "printed in words: the car stays controllable, deviations are small (fig. 4)"
        factor = "" if name == "k05" else "; factor of the law"
        return Reference(LIMIT, (0.0, LIMIT), words, ASSUMPTION + factor)
    return None


def _speed(run: Recording) -> np.ndarray:
    """Along the path, whichever way the spinning car looks, (n,) [m/s]."""
    return np.abs(derived.speed(run))


def reversals(values: np.ndarray, swing: float) -> int:
    """How often a series turns around after a way of more than `swing`, in its unit."""
    count, direction = 0, 0
    low = high = values[0]
    for value in values:
        low, high = min(low, value), max(high, value)
        if direction >= 0 and value < high - swing:
            count, direction, low = count + (direction > 0), -1, value
        elif direction <= 0 and value > low + swing:
            count, direction, high = count + (direction < 0), 1, value
    return count


def _request(run: Recording, wheel: str) -> np.ndarray:
    return channel(run, f"torque_request.drive.{wheel}")


def _front_share(run: Recording) -> np.ndarray:
    front = _request(run, "front_left") + _request(run, "front_right")
    return front / (front + _request(run, "rear_left") + _request(run, "rear_right"))


def _rear_share(side: str) -> Callable[[Recording], np.ndarray]:
    return lambda run: _request(run, f"rear_{side}") / (_request(run, "rear_left") + _request(run, "rear_right"))


# Shares that the law asks for [1]: front axle of all, left and right rear wheel of the rear axle.
SHARES = {"h_n": _front_share, "h_2": _rear_share("left"), "h_4": _rear_share("right")}


def figures(runs: Runs) -> dict[str, Figure]:
    """Paths (figs 3 and 4), shares (fig. 5), sideslip angle, yaw rate and speed."""
    from ev_sim.report.figures.drawing import sheet
    from ev_sim.report.figures.plan_view import plan_view

    shown = {name: run for name, run in runs.items() if name != "k1_estimated"}
    by_law = {name: run for name, run in shown.items() if name in BY_LAW}
    panels = [
        panel(title, "share [1]", lambda values=values: motion.curve_of_each_run(by_law, values))
        for title, values in zip(
            ("a  Front axle, h_n", "b  Rear left, h_2", "c  Rear right, h_4"), SHARES.values(), strict=True
        )
    ]
    panels += [
        panel(
            "Sideslip angle",
            "angle [deg]",
            lambda: motion.curve_of_each_run(shown, lambda run: np.degrees(motion.sideslip_angle(run))),
        ),
        panel(
            "Yaw rate",
            "yaw rate [rad/s]",
            lambda: motion.curve_of_each_run(shown, lambda run: channel(run, motion.YAW_RATE)),
        ),
        panel("Speed", "speed [m/s]", lambda: motion.curve_of_each_run(shown, _speed)),
    ]
    tracks = [Curve(channel(run, "pose.x"), channel(run, "pose.y"), name) for name, run in shown.items()]
    return {
        "fig3_fig4": plan_view("Path of the centre of mass", tracks),
        "fig5": sheet(panels, "time [s]"),
    }
