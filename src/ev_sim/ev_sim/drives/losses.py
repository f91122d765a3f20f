"""Losses of motor and inverter, from coefficients or an efficiency map, and the heat that they bring.

Heat in winding and power stage: one capacity each, one resistance to one coolant, derating.
The winding takes the copper loss, the power stage what grows with the torque; iron, windage and the idle loss of the
electronics go from the housing into the air (assumption).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ev_core.vehicle.motor import Motor, ThermalParameters
from ev_msgs_py.compilable import inlined
from ev_sim.surfaces.table import segment_at


@inlined
def loss_power(motor: Motor, torque: float, speed: float) -> float:
    """Loss [W] at a shaft torque [N m] and speed [rad/s]: copper, iron and inverter losses.

    P = k_c T^2 + k_i |w| + k_e w^2 + P_0 + k_t |T|. The usual separation of losses, as in
    Larminie & Lowry, Electric Vehicle Technology Explained, 2nd ed. 2012, chapter on electric machines; the eddy and
    inverter terms are added here.
    """
    turns = abs(speed)
    of_torque, of_speed = motor.copper_loss * torque * torque, motor.iron_loss * turns
    of_inverter = motor.inverter_torque_loss * abs(torque)
    return of_torque + of_speed + motor.eddy_loss * turns * turns + motor.inverter_loss + of_inverter


@inlined
def map_loss_power(
    torque: float, speed: float, speeds: Sequence[float], torques: Sequence[float], efficiency: Sequence[float]
) -> float:
    """Loss [W] from an efficiency map, for each speed a row over the torques, bilinear, its edge kept outside.

    Driving P_loss = |P| (1/eta - 1), generating P_loss = |P| (1 - eta), with P the mechanical power. Towards standstill
    P vanishes but the copper loss does not: below the lowest speed of the map above zero the driving loss stays what it
    is there, and the generating loss goes over into it linearly, so that both are one at rest.
    """
    lowest = speeds[0] if speeds[0] > 0.0 else speeds[1]
    turns, magnitude = max(abs(speed), lowest), abs(torque)
    i, share_i = _place(speeds, turns)
    j, share_j = _place(torques, magnitude)
    below, above = i * len(torques) + j, (i + 1) * len(torques) + j
    low = efficiency[below] + share_j * (efficiency[below + 1] - efficiency[below])
    high = efficiency[above] + share_j * (efficiency[above + 1] - efficiency[above])
    eta = low + share_i * (high - low)
    driving = magnitude * turns * (1.0 / eta - 1.0)
    if torque * speed >= 0.0:
        return driving
    generating = magnitude * turns * (1.0 - eta)
    share = min(abs(speed) / lowest, 1.0)
    return (1.0 - share) * driving + share * generating


@inlined
def _place(axis: Sequence[float], value: float) -> tuple[int, float]:
    index = min(segment_at(axis, value, 0), len(axis) - 2)
    share = (value - axis[index]) / (axis[index + 1] - axis[index])
    return index, min(max(share, 0.0), 1.0)


def map_loss_powers(
    torque: np.ndarray,
    speed: np.ndarray,
    speeds: Sequence[float],
    torques: Sequence[float],
    efficiency: Sequence[float],
) -> np.ndarray:
    """`losses.map_loss_power` [W] at each pair of shaft torque [N m] and speed [rad/s], all (n,)."""
    lowest = speeds[0] if speeds[0] > 0.0 else speeds[1]
    turns, magnitude = np.maximum(np.abs(speed), lowest), np.abs(torque)
    i, share_i = _places(speeds, turns)
    j, share_j = _places(torques, magnitude)
    table = np.reshape(efficiency, (len(speeds), len(torques)))
    low = table[i, j] + share_j * (table[i, j + 1] - table[i, j])
    high = table[i + 1, j] + share_j * (table[i + 1, j + 1] - table[i + 1, j])
    eta = low + share_i * (high - low)
    driving, generating = magnitude * turns * (1.0 / eta - 1.0), magnitude * turns * (1.0 - eta)
    share = np.minimum(np.abs(speed) / lowest, 1.0)
    return np.where(torque * speed >= 0.0, driving, (1.0 - share) * driving + share * generating)


def _places(axis: Sequence[float], values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    points = np.array(axis)
    index = np.clip(np.searchsorted(points, values, side="right") - 1, 0, len(points) - 2)
    share = (values - points[index]) / (points[index + 1] - points[index])
    return index, np.clip(share, 0.0, 1.0)


_COOLANT = 60.0e3 / (3.5e3 * 1.06e3)  # K per W at 1 l/min: water with glycol, 3.5 kJ/(kg K), 1.06 kg/l, in l/min


@inlined
def heated(rise: float, power: float, resistance: float, left: float) -> float:
    """Rise above what cools [K] after a step under a power [W]: C T' = P - T/R, exactly, with left = exp(-h/(R C))."""
    final = power * resistance
    return final + (rise - final) * left


@inlined
def coolant_outlet_temperature(p: ThermalParameters, winding_rise: float, inverter_rise: float) -> float:
    """Warmer than the inlet by the heat that winding and power stage give off at these rises [K]: in degC."""
    heat = winding_rise / p.winding_resistance + inverter_rise / p.inverter_resistance
    return p.coolant + heat * _COOLANT / p.coolant_flow


@inlined
def derating_share(p: ThermalParameters, winding: float, inverter: float) -> float:
    """Share of the torque that temperatures [degC] leave [1]: 1 up to the warm ones, 0 at the limits."""
    of_winding = (p.winding_limit - winding) / (p.winding_limit - p.winding_warm)
    of_inverter = (p.inverter_limit - inverter) / (p.inverter_limit - p.inverter_warm)
    return min(max(min(of_winding, of_inverter), 0.0), 1.0)
