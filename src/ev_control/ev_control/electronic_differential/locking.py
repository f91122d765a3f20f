"""Torque that a limited-slip differential moves from the faster to the slower wheel of each driven axle."""

from __future__ import annotations

from collections.abc import Callable

from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import WHEEL_NAMES, Wheels

_AXLES = ((0, 1), (2, 3))


class Locking:
    """Lock every axle of which both wheels are driven by a ratio K of the torques of its slower and faster wheel.

    M_slow - M_fast = (K - 1)/(K + 1) |M_slow + M_fast|, so M_slow/M_fast = K in traction (dissertation, section 1.2:
    K is the locking coefficient); the sum stays. `signed_share` gives (K - 1)/(K + 1) with the sign of the speed
    difference w_left - w_right [rad/s].
    """

    def __init__(self, vehicle: Vehicle, signed_share: Callable[[float], float]) -> None:
        driven = [name in vehicle.driven_wheels for name in WHEEL_NAMES]
        self._axles = [(left, right) for left, right in _AXLES if driven[left] and driven[right]]
        self._signed_share = signed_share

    def locked(self, drive: Wheels, velocity: Wheels) -> Wheels:
        """The drive torques [N m] after locking, at these wheel speeds [rad/s]."""
        torques = list(drive)
        for left, right in self._axles:
            moved = abs(torques[left] + torques[right]) / 2 * self._signed_share(velocity[left] - velocity[right])
            torques[left] -= moved
            torques[right] += moved
        return Wheels(*torques)


def locking_share(ratio: float) -> float:
    """(K - 1)/(K + 1): locking torque over the torque of the axle [1], for a ratio K of at least 1."""
    return (ratio - 1.0) / (ratio + 1.0)
