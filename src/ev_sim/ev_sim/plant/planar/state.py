"""The state of the planar plant: every entry is named here, once."""

from __future__ import annotations

import numpy as np

# Integrated by the Runge-Kutta method; entries of four are front left, front right, rear left, rear right.
INTEGRATED = (
    ("longitudinal_velocity", 1),  # of the centre of mass, body frame [m/s]
    ("lateral_velocity", 1),  # [m/s]
    ("yaw_rate", 1),  # [rad/s]
    ("heading", 1),  # from the x axis of odom, not wrapped [rad]
    ("longitudinal_transfer", 1),  # tyre force over mass that the load transfer has followed, body frame [m/s^2]
    ("lateral_transfer", 1),  # [m/s^2]
    ("wheel_speed", 4),  # [rad/s]
    ("longitudinal_deflection", 4),  # of the carcass, wheel frame, positive as its force [m]
    ("lateral_deflection", 4),  # [m]
    ("wheel_angle", 4),  # turned since the start [rad]
    ("distance", 4),  # travelled by the wheel centre along the wheel since the start [m]
    ("body_distance", 1),  # travelled by the centre of mass along the body [m]
    ("tyre_work", 1),  # taken by the tyres, in slip and in the carcass [J]
    ("friction_work", 1),  # taken by brakes and rolling resistance [J]
    ("drag_work", 1),  # taken by the air [J]
    ("gravity_work", 1),  # taken from the body by the slope [J]
    ("holding_work", 1),  # taken from the body by the force that holds its speed [J]
)

# Advanced once a step.
STEPPED = (
    ("x", 1),  # of the centre of mass, odom frame [m]
    ("y", 1),  # [m]
    ("motor_torque", 4),  # at the shaft [N m]
    ("motor_heat", 4),  # squared torque over squared nominal torque, through the thermal lag [1]
    ("torque_share", 4),  # of the drive torque, behind the clutches [1]
    ("state_of_charge", 1),  # [1]
    ("battery_power", 1),  # given at the terminals, mean over the last step [W]
    ("battery_work", 1),  # given at the terminals [J]
    ("motor_loss", 1),  # in motors and inverters [J]
    ("driveline_loss", 1),  # in gears, differentials and clutches [J]
    ("auxiliary_work", 1),  # taken by the auxiliary consumers [J]
    ("drive_work", 1),  # given to the wheels [J]
)

ENTRIES = INTEGRATED + STEPPED


def index(name: str) -> int:
    """Place of the first value of an entry in the state array."""
    place = 0
    for entry, size in ENTRIES:
        if entry == name:
            return place
        place += size
    raise KeyError(name)


SIZE = sum(size for _, size in ENTRIES)
INTEGRATED_SIZE = sum(size for _, size in INTEGRATED)
X = index("x")
Y = index("y")


def names() -> tuple[str, ...]:
    """One name for each value of the state array; those of wheels end with the wheel."""
    wheels = ("front_left", "front_right", "rear_left", "rear_right")
    return tuple(
        entry if size == 1 else f"{entry}.{wheels[n]}" for entry, size in ENTRIES for n in range(size)
    )


def at_rest() -> np.ndarray:
    """A state of zeros, shape (SIZE,)."""
    return np.zeros(SIZE)
