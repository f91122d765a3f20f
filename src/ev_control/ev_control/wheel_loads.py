"""Wheel loads of a rigid car on a level road, from its accelerations."""

from __future__ import annotations

from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import Wheels

_GRAVITY = 9.81  # [m/s^2]


class WheelLoads:
    """F_z = m (g b/L -+ h a_x/L)/2 -+ k h m a_y/t, with the front (b: rear) arm of the centre of mass.

    Dissertation, eqs 2.28 to 2.31, for a centre of mass in the car's middle; k is the axle's share of the roll moment.
    """

    def __init__(self, vehicle: Vehicle) -> None:
        front, roll = vehicle.centre_of_mass_to_rear_axle / vehicle.wheelbase, vehicle.front_roll_share
        half_mass, height = vehicle.mass / 2, vehicle.centre_of_mass_height
        along = half_mass * height / vehicle.wheelbase
        across = (
            2 * half_mass * height * roll / vehicle.front_track,
            2 * half_mass * height * (1 - roll) / vehicle.rear_track,
        )
        self.at_rest = Wheels(*(half_mass * _GRAVITY * front,) * 2, *(half_mass * _GRAVITY * (1 - front),) * 2)
        self._by_longitudinal = (-along, -along, along, along)
        self._by_lateral = (-across[0], across[0], -across[1], across[1])

    def of(self, place: int, longitudinal_acceleration: float, lateral_acceleration: float) -> float:
        """Load of a wheel [N] by its place in Wheels and the accelerations of the car to its front and left [m/s^2].

        Never below a tenth of the one at rest, where the car would be on three wheels.
        """
        load = self.at_rest[place] + self._by_longitudinal[place] * longitudinal_acceleration
        return max(load + self._by_lateral[place] * lateral_acceleration, 0.1 * self.at_rest[place])
