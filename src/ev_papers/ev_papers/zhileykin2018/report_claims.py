"""Report on two claims of Zhileykin & Eranosyan (2018) without a figure: braking by the engine, a driver who steers.

Scenarios `zhileykin2018_braking` and `zhileykin2018_steered`; their runs are named after bend or straight ahead and how
the torque is shared.
"""

from __future__ import annotations

from ev_core.vehicle.description import Vehicle
from ev_papers.zhileykin2018.grid import off_the_path
from ev_papers.zhileykin2018.source import PEAK_SIDESLIP, track
from ev_stack.figures.other_axes import plan_view
from ev_stack.figures.panels import motion_panels
from ev_stack.figures.sheets import Sheet
from ev_stack.measures.handling import peak_sideslip
from ev_stack.measures.metric import Metric, Parameters, Runs, metric, run_named


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Sideslip angles and, where a driver follows a path, distances from it."""
    result, driver = {}, parameters["driver"]
    for name in runs:
        result[f"peak_sideslip_{name}"] = metric(
            lambda name=name: peak_sideslip(run_named(runs, name)), "rad", PEAK_SIDESLIP
        )
        if driver.get("method") == "preview":
            result[f"off_the_path_{name}"] = metric(
                lambda name=name: off_the_path(
                    run_named(runs, name), driver["path.x"], driver["path.y"]
                ),
                "m",
                "largest distance from the path of the driver",
            )
    return result


def figures(runs: Runs) -> dict[str, Sheet]:
    """Paths, and sideslip angles over time."""
    return {
        "paths": plan_view("Path of the centre of mass", [track(runs, name) for name in runs]),
        "motion": Sheet(motion_panels(runs, "sideslip_angle")),
    }
