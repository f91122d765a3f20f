"""Understeer gradient and characteristic speed of any vehicle."""

from __future__ import annotations

import math

from ev_core.vehicle.car import GRAVITY
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import AXLES
from ev_core.vehicle.tmeasy import tmeasy_tyre
from ev_core.vehicle.tyre import mf_tyres
from ev_msgs_py.refusal import ParameterError
from ev_sim.surfaces import REFERENCE, tyre_on_road
from ev_sim.tyres import tmeasy
from ev_sim.tyres.contact_patch import sensitivity
from ev_sim.tyres.curve import FRICTION_CURVES, SLIP_FLOOR, secant
from ev_sim.tyres.mf_tyre import cornering_stiffness


def axle_cornering_stiffnesses(
    vehicle: Vehicle, surface: str = REFERENCE, ahead: float = 1.0
) -> tuple[float, float]:
    """Cornering stiffnesses C_1, C_2 of front and rear axle [N/rad] at static load without drive.

    The slip is small. Those of the tyres with compliance steer, which turns front wheels out of the
    bend and rear ones into it: 1/C = 1/C_tyres + c in front and 1/C = 1/C_tyres - c behind. In
    reverse, `ahead` -1, the signs of c turn around: a wheel turned out of the bend then rolls more
    aside than before.
    """
    front, rear = tyre_cornering_stiffnesses(vehicle, surface)
    suspension = vehicle.suspension
    softened = 1.0 / (1.0 / front + ahead * suspension.front_compliance_steer)
    return softened, 1.0 / (1.0 / rear - ahead * suspension.rear_compliance_steer)


def tyre_cornering_stiffnesses(vehicle: Vehicle, surface: str = REFERENCE) -> tuple[float, float]:
    """Cornering stiffnesses of the tyres of both axles [N/rad].

    Those of a lateral line, or else the slope at zero slip of a curve in OF_LOAD at its static
    load, or of the friction curve on the surface, stretched by `lateral_ratio`, times the load of
    the axle, degressive as the tyre is.
    """
    tyre = vehicle.tyre
    loads = [mass * GRAVITY for mass in axle_masses(vehicle)]
    if tyre.lateral_curve != "same":
        return 2 * tyre.front_cornering_stiffness, 2 * tyre.rear_cornering_stiffness
    on_road = tyre_on_road(tyre, surface)
    if tyre.curve == "mf_tyre":
        tyres, scales = mf_tyres(tyre.front_mf, tyre.rear_mf), on_road[:2]
        front, rear = (
            2 * cornering_stiffness(tyres, 2 * n, load / 2, *scales) for n, load in enumerate(loads)
        )
        return front, rear
    if tyre.curve == "tmeasy":
        front, rear = (
            2 * tmeasy.cornering_stiffness(tmeasy_tyre(tyre.numbers(axle)), load / 2, *on_road[:2])
            for axle, load in zip(AXLES, loads, strict=True)
        )
        return front, rear
    if tyre.curve == "dry_friction":
        raise ParameterError(
            "vehicle.tyre.curve dry_friction has no cornering stiffness: it is one over slip speed"
        )
    slope = tyre.lateral_ratio * secant(FRICTION_CURVES.index(tyre.curve), SLIP_FLOOR, on_road)
    front, rear = (slope * load * sensitivity(tyre, load / 2) for load in loads)
    return front, rear


def axle_masses(vehicle: Vehicle) -> tuple[float, float]:
    """Masses that the front and the rear axle carry on level ground [kg]."""
    front = vehicle.mass * vehicle.centre_of_mass_to_rear_axle / vehicle.wheelbase
    return front, vehicle.mass - front


def understeer_gradient(vehicle: Vehicle, surface: str = REFERENCE, ahead: float = 1.0) -> float:
    """Gradient K_us = m_1/C_1 - m_2/C_2 [rad s^2/m]; above zero for an understeering car.

    The masses are those on the axles. delta = L/R + K_us V^2/R on a steady circle (ISO 4138 has the
    term). The steady yaw rate at a speed u, negative in reverse, is r = u delta/(L + K_us u |u|)
    with the stiffnesses of that direction, `ahead` 1 or -1: tyres push against their way aside
    wherever they roll, so that what understeers forwards turns more than a neutral car in reverse.
    """
    front, rear = axle_masses(vehicle)
    front_stiffness, rear_stiffness = axle_cornering_stiffnesses(vehicle, surface, ahead)
    return front / front_stiffness - rear / rear_stiffness


def characteristic_speed(vehicle: Vehicle, surface: str = REFERENCE) -> float:
    """Speed sqrt(L/K_us) [m/s] of the largest yaw response; infinite unless the car understeers."""
    gradient = understeer_gradient(vehicle, surface)
    return math.sqrt(vehicle.wheelbase / gradient) if gradient > 0.0 else math.inf


def critical_speed(vehicle: Vehicle, surface: str = REFERENCE) -> float:
    """Speed sqrt(-L/K_us) [m/s] from which a car that oversteers is unstable; else infinite."""
    gradient = understeer_gradient(vehicle, surface)
    return math.sqrt(-vehicle.wheelbase / gradient) if gradient < 0.0 else math.inf
