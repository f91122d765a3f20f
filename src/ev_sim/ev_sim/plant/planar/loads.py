"""Wheel loads: static share, load transfer, wheels that lift."""

from __future__ import annotations

from ev_sim.compiled import compiled


@compiled
def wheel_loads(
    normal: float,
    pitch_moment: float,
    roll_moment: float,
    rear_arm: float,
    wheelbase: float,
    front_track: float,
    rear_track: float,
    offset: float,
    front_roll_share: float,
) -> tuple[float, float, float, float]:
    """Loads of the four wheels [N]; their sum is always `normal`, none is below zero.

    `normal` [N] presses the car on the road; `pitch_moment` and `roll_moment` [N m] are the moments of the tyre
    forces about the centre of mass that unload the front axle and the left wheels; `rear_arm` [m] is the distance of
    the centre of mass from the rear axle, `offset` [m] its distance to the left of the middle. What an axle cannot
    take of its part of the roll moment, because a wheel has lifted, goes to the other axle (rigid frame).
    Source: Ge & Ni 2005, loads N_1..N_4; dissertation, eqs 2.28-2.31.
    """
    front = min(max((normal * rear_arm - pitch_moment) / wheelbase, 0.0), normal)
    rear = normal - front
    # The moment that an axle takes before a wheel lifts.
    front_limit = 0.5 * front * front_track
    rear_limit = 0.5 * rear * rear_track
    front_wanted = front_roll_share * roll_moment - front * offset
    rear_wanted = (1.0 - front_roll_share) * roll_moment - rear * offset
    front_excess = front_wanted - _within(front_wanted, front_limit)
    rear_excess = rear_wanted - _within(rear_wanted, rear_limit)
    front_taken = _within(front_wanted + rear_excess, front_limit)
    rear_taken = _within(rear_wanted + front_excess, rear_limit)
    # As shares of the limits, so that the load of a lifted wheel is exactly zero.
    front_share = front_taken / front_limit if front_limit > 0.0 else 0.0
    rear_share = rear_taken / rear_limit if rear_limit > 0.0 else 0.0
    return (
        0.5 * front * (1.0 - front_share),
        0.5 * front * (1.0 + front_share),
        0.5 * rear * (1.0 - rear_share),
        0.5 * rear * (1.0 + rear_share),
    )


@compiled
def _within(value: float, limit: float) -> float:
    return min(max(value, -limit), limit)
