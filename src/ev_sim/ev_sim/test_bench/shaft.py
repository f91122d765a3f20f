"""The shaft between two machines."""

from __future__ import annotations

from typing import NamedTuple

from ev_msgs_py.compiling.compilable import inlined
from ev_sim.test_bench.parameters import ShaftParameters
from ev_sim.test_bench.state import CircuitState


class Motion(NamedTuple):
    """Over one step: torque in the shaft [N m], and the mean speeds of both machines [rad/s]."""

    torque: float
    speed: float
    load_speed: float


@inlined
def turn(
    p: ShaftParameters, s: CircuitState, inertia: float, load_inertia: float, torque: float, load: float, h: float
) -> Motion:
    """Turn two rotors by torques that are held over h [s], forwards positive.

        J_1 w_1' = M_1 - M,    J_2 w_2' = M + M_2 - b w_2,    M = k theta + d (w_1 - w_2),    theta' = w_1 - w_2

    Implicit midpoint rule: stable for any stiffness, and work = heat + what is stored, up to rounding.
    """
    free, free_load = 0.5 * h / inertia, 0.5 * h / load_inertia
    slowed = 1.0 + free_load * p.friction
    yielding = 0.5 * h * p.stiffness + p.damping
    apart = s.speed + free * torque - (s.load_speed + free_load * load) / slowed
    shaft = (p.stiffness * s.twist + yielding * apart) / (1.0 + yielding * (free + free_load / slowed))
    mean = s.speed + free * (torque - shaft)
    mean_load = (s.load_speed + free_load * (shaft + load)) / slowed
    s.twist += h * (mean - mean_load)
    s.speed += 2.0 * (mean - s.speed)
    s.load_speed += 2.0 * (mean_load - s.load_speed)
    return Motion(shaft, mean, mean_load)
