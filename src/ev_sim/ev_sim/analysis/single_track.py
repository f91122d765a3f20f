"""The linear single-track model of a car on its own tyres, carcasses and compliance steer included."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.signal import StateSpace

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.surfaces.table import REFERENCE
from ev_sim.vehicle.understeer import (
    axle_cornering_stiffnesses,
    axle_masses,
    tyre_cornering_stiffnesses,
)


@dataclass(frozen=True, slots=True)
class Axle:
    """One axle: place [m] ahead of the centre of mass, and how it bends and slides."""

    place: float
    steered: float  # share of the road-wheel angle [1]
    stiffness: float  # C of both tyres [N/rad]
    carcass: float  # of both tyres [N/m]
    damping: float  # of both tyres [N s/m]
    turning: float  # angle that a side force adds, positive to the left [rad/N]


def single_track(vehicle: Vehicle, speed: float, surface: str = REFERENCE) -> StateSpace:
    """X' = A x + B delta, y = C x + D delta with x = lateral velocity, yaw rate, deflection of both axles' carcasses.

    Outputs are lateral velocity [m/s] and yaw rate [rad/s], speed [m/s] is constant and above zero. A tyre of first
    order (Rill 2006): u' = (C v_s - V k u)/(C + V d), F = k u + d u', with v_s across the wheel, which compliance steer
    turns. No rolling resistance, no drag, no load transfer, which do not act to first order.
    """
    rear = vehicle.centre_of_mass_to_rear_axle
    front_stiffness, rear_stiffness = tyre_cornering_stiffnesses(vehicle, surface)
    tyre, suspension = vehicle.tyre, vehicle.suspension
    carcass, damping = 2 * tyre.lateral_stiffness, 2 * tyre.lateral_stiffness * tyre.lateral_damping_time
    front_turning, rear_turning = -suspension.front_compliance_steer, suspension.rear_compliance_steer
    axles = (
        Axle(vehicle.wheelbase - rear, 1.0, front_stiffness, carcass, damping, front_turning),
        Axle(-rear, vehicle.rear_steering_ratio, rear_stiffness, carcass, damping, rear_turning),
    )
    a, b = np.zeros((4, 4)), np.zeros((4, 1))
    a[0, 1] = -speed
    for n, axle in enumerate(axles):
        slip, by_angle = np.zeros(4), speed * axle.steered  # v_s as a row of the state, and by the road-wheel angle
        slip[0], slip[1], slip[2 + n] = -1.0, -axle.place, speed * axle.turning * axle.carcass
        renewal = axle.stiffness + speed * axle.damping
        a[2 + n] = axle.stiffness / renewal * slip
        a[2 + n, 2 + n] -= speed * axle.carcass / renewal
        b[2 + n, 0] = axle.stiffness / renewal * by_angle
        force = axle.damping * a[2 + n]
        force[2 + n] += axle.carcass
        for state, inertia in ((0, vehicle.mass), (1, vehicle.yaw_inertia / axle.place)):
            a[state] += force / inertia
            b[state, 0] += axle.damping * b[2 + n, 0] / inertia
    return StateSpace(a, b, np.eye(2, 4), np.zeros((2, 1)))


def yaw_gain(system: StateSpace) -> float:
    """Steady yaw rate over road-wheel angle [1/s]."""
    return float((system.D - system.C @ np.linalg.solve(system.A, system.B))[1, 0])


def yaw_damping(system: StateSpace) -> tuple[float, float]:
    """Damping ratio [1] and undamped frequency [rad/s] of the slowest pair of poles, of two real ones as of a pair."""
    slowest = sorted(np.linalg.eigvals(system.A), key=lambda pole: -pole.real)[:2]
    product, total = (slowest[0] * slowest[1]).real, -(slowest[0] + slowest[1]).real
    frequency = math.sqrt(product) if product > 0.0 else math.nan
    return total / (2.0 * frequency), frequency


def tangent_speed(vehicle: Vehicle, surface: str = REFERENCE) -> float:
    """Speed at which a car goes round a bend without sideslip at its centre of mass [m/s]: sqrt(b C_2/m_2).

    With C_2 as compliance steer leaves it; infinite for a car without load on its rear axle.
    """
    mass, stiffness = axle_masses(vehicle)[1], axle_cornering_stiffnesses(vehicle, surface)[1]
    return math.sqrt(vehicle.centre_of_mass_to_rear_axle * stiffness / mass) if mass > 0.0 else math.inf
