"""The rational friction curve of Ge & Ni."""

from ev_msgs_py.compiling.compilable import inlined


@inlined
def friction(slip: float, peak: float, peak_slip: float, _third: float, _fourth: float) -> float:
    """Friction use over slip, mu = 2 mu_p l_p l / (l^2 + l_p^2).

    Slip l [1] is at least 0; `peak` is mu_p [1] at the slip `peak_slip` l_p [1]; returns [1].
    Source: Ge & Ni 2005, tyre model.
    """
    return 2.0 * peak * peak_slip * slip / (slip * slip + peak_slip * peak_slip)
