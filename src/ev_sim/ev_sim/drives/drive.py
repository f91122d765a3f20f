"""One interface for all drives: torque reference and shaft speed in, torque, current and electrical power out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ev_msgs_py.parameters import group, parameter
from ev_sim.compiled import compiled
from ev_sim.drives.averaged import AveragedDriveParameters, advance_averaged
from ev_sim.drives.ideal import advance_ideal
from ev_sim.drives.motor import MotorParameters, limited_torque
from ev_sim.drives.records import record_of
from ev_sim.drives.switched import SECTOR, SwitchedDriveParameters, advance_switched

DRIVES = ("ideal", "averaged", "switched")
IDEAL, AVERAGED, SWITCHED = range(len(DRIVES))

DRIVE_STATE = np.dtype(
    [
        # Outputs of every drive
        ("torque", np.float64),  # electromagnetic, at the shaft, now [N m]
        ("current", np.float64),  # in at one phase and out at another, now [A]
        ("mean_torque", np.float64),  # over the last advance [N m]
        ("electrical_power", np.float64),  # from the bus, mean over the last advance [W]
        # PI current control
        ("voltage_integral", np.float64),  # [V]
        # Switched drive
        ("high_current", np.float64),  # into the phase on its positive EMF flat [A]
        ("off_current", np.float64),  # into the phase that is switched off [A]
        ("voltage_sign", np.float64),  # 1: the high phase is on the upper rail, -1: on the lower
        ("sector_angle", np.float64),  # electrical, from the lower edge of the Hall sector [rad]
        ("sector", np.int64),  # Hall sector, 0 to 5
    ]
)


@dataclass(frozen=True, slots=True)
class DriveParameters:
    """Drive model with its motor; a plant's parameters inherit from it to have the same names."""

    drive: str = parameter("ideal", choices=DRIVES, about="depth of detail of the drives")
    motor: MotorParameters = group(MotorParameters)
    averaged: AveragedDriveParameters = group(AveragedDriveParameters)
    switched: SwitchedDriveParameters = group(SwitchedDriveParameters)


def drives_at_rest(count: int) -> np.ndarray:
    """States of `count` drives without current, shape (count,) of DRIVE_STATE."""
    states = np.zeros(count, DRIVE_STATE)
    states["voltage_sign"] = 1.0
    states["sector_angle"] = SECTOR / 2.0
    return states


def drive_record(parameters: DriveParameters) -> np.ndarray:
    """The drives' share of a plant's parameters as an array of shape (1,), for `advance_drive`.

    Its record has the same type for every plant, so the drives are compiled once for all of them.
    """
    own = DriveParameters(parameters.drive, parameters.motor, parameters.averaged, parameters.switched)
    return record_of(own)


@compiled
def advance_drive(state, parameters, torque_reference, speed, bus_voltage, duration):
    """Advance one drive in place over `duration` [s], the shaft speed held [rad/s].

    `state` is a record of DRIVE_STATE, `parameters` the record in a `drive_record`. The reference [N m] is positive
    forwards and is limited to the motor's torque limit; `bus_voltage` is above zero [V].
    """
    reference = limited_torque(parameters.motor, torque_reference)
    if parameters.drive == IDEAL:
        advance_ideal(state, parameters.motor, reference, speed)
    elif parameters.drive == AVERAGED:
        advance_averaged(state, parameters.motor, parameters.averaged, reference, speed, bus_voltage, duration)
    else:
        advance_switched(state, parameters.motor, parameters.switched, reference, speed, bus_voltage, duration)
