"""Wheel loads: static share, load transfer, wheels that lift."""

from __future__ import annotations

from collections.abc import Sequence

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.vehicle.car import Car
from ev_sim.plant.planar.state import TRANSFER_X, TRANSFER_Y


@inlined
def loads(y: Sequence[float], car: Car, gravity_z: float) -> Wheels:
    """Loads of the four wheels [N] in a state, under gravity that presses the car on the road [m/s^2]."""
    pitch_arm, roll_arm = car.pitch_height * car.mass, car.roll_height * car.mass
    return wheel_loads(car, car.mass * gravity_z, pitch_arm * y[TRANSFER_X], roll_arm * y[TRANSFER_Y])


@inlined
def wheel_loads(car: Car, normal: float, pitch_moment: float, roll_moment: float) -> Wheels:
    """Loads of the four wheels [N]; their sum is always `normal`, none is below zero.

    `normal` [N] presses the car on the road; `pitch_moment` and `roll_moment` [N m] are the moments of the tyre
    forces about the centre of mass that unload the front axle and the left wheels. What an axle cannot take of its
    part of the roll moment, because a wheel has lifted, goes to the other axle (rigid frame).
    Source: Ge & Ni 2005, loads N_1..N_4; dissertation, eqs 2.28-2.31.
    """
    offset, share = car.centre_of_mass_offset, car.front_roll_share
    front = min(max((normal * car.centre_of_mass_to_rear_axle - pitch_moment) / car.wheelbase, 0.0), normal)
    rear = normal - front
    # The moment that an axle takes before a wheel lifts.
    front_limit = 0.5 * front * car.front_track
    rear_limit = 0.5 * rear * car.rear_track
    front_wanted = share * roll_moment - front * offset
    rear_wanted = (1.0 - share) * roll_moment - rear * offset
    front_excess = front_wanted - _within(front_wanted, front_limit)
    rear_excess = rear_wanted - _within(rear_wanted, rear_limit)
    front_taken = _within(front_wanted + rear_excess, front_limit)
    rear_taken = _within(rear_wanted + front_excess, rear_limit)
    # As shares of the limits, so that the load of a lifted wheel is exactly zero.
    front_share = front_taken / front_limit if front_limit > 0.0 else 0.0
    rear_share = rear_taken / rear_limit if rear_limit > 0.0 else 0.0
    return Wheels(
        0.5 * front * (1.0 - front_share),
        0.5 * front * (1.0 + front_share),
        0.5 * rear * (1.0 - rear_share),
        0.5 * rear * (1.0 + rear_share),
    )


@inlined
def _within(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)
