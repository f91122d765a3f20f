"""The five methods of the dissertation as they are judged: tables 3.1 to 3.6 and 5.1 to 5.6, and gains of method 1.

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

_IMPOSED_SPEED = "imposed_speed"
_UNITS = {"1": 1.0, "%": 0.01, "kW_min": KILOWATT_MINUTE, "kW_h": KILOWATT_HOUR}
_ENDS = {"smallest": min, "largest": max}
_COMPARE = {">": operator.gt, ">=": operator.ge, "<": operator.lt}


def _seeds(driven: StudyCases, quantity: str, method: float, driver: str) -> list[float]:
    """A quantity of a method on each road; NotMeasured if there is none."""
    values = [
        value[quantity] for value in values_of(driven.given, driven.results, f"{method:g}", driver)
    ]
    if not values:
        raise NotMeasured(f"method {method:g} was not driven with {driver}")
    return values


def mean(driven: StudyCases, quantity: str, method: float, driver: str, unit: str = "1") -> float:
    """The mean of a quantity of a method over the roads, in a unit."""
    return statistics.fmean(_seeds(driven, quantity, method, driver)) / _UNITS[unit]


def _means(driven: StudyCases, quantity: str, driver: str) -> dict[int, float]:
    return {int(method): mean(driven, quantity, int(method), driver) for method in FIVE}


def total(driven: StudyCases, wheel: str, method: float) -> float:
    """Mean over the roads of wheel efficiency, by one of its quantities, times drive efficiency [%]."""
    of = (
        _seeds(driven, quantity, method, _IMPOSED_SPEED) for quantity in (wheel, "drive_efficiency")
    )
    return 100.0 * statistics.fmean(a * b for a, b in zip(*of, strict=True))


def share_in_order(driven: StudyCases, quantity: str, driver: str, order: str) -> float:
    """The share of roads on which the methods stand in an order such as 1>3>=4 [1]."""
    columns = {method: _seeds(driven, quantity, int(method), driver) for method in FIVE}
    first, *rest = re.split(r"([<>]=?)", order)
    steps = list(zip([first, *rest[1::2]], rest[::2], rest[1::2], strict=False))
    roads = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
    return sum(
        all(_COMPARE[sign](of[one], of[other]) for one, sign, other in steps) for of in roads
    ) / len(roads)


def difference_of_methods(driven: StudyCases, quantity: str, one: float, other: float) -> float:
    """The mean of a quantity of one method minus that of another."""
    return mean(driven, quantity, one, _IMPOSED_SPEED) - mean(
        driven, quantity, other, _IMPOSED_SPEED
    )


def right_minus_left(driven: StudyCases, quantity: str, method: float) -> float:
    """The mean of a quantity on the right minus that on the left."""
    right, left = (
        mean(driven, f"{quantity}_{side}", method, _IMPOSED_SPEED) for side in ("right", "left")
    )
    return right - left


def farthest_right_from_left(driven: StudyCases, quantity: str, method: float) -> float:
    """The largest difference of a quantity right and left on one road, rounded to a thousandth."""
    right, left = (
        _seeds(driven, f"{quantity}_{side}", method, _IMPOSED_SPEED) for side in ("right", "left")
    )
    return round(max(abs(a - b) for a, b in zip(right, left, strict=True)), 3)


def product_of_tables(method: float) -> float:
    """Wheel times drive efficiency of table 5.6 [%]."""
    return (
        100.0
        * five_methods.BENCH_WHEEL_EFFICIENCY[int(method)]
        * five_methods.DRIVE_EFFICIENCY[int(method)]
    )


def gain_of_tables(driven: StudyCases, table: str, end: str, over: str) -> float:
    """Smallest or largest gain of method 1 by a table of the source, over method 1 or over the other one [%]."""
    return _ENDS[end](getattr(gains(getattr(five_methods, table)), over).values())


def gain_of_runs(driven: StudyCases, quantity: str, end: str) -> float:
    """The same of our runs, over method 1 [%]."""
    return _ENDS[end](gains(_means(driven, quantity, _IMPOSED_SPEED)).over_method_1.values())


def saving_of_table(driven: StudyCases, end: str) -> float:
    """Smallest or largest saving of energy by method 1 in table 5.6, in its unit."""
    return _ENDS[end](savings(five_methods.ENERGY).values())


def saving_of_runs(driven: StudyCases, end: str) -> float:
    """The same of our runs with driver pulse [kW min]."""
    return _ENDS[end](savings(_means(driven, "energy", "pulse")).values()) / KILOWATT_MINUTE
