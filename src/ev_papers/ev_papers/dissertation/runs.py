"""What the verdicts on the dissertation need to be driven, and how they read it."""

from __future__ import annotations

import statistics
from collections.abc import Callable, Mapping

from ev_papers.dissertation.measures.urban_cases import FIVE
from ev_papers.dissertation.studies.five_methods import values_of
from ev_sim.measures.metric import NotMeasured
from ev_sim.verdicts.check import Measure, Number, Shown, between
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns, StudyCases, StudyNeed

MODEL = ScenarioNeed("urban_mixed", duration=1.0)  # for the car and the parameters of the scenario alone
PART = ScenarioNeed(  # the first windows of traction
    "urban_mixed", (("driver", "method", "imposed_speed"), ("plant", "speed", "imposed")), duration=95.0
)
FIVE_METHODS = StudyNeed("five_methods")
FIVE_ON_BENCH = StudyNeed("five_methods", ("--bench", "--drivers", "imposed_speed", "pulse"))

SPEEDS = "wheel_speed_efficiency"  # eq 2.37 without rolling resistance in M_f
ByMethod = Mapping[int, float]


def of_car(measure: Callable[..., float]) -> Measure:
    """A number of the vehicle description."""
    return lambda driven: measure(driven.vehicle)


def parameter(node: str, name: str) -> Measure:
    """A number among the parameters of a node."""

    def read(driven: ScenarioRuns) -> float:
        return float(driven.parameters[node][name])

    return read


def seeds(driven: StudyCases, quantity: str, method: int, driver: str) -> list[float]:
    """A quantity of a method on each road; NotMeasured if there is none."""
    values = [value[quantity] for value in values_of(driven.given, driven.results, str(method), driver)]
    if not values:
        raise NotMeasured(f"method {method} was not driven with {driver}")
    return values


def mean(quantity: str, method: int, driver: str, unit: float = 1.0) -> Measure:
    """The mean over the roads, in multiples of `unit`."""
    return lambda driven: statistics.fmean(seeds(driven, quantity, method, driver)) / unit


def means(driven: StudyCases, quantity: str, driver: str) -> dict[int, float]:
    """The means of all five methods."""
    return {int(method): statistics.fmean(seeds(driven, quantity, int(method), driver)) for method in FIVE}


def order(quantity: str, driver: str, holds: Callable[[ByMethod], bool]) -> Number:
    """The share of roads on which an order of the methods holds."""
    return Number("1", 1.0, between(0.9, 1.0, "at least 9 of 10 roads"), _share(quantity, driver, holds))


def order_shown(quantity: str, driver: str, holds: Callable[[ByMethod], bool], name: str) -> Shown:
    """The same, not judged."""
    return Shown("1", _share(quantity, driver, holds), name)


def _share(quantity: str, driver: str, holds: Callable[[ByMethod], bool]) -> Measure:
    def measure(driven: StudyCases) -> float:
        columns = {int(method): seeds(driven, quantity, int(method), driver) for method in FIVE}
        roads = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
        return sum(map(holds, roads)) / len(roads)

    return measure
