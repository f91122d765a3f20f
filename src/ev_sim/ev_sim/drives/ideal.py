"""The ideal drive: the torque is the reference at once and without losses."""

from __future__ import annotations

from ev_sim.compiled import compiled
from ev_sim.drives.motor import torque_constant


@compiled
def advance_ideal(state, motor, torque_reference, speed):
    """Set the outputs of `state` to the reference [N m] at a shaft speed [rad/s]; see `drive.advance_drive`.

    The current is the one that the torque needs; the bus voltage limits nothing.
    """
    state.torque = torque_reference
    state.mean_torque = torque_reference
    state.current = torque_reference / torque_constant(motor)
    state.electrical_power = torque_reference * speed
