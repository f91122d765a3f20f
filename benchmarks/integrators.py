"""How far the integrators of the planar plant are from the reference, by scenario: the table of docs/planar_plant.md.

    python benchmarks/integrators.py [--only SCENARIO ...]

The reference is the Runge-Kutta method at a fifth of its step. All runs of a scenario are driven,
and of all their metrics the one that is furthest from the reference counts.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from typing import NamedTuple

import ev_stack
from ev_stack.scenarios.files import scenario_names
from ev_stack.scenarios.scenario import load_scenario

REFERENCE = {"plant.step": 2e-4}
SEMI_IMPLICIT = {"plant.integrator": "semi_implicit"}
COLUMNS = {
    "runge_kutta, 1 ms": {},
    "semi_implicit, 1 ms": SEMI_IMPLICIT,
    "2 ms": SEMI_IMPLICIT | {"plant.step": 2e-3},
    "5 ms": SEMI_IMPLICIT | {"plant.step": 5e-3},
}
GOAL = 1e-3
LEAST = 1e-5  # a metric that is smaller counts as this: 10 um, 10 mW


class Furthest(NamedTuple):
    """The metric that is furthest from the reference."""

    deviation: float  # [1]
    metric: str
    reference: float


def metrics_of(scenario: str, changes: dict[str, object]) -> dict[str, float]:
    """All metrics of a scenario that are numbers."""
    found = ev_stack.run(scenario, set=changes).metrics
    values = {name: metric.value for name, metric in found.items()}
    return {
        name: float(value)
        for name, value in values.items()
        if isinstance(value, int | float) and not math.isnan(value)
    }


def furthest(found: dict[str, float], reference: dict[str, float]) -> Furthest:
    """The largest deviation over the reference."""
    worst = Furthest(0.0, "", 0.0)
    for name, exact in reference.items():
        deviation = abs(found.get(name, math.inf) - exact) / max(abs(exact), LEAST)
        worst = max(worst, Furthest(deviation, name, exact))
    return worst


def on_planar_plant(scenario: str) -> bool:
    """True for a scenario whose plants all have an integrator."""
    plants = [run.configurations["plant"] for run in load_scenario(scenario).runs]
    return all(hasattr(plant.parameters, "integrator") for plant in plants)


def row(scenario: str) -> Iterator[str]:
    """Cells of a scenario, and what is beyond the goal at 1 ms."""
    reference = metrics_of(scenario, REFERENCE)
    yield f"`{scenario}`"
    yield str(len(reference))
    beyond = ""
    for name, changes in COLUMNS.items():
        worst = furthest(metrics_of(scenario, changes), reference)
        yield f"{worst.deviation:.1e}"
        if name == "semi_implicit, 1 ms" and worst.deviation > GOAL:
            beyond = f"`{worst.metric}`, {worst.reference:.3g}"
    yield beyond


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--only", nargs="+", metavar="SCENARIO", help="default: all")
    only = parser.parse_args().only
    titles = ("scenario", "metrics", *COLUMNS, "beyond 0.1 % at 1 ms")
    print(f"| {' | '.join(titles)} |")
    print(f"|{'---|' * len(titles)}")
    for scenario in only or filter(on_planar_plant, scenario_names()):
        print(f"| {' | '.join(row(scenario))} |", flush=True)


if __name__ == "__main__":
    main()
