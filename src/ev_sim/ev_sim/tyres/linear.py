"""The linear tyre, for comparison with closed-form solutions."""

from ev_msgs_py.compiling.compilable import inlined


@inlined
def friction(slip: float, slope: float, _second: float, _third: float, _fourth: float) -> float:
    """Friction use over slip, mu = c S, without a peak.

    Slip S [1] is at least 0; `slope` is c, the slip stiffness per load [1]; returns [1].
    """
    return slope * slip
