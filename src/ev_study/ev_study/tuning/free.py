"""The numbers of a law that a search may change, within the bounds of their declarations."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase

from ev_core.lockstep.configuration import Configuration
from ev_core.parameters.declaration import Spec, entries
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_study.benchmark.board import ROLE
from ev_study.benchmark.draws import BELIEF

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
        """True if the logarithm of the parameter is drawn evenly."""
        return self.low > 0.0

    def value(self, share: float) -> float:
        """The value at a share of the way from the lower to the upper bound."""
        share = min(max(share, 0.0), 1.0)
        if self.by_factors:
            # The power may leave the bounds by a rounding, which the declaration would refuse.
            return min(max(self.low * (self.high / self.low) ** share, self.low), self.high)
        return self.low + share * (self.high - self.low)

    @property
    def share(self) -> float:
        """That of the start."""
        if self.by_factors:
            # The inverse of `value`.
            return math.log(self.start / self.low) / math.log(self.high / self.low)
        return (self.start - self.low) / (self.high - self.low)


def free_parameters(
    law: str, configurations: Mapping[str, Configuration], patterns: Sequence[str]
) -> list[Free]:
    """Numbers of a law with fitting names, as a board names them, but none that the board draws.

    Raises ParameterError if a pattern fits none, if one that fits has no bounds and no positive
    start, or if fewer than two fit: CMA-ES needs two.
    """
    known = {}
    for role, configuration in configurations.items():
        for each in entries(configuration.parameters):
            if (
                each.type is float
                and not (each.is_array or each.spec.read_only)
                and not configuration.method.is_idle(each.name)
                # What a law believes of the friction is drawn by the board.
                and each.name not in BELIEF
            ):
                known[each.name if role == ROLE else f"{role}.{each.name}"] = each
    for pattern in patterns:
        if not any(fnmatchcase(name, pattern) for name in known):
            raise unknown_name(f"number of law {law}", pattern, known)
    fitting = {
        name: of
        for name, of in known.items()
        if any(fnmatchcase(name, pattern) for pattern in patterns)
    }
    found = [_free(law, name, float(of.default), of.spec) for name, of in fitting.items()]
    if len(found) < 2:
        raise ParameterError(
            f"free numbers {quoted(','.join(patterns))} of law {law} mean {len(found)}, expected"
            " two or more"
        )
    return found


def _free(law: str, name: str, start: float, spec: Spec) -> Free:
    """A number within its declared bounds; a positive start has some of its own as well."""
    low, high = spec.low, spec.high
    if start > 0.0:
        low, high = start * 10.0**-REACH, start * 10.0**REACH
        # The declared bound where it is nearer.
        low = low if spec.low is None else max(low, spec.low)
        high = high if spec.high is None else min(high, spec.high)
    if low is None or high is None:
        raise ParameterError(
            f"number {name} of law {law} starts at {start:g} and has no bounds on both sides,"
            " expected are low= and high= where it is declared, or other numbers by --free"
        )
    if not low < high:
        raise ParameterError(
            f"number {name} of law {law} has nothing between {low:g} and {high:g}, expected a range"
        )
    return Free(name, start, low, high)
