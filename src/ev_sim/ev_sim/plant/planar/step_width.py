"""The longest step that suits the fastest motion of a car."""

from __future__ import annotations

from ev_msgs_py.elementary import sqrt
from ev_msgs_py.parameters.declaration import ParameterError
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.drives.motor import MotorParameters, torque_constant

# Largest product of step and eigenvalue; the Runge-Kutta method is stable up to 2.78, and at half of that the motion
# that decays within a step is still no worse than it would be if it were exact.
LARGEST_PRODUCT = 1.4
# The same for brushless DC drives, which take turns with the wheels: far below the limit of 2 of such schemes.
BRUSHLESS_PRODUCT = 0.4
SHORTEST_STEP = 1e-5  # [s], the least that the parameter `step` may be


def longest_step(vehicle: Vehicle) -> float:
    """The longest step [s] at which every motion against the carcass springs is stable.

    A mass m_e on a spring k with a damper k tau has eigenvalues of magnitude sqrt(k/m_e) if it oscillates, and of at
    most k tau/m_e if it does not; sliding in the contact only softens that. m_e is the least inertia that a carcass can
    move: the wheel's J/r^2, the car's m/4 and, for its yaw, J_z over four squared levers. ParameterError if the step
    would be below `SHORTEST_STEP`. The converter of an engine asks for none: its stiffness follows the speed, and its
    torques are taken implicitly where they need it (drives/engine.py).
    """
    tyre = vehicle.tyre
    widest = max(vehicle.front_track, vehicle.rear_track)
    squared_lever = vehicle.wheelbase * vehicle.wheelbase + widest * widest
    body = min(vehicle.mass / 4.0, vehicle.yaw_inertia / (4.0 * squared_lever))
    radius = vehicle.wheel_radius * max(vehicle.wheel_radius_ratio)
    lightest = vehicle.wheel_inertia * min(vehicle.undriven_inertia_ratio, 1.0)
    wheel = min(lightest / (radius * radius), body)
    fastest = max(
        _fastest(tyre.longitudinal_stiffness, tyre.longitudinal_damping_time, wheel),
        _fastest(tyre.lateral_stiffness, tyre.lateral_damping_time, body),
    )
    step = LARGEST_PRODUCT / fastest
    if step < SHORTEST_STEP:
        raise ParameterError(
            f"vehicle.tyre: stiffness and damping_time need steps of {step:.2g} s with wheels of "
            f"{lightest:g} kg m^2 and a car of {vehicle.mass:g} kg, allowed is {SHORTEST_STEP:g} s or more"
        )
    return step


def longest_brushless_step(vehicle: Vehicle, motor: MotorParameters) -> float:
    """The longest step [s] over which a brushless DC drive may see one shaft speed.

    Without voltage to spare its current swings against the wheel with n k/sqrt(2 L J_w), torque constant k behind the
    gear ratio n.
    """
    constant = vehicle.gear_ratio * torque_constant(motor)
    return BRUSHLESS_PRODUCT / constant * sqrt(2.0 * motor.inductance * vehicle.wheel_inertia)


def _fastest(stiffness: float, damping_time: float, mass: float) -> float:
    squared = stiffness / mass
    return max(sqrt(squared), squared * damping_time, 1.0 / damping_time)
