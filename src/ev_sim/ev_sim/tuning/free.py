"""The numbers of a law that a search may change, within the bounds of their declarations."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

from ev_core.lockstep.configuration import Configuration
from ev_core.parameters.declaration import entries
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_sim.benchmark.board import ROLE
from ev_sim.benchmark.draws import BELIEF

REACH = 2.0  # decades either way of a positive start, within the declared bounds


@dataclass(frozen=True, slots=True)
class Free:
    """A parameter that is tuned: its start, and bounds of the value that the optimiser sees, which is in 0 to 1.

    A positive start is changed by factors, any other one by sums.
    """

    name: str
    start: float
    low: float
    high: float

    @property
    def by_factors(self) -> bool:
        """Whether its logarithm is even."""
        return self.low > 0.0

    def value(self, share: float) -> float:
        """The value at a share of the way from the lower to the upper bound."""
        share = min(max(share, 0.0), 1.0)
        if self.by_factors:
            return min(max(self.low * (self.high / self.low) ** share, self.low), self.high)
        return self.low + share * (self.high - self.low)

    @property
    def share(self) -> float:
        """That of the start."""
        if self.by_factors:
            return math.log(self.start / self.low) / math.log(self.high / self.low)
        return (self.start - self.low) / (self.high - self.low)


def free_parameters(law: str, configurations: Mapping[str, Configuration], patterns: Sequence[str]) -> list[Free]:
    """The numbers of a law whose names fit, as a board names them, except what the board draws for it.

    ParameterError if a pattern fits none, or if fewer than two fit: CMA-ES needs two.
    """
    known = {}
    for role, configuration in configurations.items():
        for each in entries(configuration.parameters):
            if each.type is float and not (each.is_array or each.spec.read_only) and each.name not in BELIEF:
                name, start = each.name if role == ROLE else f"{role}.{each.name}", float(each.default)
                known[name] = Free(name, start, *_bounds(start, each.spec.low, each.spec.high))
    for pattern in patterns:
        if not any(fnmatchcase(name, pattern) for name in known):
            raise unknown_name(f"number of law {law}", pattern, known)
    found = [free for name, free in known.items() if any(fnmatchcase(name, pattern) for pattern in patterns)]
    if len(found) < 2:
        raise ParameterError(
            f"free numbers {quoted(','.join(patterns))} of law {law} mean {len(found)}, allowed are two or more"
        )
    return found


def _bounds(start: float, low: float, high: float) -> tuple[float, float]:
    if start <= 0.0:
        return low, high
    return max(low, start * 10.0**-REACH), min(high, start * 10.0**REACH)
