"""Torque that a limited-slip differential moves from the faster to the slower wheel of each driven axle."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.vehicle.car import Car


@compilable
def locking_share(ratio: float) -> float:
    """(K - 1)/(K + 1): locking torque over the torque of the axle [1], for a ratio K of at least 1."""
    return (ratio - 1.0) / (ratio + 1.0)


@compilable
def locked(car: Car, drive: Wheels, front_share: float, rear_share: float) -> Wheels:
    """The drive torques [N m] after locking of every axle of which both wheels are driven; the sums stay.

    M_slow - M_fast = (K - 1)/(K + 1) |M_slow + M_fast|, so M_slow/M_fast = K in traction (dissertation, section 1.2:
    K is the locking coefficient). The shares of the axles are (K - 1)/(K + 1) with the sign of w_left - w_right.
    """
    front, rear = 0.0, 0.0
    if car.driven[0] == 1.0 and car.driven[1] == 1.0:
        front = abs(drive[0] + drive[1]) / 2.0 * front_share
    if car.driven[2] == 1.0 and car.driven[3] == 1.0:
        rear = abs(drive[2] + drive[3]) / 2.0 * rear_share
    return Wheels(drive[0] - front, drive[1] + front, drive[2] - rear, drive[3] + rear)
