"""Full braking on every kind of road: without ABS, with one of the friction brakes, and blended."""

from __future__ import annotations

import argparse
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ev_stack.measures import motion
from ev_stack.measures.handling import of_wheels
from ev_stack.measures.metric import Metric, channel, metric
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Run
from ev_study.studies.study import Case, Results, rows_of_cases

ABOUT = (
    "Full braking without ABS, with one of the friction brakes, "
    "and with drives and brakes blended, on all roads"
)
SCENARIO = "blended_brakes"
Values = tuple[tuple[str, str, Any], ...]
# By name the run of the scenario, and what differs from it.
CONTROLS: Mapping[str, tuple[str, Values]] = {
    "off": ("off", ()),
    "least_squares": ("off", (("asr", "method", "least_squares"),)),
    "friction": ("friction", ()),
    "drives": ("drives", ()),
    "stability": ("stability", ()),
}
NOISE = {"wheel_speed": 0.03, "wheel_torque": 0.5, "imu_acceleration": 0.05, "imu_yaw_rate": 0.002}
BEGIN = 1.0  # of the pedal [s]
STANDING = 0.3  # as good as stopped [m/s]
ROLLING = 2.0  # fast enough for a slip [m/s]
FAST = 80 / 3.6  # [m/s]
LONGEST_STOP = 20.0  # [s]
# Heading of the column, and digits.
QUANTITIES = {
    "distance": ("distance [m]", 1),
    "mean_slip": ("mean slip", 3),
    "peak_slip": ("peak slip", 2),
    "heading": ("heading [deg]", 1),
    "aside": ("aside [m]", 2),
    "recovered": ("recovered [kJ]", 1),
    "share": ("of the kinetic energy", 2),
}
LEFT = 2
SUMS = ("distance_", "recovered_")


@dataclass(frozen=True, slots=True)
class Situation:
    """A road, a speed [m/s] and the brake torque that all wheels shall have within 0.2 s [N m]."""

    speed: float
    torque: float
    left: tuple[str, ...]
    right: tuple[str, ...] = ()  # as left
    length: tuple[float, ...] = ()  # of the segments [m]

    def values(self) -> Values:
        """Difference from the scenario's own file."""
        segments: Values = ()
        if self.length:
            segments = (
                ("plant", "road.pattern", "segments"),
                ("plant", "road.length", list(self.length)),
            )
        return (
            ("plant", "initial_speed", self.speed),
            ("driver", "speed_profile.speed", [self.speed]),
            ("driver", "pedals.brake_torque", [0.0, self.torque]),
            ("plant", "road.left", list(self.left)),
            ("plant", "road.right", list(self.right or self.left)),
            *segments,
        )


SITUATIONS = {
    "dry": Situation(FAST, 12000.0, ("dry_asphalt",)),
    "wet": Situation(FAST, 9000.0, ("wet_asphalt_1",)),
    "snow": Situation(FAST, 6000.0, ("packed_snow_1",)),
    "snow 2": Situation(FAST, 6000.0, ("packed_snow_2",)),
    "ice": Situation(5.0, 4000.0, ("ice",)),
    "dry, then snow": Situation(FAST, 9000.0, ("dry_asphalt", "packed_snow_1"), length=(35.0,)),
    "snow left, dry right": Situation(FAST, 9000.0, ("packed_snow_1",), ("dry_asphalt",)),
    "ice left, dry right": Situation(FAST, 9000.0, ("ice",), ("dry_asphalt",)),
}
HEADINGS = tuple(heading for heading, _ in QUANTITIES.values())
COLUMNS = ("road", "brakes", *HEADINGS)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add a choice of roads instead of all."""
    parser.add_argument(
        "--roads",
        nargs="+",
        choices=list(SITUATIONS),
        metavar="ROAD",
        help="these only; default: all",
    )


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every control on every road."""
    noise = tuple(
        ("plant", f"sensors.{sensor}.noise", deviation) for sensor, deviation in NOISE.items()
    )
    found = []
    for road in getattr(given, "roads", None) or SITUATIONS:
        for name, (run, values) in CONTROLS.items():
            changed = (*noise, *SITUATIONS[road].values(), *values)
            case = Case(f"{road}: {name}", SCENARIO, changed, run, duration=LONGEST_STOP)
            found.append(case)
    return found


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """QUANTITIES from the pedal until the car stops; no distance where it does not."""
    speed = motion.path_speed(recording)
    begin = int(np.searchsorted(recording.time, BEGIN))
    still = np.flatnonzero(np.abs(speed[begin:]) < STANDING)
    end = begin + int(still[0]) + 1 if len(still) else len(speed)
    part = slice(begin, end)
    distance = float(np.ptp(motion.distance_on_path(recording)[part])) if len(still) else None
    # At walking speed a slip ratio has little meaning.
    slips = np.abs(of_wheels(recording, "tire_forces.slip_ratio")[:, part])
    slips = slips[:, speed[part] > ROLLING]
    power = channel(recording, "battery.voltage") * channel(recording, "battery.current")
    recovered = float(np.trapezoid(power[part], recording.time[part]))
    kinetic = run.configurations["asr"].common.vehicle.mass * float(speed[begin]) ** 2 / 2.0
    return {
        "distance": distance,
        "mean_slip": float(slips.mean()),
        "peak_slip": float(slips.max()),
        "heading": math.degrees(float(np.abs(motion.heading(recording)[part]).max())),
        "aside": float(np.abs(channel(recording, "pose.y")[part]).max()),
        "recovered": recovered / 1e3,
        "share": recovered / kinetic,
    }


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Distance and recovered energy of each case that stops."""
    found = {}
    for name, result in results.items():
        of = result.measured
        if result.refused or of["distance"] is None:
            continue
        ending = name.replace(": ", "_")
        found[f"distance_{ending}"] = metric(lambda of=of: of["distance"], "m")
        found[f"recovered_{ending}"] = metric(lambda of=of: 1e3 * of["recovered"], "J")
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Road, control and quantities; a dash where the car does not stop in time."""
    forms = {name: f".{digits}f" for name, (_, digits) in QUANTITIES.items()}
    return rows_of_cases(results, forms)
