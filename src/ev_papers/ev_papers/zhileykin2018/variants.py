"""The sweep of zhileykin2018_sweep with other cars, tyres and readings of the source: where the law holds."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass

from ev_papers.zhileykin2018 import grid as grid
from ev_papers.zhileykin2018.grid import BY_LAW, CONTROLS, REAR_DRIVE, Values
from ev_stack.measures.metric import Metric, metric
from ev_study.studies.study import Case, Results

ABOUT = "Zhileykin 2018: the sweep with other tyres, cars and readings of the source, where the law holds"
COLUMNS = (
    "variant",
    "rear drive spins in",
    *(f"{name} holds" for name in CONTROLS if name != REAR_DRIVE),
)
HEADING = f"of {grid.SIZE} cases: held of those in which rear drive spins (of all)"


@dataclass(frozen=True, slots=True)
class Variant:
    """What differs from the scenario's file, in a word and in full; a reading of the law concerns its runs only."""

    name: str
    title: str
    values: Values = ()
    of_law: bool = False

    @property
    def controls(self) -> tuple[str, ...]:
        """The controls that it concerns."""
        return BY_LAW if self.of_law else CONTROLS


def _of_car(name: str, title: str, parameter: str, value: object) -> Variant:
    return Variant(name, title, (("*", f"vehicle.{parameter}", value),))


def _reading(parameter: str, value: str, title: str) -> Variant:
    return Variant(value, title, (("electronic_differential", parameter, value),), of_law=True)


BASE = Variant("base", "as in zhileykin2018_sweep")
VARIANTS = (
    BASE,
    _of_car("S0_low", "S0 = 0.03 instead of 0.05", "tyre.coefficients", (0.35, 0.03, 0.15, 0.0)),
    _of_car("S0_high", "S0 = 0.08", "tyre.coefficients", (0.35, 0.08, 0.15, 0.0)),
    _of_car(
        "no_peak",
        "tyre curve without a peak, S1 = 0.001",
        "tyre.coefficients",
        (0.35, 0.05, 0.001, 0.0),
    ),
    _of_car(
        "height_low", "centre of mass 0.4 m high instead of 0.65 m", "centre_of_mass_height", 0.4
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
        "braking", "command", "braking by the driver's command instead of j_x <= 0 straight ahead"
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
    return [
        case for each in VARIANTS for case in grid.cases_of(each.controls, each.values, each.name)
    ]


measure = grid.measure


def _held(results: Results, variant: Variant, control: str) -> tuple[int, int]:
    """In how many cases a control holds: of those in which rear drive spins, and of all."""
    like = variant.name if control in variant.controls else BASE.name
    held = grid.holds(results, control, like)
    return int((held & _spins(results, variant)).sum()), int(held.sum())


def _spins(results: Results, variant: Variant):
    return grid.spins(results, BASE.name if variant.of_law else variant.name)


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """The counts of the table."""
    found = {}
    for each in VARIANTS:
        found[f"rear_drive_spins_{each.name}"] = metric(
            lambda each=each: _spins(results, each).sum(), "1"
        )
        for control in each.controls:
            if control != REAR_DRIVE:
                found[f"holds_where_rear_drive_spins_{control}_{each.name}"] = metric(
                    lambda each=each, control=control: _held(results, each, control)[0], "1"
                )
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Of the cases in which rear drive spins those that each control holds, in brackets of all; empty: as the base."""

    def shown(variant: Variant, control: str) -> str:
        if control not in variant.controls:
            return ""
        of_spins, of_all = _held(results, variant, control)
        return f"{of_spins} ({of_all})"

    return [
        (
            each.title,
            str(_spins(results, each).sum()),
            *(shown(each, name) for name in CONTROLS if name != REAR_DRIVE),
        )
        for each in VARIANTS
    ]
