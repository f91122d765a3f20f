"""Published claims that compare two runs: one quantity is larger, or smaller, in one of them."""

from __future__ import annotations

import math
from collections.abc import Callable

from ev_sim.report.metric import Band, Metric, NotMeasured, Reference, metric

LARGER: Band = (math.nextafter(1.0, 2.0), math.inf)  # bands of the ratio; equality is no difference
SMALLER: Band = (0.0, math.nextafter(1.0, 0.0))


def comparison(
    statement: str,
    band: Band,
    measure: Callable[[], float],
    against: Callable[[], float],
    unit: str,
    assumption: str = "",
) -> Metric:
    """The ratio [1] of two magnitudes, judged by a claim that is printed in words; both numbers stand in its source.

    `measure` and `against` give the quantity in `unit` with and without what the claim is about; `band` is LARGER or
    SMALLER.
    """
    try:
        value, other = abs(measure()), abs(against())
    except NotMeasured as why:
        return Metric(None, "1", Reference(1.0, band, f"printed in words: {statement}", assumption), str(why))
    source = f"printed in words: {statement}; measured {value:.5g} against {other:.5g} {unit}".removesuffix(" 1")
    return metric(lambda: value / other if other else math.inf, "1", Reference(1.0, band, source, assumption))
