"""The friction curve with two exponentials of Zhileykin."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import exp


@inlined
def friction(slip: float, full_slip: float, rise: float, fall: float, _fourth: float) -> float:
    """Friction use over slip, mu = mu_s (1 - exp(-S/S0)) (1 + exp(-S/S1)).

    Slip S [1] is at least 0; `full_slip` is mu_s [1], `rise` S0 and `fall` S1 [1]; returns [1].
    Source: Zhileykin & Eranosyan 2018, tyre model.
    """
    return full_slip * (1.0 - exp(-slip / rise)) * (1.0 + exp(-slip / fall))
