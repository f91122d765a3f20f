"""The double lane change of ISO 3888-1 over drivers, previews, speeds and cars: who touches a cone, and the path error.

    python benchmarks/lane_change.py [--cars CAR ...] [--speeds KMH ...] [--previews S ...]

Two tables in Markdown, as they stand in docs/scenarios.md: how many of the cars leave all cones
standing, by driver and preview time; and for the driver `preview` as it comes, cones and largest
distance from the line [m] by car.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ev_sim.driver.off_path import distances_from
from ev_sim.driver.path import Path as Line
from ev_sim.driver.path import path_of
from ev_stack.batches.batch import batch
from ev_stack.measures.course import hit_cones
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Overrides
from ev_stack.scenarios.scenario import load_scenario

CARS = sorted(path.stem for path in Path(__file__).parents[1].glob("config/vehicles/*.yaml"))
PURSUITS = (0.3, 0.4, 0.6)  # [s]
AS_IT_COMES = 2.0  # [s]
WAY = 170.0  # [m] from the start, 30 m before the first cone, to behind the last one
SIGNALS = ("pose.x", "pose.y", "pose.orientation_z", "pose.orientation_w")


class Passage(NamedTuple):
    """One car through the lanes at one speed."""

    cones: int
    error: float  # largest distance of its centre of mass from the line [m]


def passages(
    car: str, speeds: list[float], method: str, preview: str, time: float
) -> list[Passage]:
    """A car at each speed [km/h], by a driver method whose parameter `preview` is a time [s]."""
    values = [("driver", "method", method), ("driver", preview, time)]
    run = load_scenario("double_lane_change", Overrides(values=values, vehicle=car)).runs[0]
    line, vehicle = (
        path_of(run.configurations["driver"].parameters.path),
        run.configurations["plant"].common.vehicle,
    )
    found = []
    for speed in speeds:
        vary = {"plant.initial_speed": [speed / 3.6], "driver.speed_profile.speed": [[speed / 3.6]]}
        driven = batch(run.configurations, WAY / (speed / 3.6), vary, signals=SIGNALS)
        recording = Recording(
            driven.time, {name: values[0] for name, values in driven.signals.items()}
        )
        found.append(
            Passage(int(hit_cones(recording, vehicle, run.course).sum()), error(recording, line))
        )
    return found


def error(recording: Recording, line: Line) -> float:
    """Largest distance from the line [m]."""
    return float(distances_from(line, *(recording.channels[name] for name in SIGNALS[:2])).max())


def row(*cells: object) -> str:
    """A row of a table in Markdown."""
    return f"| {' | '.join(map(str, cells))} |"


def main() -> None:
    """Drive and print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--cars", nargs="+", default=CARS, choices=CARS, metavar="CAR")
    parser.add_argument(
        "--speeds", nargs="+", type=float, default=[20, 40, 60, 70, 80, 90], metavar="KMH"
    )
    parser.add_argument(
        "--previews",
        nargs="+",
        type=float,
        default=[0.4, 0.5, 0.6, 1.0, 1.5, 2.0, 3.0],
        metavar="S",
    )
    given = parser.parse_args()
    drivers = [("path_follower", "pursuit.preview_time", time) for time in PURSUITS]
    drivers += [
        ("preview", "preview.preview_time", time) for time in {*given.previews, AS_IT_COMES}
    ]
    heads = [f"{speed:g} km/h" for speed in given.speeds]
    print(row("driver", "preview [s]", *heads), row("---", *["---:"] * (len(heads) + 1)), sep="\n")
    for method, preview, time in sorted(drivers):
        driven = {car: passages(car, given.speeds, method, preview, time) for car in given.cars}
        clean = np.sum([[each.cones == 0 for each in found] for found in driven.values()], axis=0)
        print(
            row(f"`{method}`", f"{time:g}", *(f"{n} of {len(driven)}" for n in clean)), flush=True
        )
        if (method, time) == ("preview", AS_IT_COMES):
            kept = driven
    print("", row("car", *heads), row("---", *["---:"] * len(heads)), sep="\n")
    for car, found in kept.items():
        print(row(f"`{car}`", *(f"{each.cones} ({each.error:.2f})" for each in found)))


if __name__ == "__main__":
    main()
