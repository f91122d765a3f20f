"""One interface for all drives: torque reference and shaft speed in, torque, current and electrical power out."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import compilable, group, setting
from ev_sim.drives.averaged import AveragedDriveParameters, advance_averaged
from ev_sim.drives.brushless_motor import DriveState, MotorParameters, limited_reference, torque_constant
from ev_sim.drives.switched import SwitchedDriveParameters, advance_switched


@compilable
def advance_ideal(s: DriveState, motor: MotorParameters, torque_reference: float, speed: float) -> None:
    """Set the outputs of the state to the reference [N m] at a shaft speed [rad/s]; see `drive.advance_drive`.

    The current is the one that the torque needs; the bus voltage limits nothing.
    """
    s.torque = torque_reference
    s.mean_torque = torque_reference
    s.current = torque_reference / torque_constant(motor)
    s.electrical_power = torque_reference * speed


DRIVES = ("ideal", "averaged", "switched")
IDEAL, AVERAGED, SWITCHED = range(len(DRIVES))


@dataclass(frozen=True, slots=True)
class DriveParameters:
    """Drive model with its motor; a plant's parameters inherit from it to have the same names."""

    drive: str = setting("ideal", choices=DRIVES, about="depth of detail of the drives")
    motor: MotorParameters = group(MotorParameters)
    averaged: AveragedDriveParameters = group(AveragedDriveParameters)
    switched: SwitchedDriveParameters = group(SwitchedDriveParameters)


@compilable
def advance_drive(
    s: DriveState, p: DriveParameters, torque_reference: float, speed: float, bus_voltage: float, duration: float
) -> None:
    """Advance one drive over `duration` [s], the shaft speed held [rad/s].

    The reference [N m] is positive forwards and is limited to the motor's torque limit; `bus_voltage` is above zero
    [V].
    """
    reference = limited_reference(p.motor, torque_reference)
    if p.drive == IDEAL:
        advance_ideal(s, p.motor, reference, speed)
    elif p.drive == AVERAGED:
        advance_averaged(s, p.motor, p.averaged, reference, speed, bus_voltage, duration)
    else:
        advance_switched(s, p.motor, p.switched, reference, speed, bus_voltage, duration)
