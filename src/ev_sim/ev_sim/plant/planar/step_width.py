"""The longest step that suits the fastest motion of a car."""

from __future__ import annotations

from ev_msgs_py.vehicle import Vehicle

# Largest product of step and eigenvalue; the Runge-Kutta method is stable up to 2.78, and at half of that the motion
# that decays within a step is still no worse than it would be if it were exact.
LARGEST_PRODUCT = 1.4


def longest_step(vehicle: Vehicle) -> float:
    """The longest step [s] at which every motion against the carcass springs is stable.

    A mass m_e on a spring k with a damper k tau has eigenvalues of magnitude sqrt(k/m_e) if it oscillates, and of at
    most k tau/m_e if it does not; sliding in the contact only softens that. m_e is the least inertia that a carcass can
    move: the wheel's J/r^2, the car's m/4 and, for its yaw, J_z over four squared levers.
    """
    tyre = vehicle.tyre
    squared_lever = vehicle.wheelbase**2 + max(vehicle.front_track, vehicle.rear_track) ** 2
    body = min(vehicle.mass / 4.0, vehicle.yaw_inertia / (4.0 * squared_lever))
    wheel = min(vehicle.wheel_inertia / vehicle.wheel_radius**2, body)
    fastest = max(
        _fastest(tyre.longitudinal_stiffness, tyre.longitudinal_damping_time, wheel),
        _fastest(tyre.lateral_stiffness, tyre.lateral_damping_time, body),
    )
    return LARGEST_PRODUCT / fastest


def _fastest(stiffness: float, damping_time: float, mass: float) -> float:
    squared = stiffness / mass
    return max(squared**0.5, squared * damping_time, 1.0 / damping_time)
