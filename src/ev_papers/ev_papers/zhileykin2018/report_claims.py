"""Report on two claims of Zhileykin (2018) without a figure: braking engine, steering driver.

Scenarios `zhileykin2018_braking` and `zhileykin2018_steered`; their runs are named after bend or
straight ahead and how the torque is shared.
"""

from __future__ import annotations

from ev_core.vehicle.description import Vehicle
from ev_papers.zhileykin2018.paths import off_the_path
from ev_papers.zhileykin2018.source import PEAK_SIDESLIP, track
from ev_stack.figures.other_axes import plan_view
from ev_stack.figures.panels import motion_panels
from ev_stack.figures.sheets import Sheet
from ev_stack.measures.handling import peak_sideslip
from ev_stack.measures.metric import Metric, Parameters, Runs, metric, run_named


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Sideslip angles and, where a driver follows a path, distances from it."""
    driver = parameters["driver"]

    def sideslip(name: str) -> float:
        return peak_sideslip(run_named(runs, name))

    def distance(name: str) -> float:
        return off_the_path(run_named(runs, name), driver["path.x"], driver["path.y"])

    found = {}
    for name in runs:
        found[f"peak_sideslip_{name}"] = metric(
            lambda name=name: sideslip(name), "rad", PEAK_SIDESLIP
        )
        if driver.get("method") == "preview":
            found[f"off_the_path_{name}"] = metric(
                lambda name=name: distance(name),
                "m",
                "largest distance from the path of the driver",
            )
    return found


def figures(runs: Runs) -> dict[str, Sheet]:
    """Paths, and sideslip angles over time."""
    return {
        "paths": plan_view("Path of the centre of mass", [track(runs, name) for name in runs]),
        "motion": Sheet(motion_panels(runs, "sideslip_angle")),
    }
