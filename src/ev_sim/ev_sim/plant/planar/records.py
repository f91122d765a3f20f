"""The records that the compiled plant works with: constants of the car, what acts in this step, and the drives."""

from __future__ import annotations

import struct

import numpy as np

from ev_msgs_py.contract.record import record_type
from ev_msgs_py.parameters import number_tree
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import WHEEL_NAMES
from ev_sim.driveline.couplings import COUPLINGS
from ev_sim.drives.drive import DriveParameters
from ev_sim.drives.state import DriveState
from ev_sim.tyres.combined import COMBINATIONS
from ev_sim.tyres.curve import CURVES

GRAVITY = 9.81  # [m/s^2], as in the sources

_ONE, _WHEELS = np.float64, (np.float64, 4)

CAR = np.dtype(
    [
        ("mass", _ONE),
        ("yaw_inertia", _ONE),
        ("height", _ONE),
        ("rear_arm", _ONE),
        ("offset", _ONE),
        ("wheelbase", _ONE),
        ("front_track", _ONE),
        ("rear_track", _ONE),
        ("front_roll_share", _ONE),
        ("transfer_lag", _ONE),
        ("drag", _ONE),  # rho c_d A / 2 [N s^2/m^2]
        ("rolling", _ONE),
        ("rolling_speed", _ONE),
        ("radius", _ONE),
        ("wheel_x", *_WHEELS),  # of the wheel centres from the centre of mass [m]
        ("wheel_y", *_WHEELS),
        ("wheel_inertia", *_WHEELS),  # with the part of the rotor behind its gear [kg m^2]
        ("parallel_steering", _ONE),
        ("curve", np.int64),
        ("uncoupled", np.int64),
        ("linear_lateral", np.int64),
        ("lateral_ratio", _ONE),
        ("cornering_stiffness", *_WHEELS),  # over static load [1/rad]
        ("stiffness_x", _ONE),
        ("stiffness_y", _ONE),
        ("damping_x", _ONE),
        ("damping_y", _ONE),
        ("driven", *_WHEELS),  # 1 with a motor, else 0
        ("brushless", np.int64),  # 1 with a brushless DC drive, 0 with a torque-controlled motor
        ("gear", _ONE),
        ("peak_torque", _ONE),
        ("nominal_torque", _ONE),
        ("peak_power", _ONE),
        ("overload_time", _ONE),
        ("maximum_speed", _ONE),
        ("generator_torque", _ONE),
        ("generator_power", _ONE),
        ("torque_lag", _ONE),
        ("gear_efficiency", _ONE),
        ("copper_loss", _ONE),
        ("iron_loss", _ONE),
        ("eddy_loss", _ONE),
        ("inverter_loss", _ONE),
        ("inverter_torque_loss", _ONE),
        ("coupling", np.int64),
        ("preload", _ONE),
        ("locking_ratio", _ONE),
        ("locking_speed", _ONE),
        ("clutch_lag", _ONE),
        ("battery_resistance", _ONE),
        ("battery_charge", _ONE),  # between empty and full [A s]
        ("discharge_power", _ONE),
        ("charge_power", _ONE),
        ("auxiliary_power", _ONE),
        ("blend_brakes", np.int64),
        ("blend_fade_speed", _ONE),
        ("imposed_speed", np.int64),  # 1 if an outer force sets the longitudinal velocity
    ],
    align=True,
)

STEP = np.dtype(
    [
        # The commands come first, so that all of them are set at once, see `COMMANDS`.
        ("drive_command", *_WHEELS),  # at the wheels [N m]
        ("brake_command", *_WHEELS),
        ("steering_angle", _ONE),  # mean road-wheel angle [rad]
        ("steering_rate", _ONE),
        ("imposed_acceleration", _ONE),  # of the longitudinal velocity, set by an outer force [m/s^2]
        ("drive", *_WHEELS),  # at the wheels, behind motors and driveline [N m]
        ("mean_drive", *_WHEELS),  # over the last call of `run` [N m]
        ("brake", *_WHEELS),
        ("cos_steer", *_WHEELS),
        ("sin_steer", *_WHEELS),
        ("gravity_x", _ONE),  # gravity in the frame of the road [m/s^2]
        ("gravity_y", _ONE),
        ("gravity_z", _ONE),
        ("tyre", np.float64, (4, 6)),  # curve coefficients, f_surface, available friction under each wheel
        ("motion", *_WHEELS),  # direction that dry friction opposes in this step: -1, 1, or 0 for none
        ("held", *_WHEELS),  # 1 while dry friction holds the wheel at rest, else 0
        ("load", *_WHEELS),  # results of the last evaluation [N]
        ("force_x", *_WHEELS),  # in the wheel's frame
        ("force_y", *_WHEELS),
        ("slip_x", *_WHEELS),  # slip that belongs to the force [1]
        ("slip_y", *_WHEELS),
        ("acceleration_x", _ONE),  # of the centre of mass [m/s^2]
        ("acceleration_y", _ONE),
        ("segment", np.int64, (4,)),  # last place found along the road
        ("slope_segment", np.int64),
    ],
    align=True,
)


DRIVE_PARAMETERS = record_type(number_tree(DriveParameters()))

PLANT = np.dtype(
    [
        ("step", STEP),
        ("car", CAR),
        ("drives", record_type(DriveState()), (4,)),  # of brushless DC drives
        ("drive_parameters", DRIVE_PARAMETERS),
        ("h", _ONE),  # width of a step [s]
        ("lags", *_WHEELS),  # what of each lag a step closes, see `apply_drives`
    ],
    align=True,
)

# The commands of a step, drive torques to imposed acceleration, with which a PLANT begins.
COMMANDS = struct.Struct(f"{STEP.fields['drive'][1] // _ONE().itemsize}d")


def wheel_places(vehicle: Vehicle) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The x and the y of the four wheel centres from the centre of mass [m]."""
    rear = -vehicle.centre_of_mass_to_rear_axle
    front = vehicle.wheelbase + rear
    front_half, rear_half, offset = vehicle.front_track / 2, vehicle.rear_track / 2, vehicle.centre_of_mass_offset
    y = (front_half - offset, -front_half - offset, rear_half - offset, -rear_half - offset)
    return (front, front, rear, rear), y


def car_record(vehicle: Vehicle, transfer_lag: float, brushless: bool, imposed_speed: bool = False) -> np.ndarray:
    """The constants of a vehicle, shape (1,) of `CAR`.

    `transfer_lag` [s] is the lag of the load transfer; `brushless` drives bring their own losses; an outer force
    sets the longitudinal velocity with `imposed_speed`.
    """
    car = np.zeros(1, CAR)
    v, tyre, motor = vehicle, vehicle.tyre, vehicle.motor
    driven = np.array([float(name in v.driven_wheels) for name in WHEEL_NAMES])
    front_load = v.mass * GRAVITY * v.centre_of_mass_to_rear_axle / v.wheelbase
    rear_load = v.mass * GRAVITY - front_load
    x, y = wheel_places(v)
    values = {
        "mass": v.mass,
        "yaw_inertia": v.yaw_inertia,
        "height": v.centre_of_mass_height,
        "rear_arm": v.centre_of_mass_to_rear_axle,
        "offset": v.centre_of_mass_offset,
        "wheelbase": v.wheelbase,
        "front_track": v.front_track,
        "rear_track": v.rear_track,
        "front_roll_share": v.front_roll_share,
        "transfer_lag": transfer_lag,
        "drag": 0.5 * v.air_density * v.drag_coefficient * v.frontal_area,
        "rolling": v.rolling_resistance,
        "rolling_speed": v.rolling_resistance_speed,
        "radius": v.wheel_radius,
        "wheel_x": x,
        "wheel_y": y,
        "wheel_inertia": v.wheel_inertia + driven * motor.rotor_inertia * v.gear_ratio**2,
        "parallel_steering": float(v.steering_geometry == "parallel"),
        "curve": CURVES.index(tyre.curve),
        "uncoupled": COMBINATIONS.index(tyre.combined),
        "linear_lateral": int(tyre.lateral_curve == "linear"),
        "lateral_ratio": tyre.lateral_ratio,
        "cornering_stiffness": (2 * tyre.front_cornering_stiffness / max(front_load, 1.0),) * 2
        + (2 * tyre.rear_cornering_stiffness / max(rear_load, 1.0),) * 2,
        "stiffness_x": tyre.longitudinal_stiffness,
        "stiffness_y": tyre.lateral_stiffness,
        "damping_x": tyre.longitudinal_stiffness * tyre.longitudinal_damping_time,
        "damping_y": tyre.lateral_stiffness * tyre.lateral_damping_time,
        "driven": driven,
        "brushless": int(brushless),
        "gear": v.gear_ratio,
        "coupling": COUPLINGS.index(v.driveline.coupling),
        "preload": v.driveline.preload,
        "locking_ratio": v.driveline.locking_ratio,
        "locking_speed": v.driveline.locking_speed,
        "clutch_lag": v.driveline.clutch_lag,
        "battery_resistance": v.battery.resistance,
        "battery_charge": v.battery.capacity * 3600.0,
        "discharge_power": v.battery.discharge_power,
        "charge_power": v.battery.charge_power,
        "auxiliary_power": v.battery.auxiliary_power,
        "blend_brakes": int(v.blend_brakes),
        "blend_fade_speed": v.blend_fade_speed,
        "imposed_speed": int(imposed_speed),
    }
    for name in CAR.names:
        car[0][name] = values[name] if name in values else getattr(motor, name)
    if brushless:
        for name in ("copper_loss", "iron_loss", "eddy_loss", "inverter_loss", "inverter_torque_loss"):
            car[0][name] = 0.0
    return car
