"""The state of the planar plant: every number that lasts between steps is declared here, once."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.contract.record import Place, each_wheel, entry, names, part, per_wheel, row, wheel_places
from ev_sim.drives.engine import EngineState
from ev_sim.drives.state import DriveState
from ev_sim.plant.commands import GuardState
from ev_sim.plant.planar.faults.state import FaultState

# What the Runge-Kutta method integrates.
INTEGRATED = (
    Place("longitudinal_velocity", "m/s", "of the centre of mass, body frame"),
    Place("lateral_velocity", "m/s", "of the centre of mass, body frame"),
    Place("yaw_rate", "rad/s"),
    Place("heading", "rad", "from the x axis of odom, not wrapped"),
    Place("longitudinal_transfer", "m/s^2", "tyre force over mass that the load transfer has followed, body frame"),
    Place("lateral_transfer", "m/s^2", "tyre force over mass that the load transfer has followed, body frame"),
    *wheel_places("wheel_speed", "rad/s"),
    *wheel_places("longitudinal_deflection", "m", "of the carcass, wheel frame, positive as its force"),
    *wheel_places("lateral_deflection", "m", "of the carcass, wheel frame, positive as its force"),
    *wheel_places("longitudinal_slip", "1", "of the contact, positive as its force"),
    *wheel_places("lateral_slip", "1", "of the contact, positive as its force"),
    *wheel_places("wheel_angle", "rad", "turned since the start"),
    *wheel_places("distance", "m", "travelled by the wheel centre along the wheel since the start"),
    Place("body_distance", "m", "travelled by the centre of mass along the body"),
    Place("tyre_work", "J", "taken by the tyres, in slip and in the carcass"),
    Place("friction_work", "J", "taken by brakes and rolling resistance"),
    Place("drag_work", "J", "taken by the air"),
    Place("gravity_work", "J", "taken from the body by the slope"),
    Place("holding_work", "J", "taken from the body by the force that holds its speed"),
)
INTEGRATED_SIZE = len(INTEGRATED)


@dataclass(slots=True)
class PlanarState:
    """What is integrated, what a step advances, and what a period leaves behind."""

    motion: list[float] = row(INTEGRATED)
    x: float = entry(unit="m", about="of the centre of mass, odom frame")
    y: float = entry(unit="m", about="of the centre of mass, odom frame")
    motor_torque: list[float] = per_wheel(unit="N m", about="at the shaft")
    motor_heat: list[float] = per_wheel(
        unit="1", about="squared torque over squared nominal torque, through the thermal lag"
    )
    torque_share: list[float] = per_wheel(unit="1", about="of the drive torque, behind the clutches")
    state_of_charge: float = entry(unit="1")
    relaxation: float = entry(unit="V", about="of the cells, taken from their open-circuit voltage")
    cells_rise: float = entry(unit="K", about="of the cells above what is around them")
    winding_rise: list[float] = per_wheel(unit="K", about="above the coolant's inlet")
    inverter_rise: list[float] = per_wheel(unit="K", about="above the coolant's inlet")
    battery_power: float = entry(unit="W", about="given at the terminals, mean over the last step")
    battery_work: float = entry(unit="J", about="given at the terminals")
    motor_loss: float = entry(unit="J", about="in motors and inverters")
    driveline_loss: float = entry(unit="J", about="in gears, differentials and clutches")
    auxiliary_work: float = entry(unit="J", about="taken by the auxiliary consumers")
    drive_work: float = entry(unit="J", about="given to the wheels")
    drives: list[DriveState] = each_wheel(DriveState)  # of brushless motors
    mean_drive: list[float] = per_wheel(unit="N m", about="drive torque at the wheel, mean over the last period")
    road_wheel_angle: float = entry(unit="rad", about="mean of the front wheels, at the end of the last period")
    rear_angle: float = entry(unit="rad", about="of the rear wheels by an actuator, at the end of the last period")
    rear_rate: float = entry(unit="rad/s", about="of the rear wheels by an actuator, over the last period")
    imposed_acceleration: float = entry(unit="m/s^2", about="that an outer force gave the body over the last period")
    periods: float = entry(unit="1", about="number of periods so far")
    battery_empty: float = entry(unit="", about="1 if the battery has been empty at the end of a period")
    lifted: list[float] = per_wheel(unit="1", about="1 if the wheel has been off the ground at the end of a period")
    engine: EngineState = part(EngineState)
    guard: GuardState = part(GuardState)
    faults: FaultState = part(FaultState)


_PLACES = {name.removesuffix(".front_left"): n for n, name in reversed(list(enumerate(names(PlanarState()))))}


def index(name: str) -> int:
    """Place of a number in the row of the state, of values by wheel that of the first."""
    return _PLACES[name]


VX = index("longitudinal_velocity")
VY = index("lateral_velocity")
YAW_RATE = index("yaw_rate")
HEADING = index("heading")
TRANSFER_X = index("longitudinal_transfer")
TRANSFER_Y = index("lateral_transfer")
WHEEL_SPEED = index("wheel_speed")
DEFLECTION_X = index("longitudinal_deflection")
DEFLECTION_Y = index("lateral_deflection")
SLIP_X = index("longitudinal_slip")
SLIP_Y = index("lateral_slip")
WHEEL_ANGLE = index("wheel_angle")
DISTANCE = index("distance")
BODY_DISTANCE = index("body_distance")
TYRE_WORK = index("tyre_work")
FRICTION_WORK = index("friction_work")
DRAG_WORK = index("drag_work")
GRAVITY_WORK = index("gravity_work")
HOLDING_WORK = index("holding_work")
