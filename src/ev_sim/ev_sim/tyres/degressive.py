"""The load that tyres with one curve do not carry in full."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.vehicle.tyre import Tyre


@inlined
def sensitivity(tyre: Tyre, load: float) -> float:
    """Share [1] of friction and slip stiffness over load that is left at a load [N].

    1 - e (N/N_0 - 1), the usual linear term; never below zero. Source: Pacejka, Tire and Vehicle Dynamics, 3rd ed.
    2012, eq 4.E13 has it as p_Dx2.
    """
    return max(1.0 - tyre.load_sensitivity * (load / tyre.nominal_load - 1.0), 0.0)
