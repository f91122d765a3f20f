"""Parameters at the ends of their ranges.

An index that is right for the defaults may leave its row there.
"""

from __future__ import annotations

import math

from ev_core.check.stepping import MakesInputs, Subject, outputs
from ev_core.lockstep.configuration import Configuration
from ev_core.parameters.declaration import entries
from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.refusal import ParameterError

_STEPS = 20  # with each end: a wrong index shows in the first of them


def out_of_range(configuration: Configuration, seed: int, inputs: MakesInputs) -> str:
    """The first index out of range with one parameter of a law at an end of its range.

    Empty if there is none.
    """
    for entry in entries(configuration.parameters):
        if entry.type not in (int, float) or entry.is_array:
            continue
        for end in (entry.spec.low, entry.spec.high):
            if end is None or not math.isfinite(end):
                continue
            try:
                changed = configuration.changed({entry.name: entry.type(end)})
                there = Subject(changed, False, _STEPS, inputs)
                outputs(there.part(), there.frames(seed))
            except (ParameterError, SignalError) as error:
                # Other refusals are right: a value at an end need not go with the others.
                if isinstance(error.__cause__, IndexError):
                    return f"with {entry.name} at {end:g}, {error}"
    return ""
