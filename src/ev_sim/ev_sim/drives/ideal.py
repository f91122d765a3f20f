"""The ideal drive: the torque is the reference at once and without losses."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_sim.drives.motor import MotorParameters, torque_constant
from ev_sim.drives.state import DriveState


@compilable
def advance_ideal(s: DriveState, motor: MotorParameters, torque_reference: float, speed: float) -> None:
    """Set the outputs of the state to the reference [N m] at a shaft speed [rad/s]; see `drive.advance_drive`.

    The current is the one that the torque needs; the bus voltage limits nothing.
    """
    s.torque = torque_reference
    s.mean_torque = torque_reference
    s.current = torque_reference / torque_constant(motor)
    s.electrical_power = torque_reference * speed
