"""Estimators that packages offer by entry points, for records of real cars."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ev_core.methods.offered import offered, offered_module
from ev_msgs_py.refusal import ParameterError

# of entry points: the name of a package, and its module with `ESTIMATORS`
GROUP = "ev_stack.estimators"


class Estimator(NamedTuple):
    """An estimator over a record.

    `over(p, car, period, given)` is what it makes of signals by channel. `p` are numbers of
    `parameters` and `car` those of the vehicle, as laws have them, the period is in seconds,
    signals are (n,), without a gap, in SI and REP-103. `given` has the channels of `reads`, and of
    `may_read` those that were measured. The answer, (n,), is what it makes of the channel
    `estimates` at each instant, from a start at which it knows nothing.
    """

    parameters: type[Any]
    reads: tuple[str, ...]
    may_read: tuple[str, ...]
    estimates: str
    over: Callable[[Any, Any, float, Mapping[str, np.ndarray]], np.ndarray]


@cache
def estimators() -> dict[str, Estimator]:
    """All estimators that are offered, by name.

    ParameterError if a module is not loaded, or if two offer one by one name.
    """
    found: dict[str, Estimator] = {}
    for package in offered(GROUP):
        for name, each in offered_module(GROUP, "estimators", package).ESTIMATORS.items():
            if name in found:
                raise ParameterError(
                    f"the estimator {name} of {package} is there already, expected another name"
                )
            found[name] = each
    return found
