"""The five methods of the dissertation: tables 3.1 to 3.6 and 5.1 to 5.6, and gains of method 1.

Each public function measures one number of published.csv, on all roads of the study five_methods.
"""

from __future__ import annotations

import operator
import re
import statistics

from ev_papers.dissertation.measures.urban_cases import FIVE
from ev_papers.dissertation.studies import five_methods
from ev_papers.dissertation.studies.five_methods import (
    KILOWATT_HOUR,
    KILOWATT_MINUTE,
    gains,
    savings,
    values_of,
)
from ev_stack.measures.metric import NotMeasured
from ev_study.verdicts.need import StudyCases

_IMPOSED = "imposed_speed"
_UNITS = {"1": 1.0, "%": 0.01, "kW_min": KILOWATT_MINUTE, "kW_h": KILOWATT_HOUR}
_ENDS = {"smallest": min, "largest": max}
_COMPARE = {">": operator.gt, ">=": operator.ge, "<": operator.lt}


def _by_road(driven: StudyCases, quantity: str, method: float, driver: str) -> list[float]:
    """A quantity of a method on each road; NotMeasured if there is none."""
    measured = values_of(driven.given, driven.results, f"{method:g}", driver)
    if not measured:
        raise NotMeasured(f"method {method:g} was not driven with {driver}")
    return [each[quantity] for each in measured]


def mean(driven: StudyCases, quantity: str, method: float, driver: str, unit: str = "1") -> float:
    """Mean of a quantity of a method over the roads, in a unit."""
    return statistics.fmean(_by_road(driven, quantity, method, driver)) / _UNITS[unit]


def shaft_work(driven: StudyCases, method: float) -> float:
    """Work at both shafts with driver pulse, energy times drive efficiency [kW min]."""
    energies = _by_road(driven, "energy", method, "pulse")
    efficiencies = _by_road(driven, "drive_efficiency", method, "pulse")
    return statistics.fmean(map(operator.mul, energies, efficiencies)) / KILOWATT_MINUTE


def _means(driven: StudyCases, quantity: str, driver: str) -> dict[int, float]:
    return {int(method): mean(driven, quantity, int(method), driver) for method in FIVE}


def total(driven: StudyCases, wheel: str, method: float) -> float:
    """Mean over the roads of wheel efficiency times drive efficiency [%].

    `wheel` is one of the quantities of the wheel efficiency.
    """
    of_wheel = _by_road(driven, wheel, method, _IMPOSED)
    of_drive = _by_road(driven, "drive_efficiency", method, _IMPOSED)
    return 100.0 * statistics.fmean(map(operator.mul, of_wheel, of_drive))


def share_in_order(driven: StudyCases, quantity: str, driver: str, order: str) -> float:
    """Share of roads on which the methods have an order such as 1>3>=4 [1]."""
    by_method = {method: _by_road(driven, quantity, int(method), driver) for method in FIVE}
    methods = re.split(r"[<>]=?", order)
    signs = re.findall(r"[<>]=?", order)
    roads = len(by_method[methods[0]])
    in_order = [True] * roads
    for one, sign, other in zip(methods, signs, methods[1:], strict=False):
        for road in range(roads):
            holds = _COMPARE[sign](by_method[one][road], by_method[other][road])
            in_order[road] = in_order[road] and holds
    return sum(in_order) / roads


def difference_of_methods(driven: StudyCases, quantity: str, one: float, other: float) -> float:
    """Mean of a quantity of one method minus that of another."""
    return mean(driven, quantity, one, _IMPOSED) - mean(driven, quantity, other, _IMPOSED)


def right_minus_left(driven: StudyCases, quantity: str, method: float) -> float:
    """Mean of a quantity on the right minus that on the left."""
    right = mean(driven, f"{quantity}_right", method, _IMPOSED)
    return right - mean(driven, f"{quantity}_left", method, _IMPOSED)


def farthest_right_from_left(driven: StudyCases, quantity: str, method: float) -> float:
    """Largest difference of a quantity right and left on one road, rounded to a thousandth."""
    right = _by_road(driven, f"{quantity}_right", method, _IMPOSED)
    left = _by_road(driven, f"{quantity}_left", method, _IMPOSED)
    return round(max(abs(a - b) for a, b in zip(right, left, strict=True)), 3)


def product_of_tables(method: float) -> float:
    """Wheel times drive efficiency of table 5.6 [%]."""
    wheel = five_methods.BENCH_WHEEL_EFFICIENCY[int(method)]
    return 100.0 * wheel * five_methods.DRIVE_EFFICIENCY[int(method)]


def gain_of_tables(driven: StudyCases, table: str, end: str, over: str) -> float:
    """Smallest or largest gain of method 1 by a table, over method 1 or over the other one [%]."""
    found = gains(getattr(five_methods, table))
    return _ENDS[end](getattr(found, over).values())


def gain_of_runs(driven: StudyCases, quantity: str, end: str) -> float:
    """Smallest or largest gain of method 1 by our runs, over method 1 [%]."""
    found = gains(_means(driven, quantity, _IMPOSED))
    return _ENDS[end](found.over_method_1.values())


def saving_of_table(driven: StudyCases, end: str) -> float:
    """Smallest or largest saving of energy by method 1 in table 5.6, in its unit."""
    return _ENDS[end](savings(five_methods.ENERGY).values())


def saving_of_runs(driven: StudyCases, end: str) -> float:
    """Smallest or largest saving by our runs with driver pulse [kW min]."""
    found = savings(_means(driven, "energy", "pulse"))
    return _ENDS[end](found.values()) / KILOWATT_MINUTE
