"""A brushless motor one of whose three Hall sensors always shows 1."""

from __future__ import annotations

from math import tau

from ev_msgs_py.compiling.compilable import compilable


@compilable
def torque_share(electrical_angle: float) -> float:
    """Torque over that of right commutation with the same current [1], at an angle of the rotor [rad].

    Of the six codes 101 100 110 010 011 001 the stuck sensor, the first one, falsifies three: 010 reads 110, a sector
    late, 011 reads 111, which no rotor shows and at which the bridge blocks, and 001 reads 101, a sector early. The
    pair of phases of the sector before loses its EMF over the sector in the line, that of the sector behind gains it.
    The mean is 2/3, and in one sector the motor cannot pull away.
    """
    turn = electrical_angle / tau
    place = 6.0 * (turn - float(int(turn)))
    if place < 0.0:
        place += 6.0
    if place < 3.0:
        return 1.0
    if place < 4.0:
        return 4.0 - place
    return 0.0 if place < 5.0 else place - 5.0
