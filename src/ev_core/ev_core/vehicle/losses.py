"""Losses of motor and inverter, by coefficients and by an efficiency map."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ev_core.vehicle.motor import Motor
from ev_msgs_py.compilable import inlined
from ev_msgs_py.refusal import ParameterError


class EfficiencyMap(NamedTuple):
    """Shaft speeds [rad/s], shaft torques [N m], and for each speed a row of efficiencies [1].

    Empty without a map.
    """

    speed: tuple[float, ...]
    torque: tuple[float, ...]
    efficiency: tuple[float, ...]


NO_MAP = EfficiencyMap((), (), ())


def efficiency_map(motor: Motor) -> EfficiencyMap:
    """The map of a motor; ParameterError if it is still in a file."""
    if motor.map_file:
        raise ParameterError(
            f"vehicle.motor.map_file: {motor.map_file} has not been read into the map"
        )
    return EfficiencyMap(motor.map_speed, motor.map_torque, motor.map_efficiency)


@inlined
def loss_power(motor: Motor, torque: float, speed: float) -> float:
    """Loss [W] at a shaft torque [N m] and speed [rad/s]: copper, iron and inverter losses.

    P = k_c T^2 + k_i |w| + k_e w^2 + P_0 + k_t |T|. The usual separation of losses, as in
    Larminie & Lowry, Electric Vehicle Technology Explained, 2nd ed. 2012, chapter on electric
    machines; the eddy and inverter terms are added here.
    """
    turns = abs(speed)
    of_torque, of_speed = motor.copper_loss * torque * torque, motor.iron_loss * turns
    of_inverter = motor.inverter_torque_loss * abs(torque)
    return (
        of_torque + of_speed + motor.eddy_loss * turns * turns + motor.inverter_loss + of_inverter
    )


@inlined
def map_loss_power(
    torque: float,
    speed: float,
    speeds: Sequence[float],
    torques: Sequence[float],
    efficiency: Sequence[float],
) -> float:
    """Loss [W] from an efficiency map, bilinear, with its edge kept outside.

    Driving P_loss = |P| (1/eta - 1), generating P_loss = |P| (1 - eta), with P the mechanical
    power, for each speed a row over the torques. Towards standstill P vanishes but the copper loss
    does not: below the lowest speed of the map above zero the driving loss stays what it is there,
    and the generating loss goes over into it linearly, so that both are one at rest.
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
    index = 0
    while index + 2 < len(axis) and value >= axis[index + 1]:
        index += 1
    share = (value - axis[index]) / (axis[index + 1] - axis[index])
    return index, min(max(share, 0.0), 1.0)
