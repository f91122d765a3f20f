"""Sensitivity of the wheel efficiencies of the five methods to assumptions, one at a time."""

from __future__ import annotations

import argparse
import math
from collections.abc import Sequence
from dataclasses import dataclass

from ev_papers.dissertation.measures import urban_cases
from ev_papers.dissertation.measures.urban_cases import (
    DRIVERS,
    METHODS,
    WITHOUT_F_SURFACE,
    Values,
    roads,
)
from ev_papers.dissertation.studies.five_methods import judged_quantity
from ev_sim.surfaces import SURFACES
from ev_stack.measures.metric import Metric, mean_over_seeds
from ev_study.studies.study import Case, Results

ABOUT = (
    "Dissertation, five methods - how the wheel efficiencies depend on assumptions, "
    "one changed at a time"
)
COLUMNS = ("what is assumed otherwise", *(f"method {method}" for method in METHODS))
_LAW = "electronic_differential"
_LIMIT = (_LAW, "limit", True)
_NOISE: Values = (
    ("plant", "sensors.wheel_speed.noise", 0.03),  # [rad/s]
    ("plant", "sensors.wheel_torque.noise", 0.5),  # [N m]
)
_ONE_BLOCK: Values = (
    ("*", "vehicle.battery.open_circuit_voltage", [329.6, 329.6]),
    ("*", "vehicle.battery.resistance", 0.103),
)

measure = urban_cases.measure


@dataclass(frozen=True, slots=True)
class Change:
    """Another assumption: its name, its parameters, and the methods that it concerns.

    `driver` is another one than the study's, `quantity` another way to count; a change of that
    alone reads the runs of the change `like`.
    """

    name: str
    title: str
    values: Values = ()
    methods: tuple[str, ...] = tuple(METHODS)
    driver: str = ""
    quantity: str = ""
    like: str = ""


def _surfaces(variant: int) -> Values:
    """Both surfaces in a variant, and the power of the driver for the limit of that snow."""
    snow = SURFACES[f"packed_snow_{variant}"]
    return (
        ("plant", "road.random_surfaces", [f"wet_asphalt_{variant}", f"packed_snow_{variant}"]),
        ("driver", "level.friction", snow.peak_friction),
        ("driver", "level.slip", math.log(snow.c1 * snow.c2 / snow.c3) / snow.c2),
    )


def _segments(shortest: float, longest: float) -> Values:
    """Lengths of the segments of the road [m]."""
    return (("plant", "road.random_shortest", shortest), ("plant", "road.random_longest", longest))


CHANGES = (
    Change("base", "as in five_methods"),
    Change(
        "full",
        "eq 2.37 in full, with rolling resistance in M_f",
        quantity="wheel_efficiency",
        like="base",
    ),
    Change(
        "powers",
        "eq 2.37 in full, with summed powers",
        quantity="wheel_power_efficiency",
        like="base",
    ),
    Change("pulse", "driver pulse, eq 2.37 in full", driver="pulse", quantity="wheel_efficiency"),
    Change(
        "pulse_windows",
        "driver pulse, whole traction windows, pedal pressed or not",
        driver="pulse",
        quantity="wheel_efficiency_windows",
        like="pulse",
    ),
    Change(
        "pulse_speeds",
        "driver pulse, ratio of speeds alone",
        quantity="wheel_speed_efficiency",
        like="pulse",
    ),
    Change("k_lower", "k = 1.06 instead of 1.11", (("driver", "level.factor", 1.06),)),
    Change("k_higher", "k = 1.16", (("driver", "level.factor", 1.16),)),
    Change(
        "no_rolling",
        "surfaces without rolling resistance, the limit too",
        (
            ("plant", "road.rolling_resistance_scale", 0.0),
            ("driver", "level.rolling_resistance", 0.012),
        ),
    ),
    Change(
        "no_rolling_full",
        "the same, eq 2.37 in full",
        quantity="wheel_efficiency",
        like="no_rolling",
    ),
    Change(
        "without_f_surface",
        "the same with f_0 0.005 and k 1.095, both fitted to table 3.6",
        WITHOUT_F_SURFACE,
        quantity="wheel_efficiency",
    ),
    Change(
        "rolling_low",
        "rolling resistance 0.79, lower end of snow",
        (("plant", "road.rolling_resistance_scale", 0.79),),
    ),
    Change(
        "rolling_high",
        "rolling resistance 1.21, upper end",
        (("plant", "road.rolling_resistance_scale", 1.21),),
    ),
    Change("surfaces_2", "wet asphalt 2, packed snow 2", _surfaces(2)),
    Change("short_segments", "segments of 2 to 20 m", _segments(2.0, 20.0)),
    Change("long_segments", "segments of 20 to 200 m", _segments(20.0, 200.0)),
    Change("half_step", "plant steps of 0.5 ms", (("plant", "step", 0.5e-3),)),
    Change("control_10_ms", "control period of 10 ms", (("*", "control_period", 0.01),)),
    Change("noise", "wheel speeds 0.03 rad/s, torques 0.5 N m of noise", _NOISE),
    Change(
        "speed_resistance",
        "k_f added to f_0, V in m/s",
        (("*", "vehicle.rolling_resistance_reading", "added"),),
    ),
    Change("one_block", "one block of the battery, 330 V", _ONE_BLOCK),
    Change("peak_use", "ASR at the fitted peak itself", (("asr", "use", 1.0),), ("1", "1b")),
    Change("limit", "no wheel gets more than its grip", (_LIMIT,), ("5",)),
    Change(
        "friction_125",
        "the same, friction 25 % too high",
        (_LIMIT, (_LAW, "error_factor", 1.25)),
        ("5",),
    ),
    Change(
        "friction_150",
        "the same, friction 50 % too high",
        (_LIMIT, (_LAW, "error_factor", 1.5)),
        ("5",),
    ),
    Change("estimated", "friction estimated", ((_LAW, "friction", "estimated"),), ("5",)),
)


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the number of roads, and the driver."""
    parser.add_argument(
        "--seeds",
        type=int,
        default=2,
        metavar="N",
        help="roads, with the seeds 1 to N; default 2",
    )
    parser.add_argument(
        "--driver",
        choices=DRIVERS,
        default="imposed_speed",
        help="default: imposed_speed",
    )


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Every method that a change concerns, on every road."""
    found = []
    for change in CHANGES:
        # Another way to count reads the runs of the change that it is like.
        if change.like:
            continue
        driver = change.driver or given.driver
        for method in change.methods:
            for seed in roads(given):
                name = _name(change, method, seed)
                found.append(urban_cases.case(method, driver, seed, name, change.values))
    return found


def _name(change: Change, method: str, seed: int) -> str:
    return f"{change.like or change.name} method {method} seed {seed}"


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Wheel efficiency of each change and method, means over the seeds.

    Of imposed speed it is that without rolling resistance.
    """
    found = {}
    for change in CHANGES:
        quantity = change.quantity or judged_quantity(given.driver)
        for method in change.methods:
            measured = [results[_name(change, method, seed)].measured for seed in roads(given)]
            values = [each[quantity] for each in measured if each]
            name = f"wheel_efficiency_{method}_{change.name}"
            if values:
                found[name] = mean_over_seeds(values, "1")
            else:
                found[name] = Metric(None, "1", reason="no case came to traction")
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Wheel efficiency of every method by change, and in brackets its distance from the base."""
    found = metrics(given, results)

    def shown(change: Change, method: str) -> str:
        if method not in change.methods:
            return "-"
        value = found[f"wheel_efficiency_{method}_{change.name}"].value
        base = found[f"wheel_efficiency_{method}_base"].value
        if value is None or base is None:
            return "-"
        return f"{value:.3f}" if change.name == "base" else f"{value:.3f} ({value - base:+.3f})"

    rows = []
    for change in CHANGES:
        numbers = (shown(change, method) for method in METHODS)
        rows.append((change.title, *numbers))
    return rows
