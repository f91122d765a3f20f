"""Sweep of zhileykin2018_sweep with other cars, tyres and readings of the source."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ev_papers.zhileykin2018 import grid
from ev_papers.zhileykin2018.grid import BY_LAW, CONTROLS, LAW, REAR_DRIVE, Values
from ev_stack.measures.metric import Metric, metric
from ev_study.studies.study import Case, Results

ABOUT = (
    "Zhileykin 2018: the sweep with other tyres, cars and readings of the source, "
    "where the law holds"
)
JUDGED = tuple(name for name in CONTROLS if name != REAR_DRIVE)
COLUMNS = ("variant", "rear drive spins in", *(f"{name} holds" for name in JUDGED))
HEADING = f"of {grid.SIZE} cases: held of those in which rear drive spins (of all)"

measure = grid.measure


@dataclass(frozen=True, slots=True)
class Variant:
    """Difference from the scenario's file, in a word and in full.

    A reading of the law concerns the runs with the law only.
    """

    name: str
    title: str
    values: Values = ()
    of_law: bool = False

    @property
    def controls(self) -> tuple[str, ...]:
        """Controls that it concerns."""
        return BY_LAW if self.of_law else CONTROLS


def _of_tyre(name: str, title: str, *coefficients: float) -> Variant:
    return Variant(name, title, (("*", "vehicle.tyre.coefficients", coefficients),))


def _of_car(name: str, title: str, parameter: str, value: float) -> Variant:
    return Variant(name, title, (("*", f"vehicle.{parameter}", value),))


def _reading(parameter: str, value: str, title: str) -> Variant:
    return Variant(value, title, ((LAW, parameter, value),), of_law=True)


BASE = Variant("base", "as in zhileykin2018_sweep")
VARIANTS = (
    BASE,
    _of_tyre("S0_low", "S0 = 0.03 instead of 0.05", 0.35, 0.03, 0.15, 0.0),
    _of_tyre("S0_high", "S0 = 0.08", 0.35, 0.08, 0.15, 0.0),
    _of_tyre("no_peak", "tyre curve without a peak, S1 = 0.001", 0.35, 0.05, 0.001, 0.0),
    _of_car(
        "height_low",
        "centre of mass 0.4 m high instead of 0.65 m",
        "centre_of_mass_height",
        0.4,
    ),
    _of_car("height_high", "centre of mass 0.8 m high", "centre_of_mass_height", 0.8),
    _of_car("inertia_low", "J_z = 3200 kg m^2 instead of 4200 kg m^2", "yaw_inertia", 3200.0),
    _of_car("inertia_high", "J_z = 5200 kg m^2", "yaw_inertia", 5200.0),
    _reading(
        "rear_wheels",
        "by_geometry",
        "more torque for the inner rear wheel instead of the slower one",
    ),
    _reading("second_branch", "derived", "eq 5 as it follows, K cos(phi)"),
    _reading("second_branch", "rear_share", "eq 5 for the rear share, 1 - K cos(phi)"),
    _reading(
        "braking",
        "command",
        "braking by the driver's command instead of j_x <= 0 straight ahead",
    ),
    _reading(
        "braking",
        "deceleration",
        "all torque to the rear axle wherever the car slows down, j_x <= 0",
    ),
    _reading("source", "estimated", "slip angles from the observer"),
)


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """The whole grid for every variant, as on the page docs/zhileykin2018.md."""
    found: list[Case] = []
    for variant in VARIANTS:
        found += grid.cases_of(variant.controls, variant.values, variant.name)
    return found


def _spins(results: Results, variant: Variant) -> np.ndarray:
    # A reading of the law leaves rear drive as it is.
    return grid.spins(results, BASE.name if variant.of_law else variant.name)


def _held(results: Results, variant: Variant, control: str) -> np.ndarray:
    like = variant if control in variant.controls else BASE
    return grid.holds(results, control, like.name)


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Counts of the table."""
    found = {}
    for variant in VARIANTS:
        spins = _spins(results, variant)
        found[f"rear_drive_spins_{variant.name}"] = metric(spins.sum, "1")
        for control in variant.controls:
            if control != REAR_DRIVE:
                held = _held(results, variant, control) & spins
                name = f"holds_where_rear_drive_spins_{control}_{variant.name}"
                found[name] = metric(held.sum, "1")
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Cases that each control holds of those in which rear drive spins, and of all in brackets.

    Nothing stands where a control is as in the base.
    """
    found = []
    for variant in VARIANTS:
        spins = _spins(results, variant)
        counts = []
        for control in JUDGED:
            held = _held(results, variant, control)
            shown = f"{(held & spins).sum()} ({held.sum()})"
            counts.append(shown if control in variant.controls else "")
        found.append((variant.title, str(spins.sum()), *counts))
    return found
