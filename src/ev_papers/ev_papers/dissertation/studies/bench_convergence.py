"""How the run on the bench goes over into the virtual run when its parameters become ideal, one by one."""

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

ABOUT = "The urban cycle on the bench beside the virtual run - difference against each parameter of the bench"
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
SHORTEST = 16.0  # s: the first traction window of the cycle begins at 15.7 s
LENGTH = 24.0  # s: rest, pulling away, both surfaces, spinning wheels
EXCHANGE = 1e-3  # s, control period of the runs in which another parameter is varied
PERIODS = (5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
# Node, parameter, unit, values from bad to good. The others are ideal.
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


def add_options(parser: argparse.ArgumentParser) -> None:
    """Which driver."""
    parser.add_argument(
        "--driver",
        choices=DRIVERS,
        default="imposed_speed",
        help="default: imposed_speed; pulse switches by the speed, so the least difference moves its pulses",
    )


def _period(period: float) -> tuple[tuple[str, str, float], ...]:
    return (("*", "control_period", period),)


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Virtual and ideal bench with each control period, and each value of each parameter with one of them."""

    def bench(name: str, period: float, *further: tuple[str, str, float]) -> Case:
        return case(given.driver, name, BENCH, (*ideal(), *_period(period), *further))

    return [
        *(
            case(given.driver, f"virtual {period:g}", SCENARIO, _period(period))
            for period in PERIODS
        ),
        *(bench(f"ideal {period:g}", period) for period in PERIODS),
        *(
            bench(f"{name} {value:g}", EXCHANGE, ("test_bench", name, value))
            for name, _, values in VARIED
            for value in values
        ),
    ]


def case(driver: str, name: str, scenario: str, values: Values) -> Case:
    """The part of the cycle with a driver, method 1, and some values changed."""
    return replace(urban_cases.case("1", driver, 1, name, values, scenario), duration=LENGTH)


measure = bench_difference.measure


def _row(results: Results, case: str, beside: str) -> tuple[float, ...]:
    one, other = results[case].measured, results[beside].measured
    return (
        apart(one["torque"], other["torque"]),
        apart(one["transducer"], other["transducer"]),
        apart(one["speed"], other["speed"]),
        100.0 * abs(one["distance"] / other["distance"] - 1.0),
        apart(one["torque"], other["torque"], away_from_switches(one["pressed"], other["pressed"])),
    )


def differences(results: Results) -> dict[tuple[str, float, str], tuple[float, ...]]:
    """By parameter, value and unit: of an ideal bench to the virtual run, of the others to the ideal bench."""
    found = {
        ("control_period", T, "s"): _row(results, f"ideal {T:g}", f"virtual {T:g}") for T in PERIODS
    }
    beside = f"ideal {EXCHANGE:g}"
    for name, unit, values in VARIED:
        found.update(
            {(name, value, unit): _row(results, f"{name} {value:g}", beside) for value in values}
        )
    return found


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Of the ideal bench with the shortest exchange."""
    torque, _, speed, distance, away = differences(results)["control_period", PERIODS[-1], "s"]
    return {
        "ideal_torque_difference": Metric(torque, "%"),
        "ideal_torque_difference_away_from_switches": Metric(away, "%"),
        "ideal_speed_difference": Metric(speed, "%"),
        "ideal_distance_difference": Metric(distance, "%"),
    }


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Mean differences over the largest magnitude."""
    return [
        (name, f"{value:g}", unit, *(f"{each:.4f}" for each in found))
        for (name, value, unit), found in differences(results).items()
    ]
