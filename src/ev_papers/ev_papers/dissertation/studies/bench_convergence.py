"""Convergence of the run on the bench to the virtual run as its parameters become ideal."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import replace

from ev_papers.dissertation.measures import urban_cases
from ev_papers.dissertation.measures.urban_cases import BENCH, DRIVERS, SCENARIO, Values
from ev_papers.dissertation.studies import bench_difference
from ev_papers.dissertation.studies.bench_difference import apart, away_from_switches, ideal
from ev_stack.measures.metric import Metric
from ev_study.studies.study import Case, Results

ABOUT = (
    "The urban cycle on the bench beside the virtual run "
    "- difference against each parameter of the bench"
)
COLUMNS = (
    "parameter",
    "value",
    "unit",
    "torque [%]",
    "transducer [%]",
    "wheel speed [%]",
    "distance [%]",
    "torque away from switches [%]",
)
SUMS = ("ideal_",)
SHORTEST = 16.0  # [s]: the first traction window of the cycle begins at 15.7 s
LENGTH = 24.0  # [s]: rest, pulling away, both surfaces, spinning wheels
EXCHANGE = 1e-3  # [s], control period of the runs in which another parameter is varied
PERIODS = (5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)  # [s]
# Parameter, unit, values from bad to good. The others are ideal.
VARIED: tuple[tuple[str, str, tuple[float, ...]], ...] = (
    ("set_point.delay", "s", (1e-2, 5e-3, 2e-3, 1e-3, 2e-4, 5e-5, 1e-5)),
    ("set_point.torque_rate", "N m/s", (1e3, 1e4, 1e5, 1e6, 1e7)),
    ("set_point.torque_resolution", "N m", (4.0, 1.0, 0.25, 0.03125, 0.001)),
    ("shaft.stiffness", "N m/rad", (2e3, 2e4, 2e5, 2e6)),
    ("sensors.bench_torque.noise", "N m", (5.0, 0.5, 0.05, 0.005)),
    ("sensors.bench_torque.bias", "N m", (1.0, 0.1, 0.01)),
    ("sensors.bench_torque.gain", "1", (1.01, 1.001, 1.0001)),
    ("sensors.bench_speed.noise", "rad/s", (0.5236, 0.05, 0.005, 0.0005)),
)

measure = bench_difference.measure


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the driver."""
    parser.add_argument(
        "--driver",
        choices=DRIVERS,
        default="imposed_speed",
        help=(
            "default: imposed_speed; pulse switches by the speed, "
            "so the least difference moves its pulses"
        ),
    )


def _period(period: float) -> Values:
    return (("*", "control_period", period),)


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Virtual run and ideal bench with each period, and each value of each parameter with one."""
    found = []
    for period in PERIODS:
        found.append(case(given.driver, f"virtual {period:g}", SCENARIO, _period(period)))
    for period in PERIODS:
        values = (*ideal(), *_period(period))
        found.append(case(given.driver, f"ideal {period:g}", BENCH, values))
    for name, _, varied in VARIED:
        for value in varied:
            values = (*ideal(), *_period(EXCHANGE), ("test_bench", name, value))
            found.append(case(given.driver, f"{name} {value:g}", BENCH, values))
    return found


def case(driver: str, name: str, scenario: str, values: Values) -> Case:
    """Part of the cycle with a driver, method 1, and some values changed."""
    whole = urban_cases.case("1", driver, 1, name, values, scenario)
    return replace(whole, duration=LENGTH)


def _row(results: Results, case: str, beside: str) -> tuple[float, ...]:
    """Differences of a case to another one, in the order of COLUMNS."""
    one = results[case].measured
    other = results[beside].measured
    calm = away_from_switches(one["pressed"], other["pressed"])
    return (
        apart(one["torque"], other["torque"]),
        apart(one["transducer"], other["transducer"]),
        apart(one["speed"], other["speed"]),
        100.0 * abs(one["distance"] / other["distance"] - 1.0),
        apart(one["torque"], other["torque"], calm),
    )


def differences(results: Results) -> dict[tuple[str, float, str], tuple[float, ...]]:
    """Differences by parameter, value and unit.

    Those of an ideal bench are to the virtual run, those of the others to the ideal bench.
    """
    found = {}
    for period in PERIODS:
        row = _row(results, f"ideal {period:g}", f"virtual {period:g}")
        found["control_period", period, "s"] = row
    beside = f"ideal {EXCHANGE:g}"
    for name, unit, values in VARIED:
        for value in values:
            found[name, value, unit] = _row(results, f"{name} {value:g}", beside)
    return found


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Differences of the ideal bench with the shortest exchange."""
    torque, _, speed, distance, away = differences(results)["control_period", PERIODS[-1], "s"]
    return {
        "ideal_torque_difference": Metric(torque, "%"),
        "ideal_torque_difference_away_from_switches": Metric(away, "%"),
        "ideal_speed_difference": Metric(speed, "%"),
        "ideal_distance_difference": Metric(distance, "%"),
    }


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Mean differences over the largest magnitude."""
    rows = []
    for (name, value, unit), found in differences(results).items():
        rows.append((name, f"{value:g}", unit, *(f"{each:.4f}" for each in found)))
    return rows
