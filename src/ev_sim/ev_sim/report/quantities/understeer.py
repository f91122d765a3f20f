"""Understeer gradient and characteristic speed of any vehicle."""

from __future__ import annotations

import math

from ev_msgs_py.vehicle.car import GRAVITY
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.surfaces.table import REFERENCE, tyre_on_road
from ev_sim.tyres.curve import CURVES, SLIP_FLOOR, secant


def axle_cornering_stiffnesses(vehicle: Vehicle, surface: str = REFERENCE) -> tuple[float, float]:
    """Cornering stiffnesses C_1, C_2 of the front and the rear axle [N/rad] at static load, small slip and no drive.

    Those of a lateral line, or else the slope of the friction curve at zero slip on the surface, stretched by
    `lateral_ratio`, times the load of the axle.
    """
    tyre = vehicle.tyre
    if tyre.lateral_curve != "same":
        return 2 * tyre.front_cornering_stiffness, 2 * tyre.rear_cornering_stiffness
    on_road = tyre_on_road(tyre.curve, tyre.coefficients, surface)
    slope = tyre.lateral_ratio * secant(CURVES.index(tyre.curve), SLIP_FLOOR, on_road)
    front, rear = axle_masses(vehicle)
    return slope * front * GRAVITY, slope * rear * GRAVITY


def axle_masses(vehicle: Vehicle) -> tuple[float, float]:
    """Masses that the front and the rear axle carry on level ground [kg]."""
    front = vehicle.mass * vehicle.centre_of_mass_to_rear_axle / vehicle.wheelbase
    return front, vehicle.mass - front


def understeer_gradient(vehicle: Vehicle, surface: str = REFERENCE) -> float:
    """K_us = m_1/C_1 - m_2/C_2 [rad s^2/m], with the masses on the axles; above zero for an understeering car.

    delta = L/R + K_us V^2/R on a steady circle (ISO 4138 has the term).
    """
    front, rear = axle_masses(vehicle)
    front_stiffness, rear_stiffness = axle_cornering_stiffnesses(vehicle, surface)
    return front / front_stiffness - rear / rear_stiffness


def characteristic_speed(vehicle: Vehicle, surface: str = REFERENCE) -> float:
    """sqrt(L/K_us) [m/s], where the yaw response is largest; infinite unless the car understeers."""
    gradient = understeer_gradient(vehicle, surface)
    return math.sqrt(vehicle.wheelbase / gradient) if gradient > 0.0 else math.inf


def critical_speed(vehicle: Vehicle, surface: str = REFERENCE) -> float:
    """sqrt(-L/K_us) [m/s], where an oversteering car becomes unstable; infinite unless the car oversteers."""
    gradient = understeer_gradient(vehicle, surface)
    return math.sqrt(-vehicle.wheelbase / gradient) if gradient < 0.0 else math.inf
