"""Numbers that a caller gives in the place of a role that is left out."""

from __future__ import annotations

import math
from typing import Annotated

from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import NEGLIGIBLE
from ev_msgs_py.refusal import ParameterError, quoted

Number = Annotated[float, "a finite number"]


def taken_input(name: str, place: int, value: float) -> float:
    """An input as it is taken at its place of the frame.

    Raises ParameterError unless it is finite, and 0 or more if due.
    """
    if not math.isfinite(value):
        raise ParameterError(f"input {name}: {quoted(value)} is refused, expected a finite number")
    if place not in frame.UNSIGNED_COMMANDS or value >= 0.0:
        return value
    if value < -NEGLIGIBLE:
        raise ParameterError(f"input {name}: {quoted(value)} is refused, expected 0 or more")
    # A negative number within rounding, such as of a learner's scaled output, counts as none.
    return 0.0
