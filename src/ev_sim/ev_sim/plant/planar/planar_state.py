"""The state of the planar plant, every number that lasts between steps; and its working memory.

`PlanarState` lasts: it is saved, compared and continued. `Step` lasts for one period only, so
nothing in it may be read before it is set. What both have in common are the names of places: the
row that is integrated is one series of numbers, and `VX`, `WHEEL_SPEED` and others are places in
it.
"""

from __future__ import annotations

from collections.abc import MutableSequence
from dataclasses import dataclass

from ev_core.law import (
    Place,
    Wheels,
    each_wheel,
    entry,
    inlined,
    memory_type,
    part,
    per_wheel,
    row,
    series,
    wheel_places,
)
from ev_core.parameters.record import names
from ev_sim.drives.brushless_motor import DriveState
from ev_sim.drives.driveline import EngineState
from ev_sim.plant.guard import GuardState

# The part of what is integrated on which forces depend.
_MOTION_PLACES = (
    Place("longitudinal_velocity", "m/s", "of the centre of mass, body frame"),
    Place("lateral_velocity", "m/s", "of the centre of mass, body frame"),
    Place("yaw_rate", "rad/s"),
    Place("heading", "rad", "from the x axis of odom, not wrapped"),
    Place(
        "longitudinal_transfer",
        "m/s^2",
        "tyre force over mass that the load transfer has followed, body frame",
    ),
    Place(
        "lateral_transfer",
        "m/s^2",
        "tyre force over mass that the load transfer has followed, body frame",
    ),
    Place("roll_angle", "rad", "of the body against the road, to the right"),
    Place("roll_rate", "rad/s", "of the body against the road, to the right"),
    *wheel_places("wheel_speed", "rad/s"),
    *wheel_places(
        "longitudinal_deflection", "m", "of the carcass, wheel frame, positive as its force"
    ),
    *wheel_places("lateral_deflection", "m", "of the carcass, wheel frame, positive as its force"),
    *wheel_places("longitudinal_slip", "1", "of the contact, positive as its force"),
    *wheel_places("lateral_slip", "1", "of the contact, positive as its force"),
)
# What both integrators integrate.
INTEGRATED_PLACES = (
    *_MOTION_PLACES,
    *wheel_places("wheel_angle", "rad", "turned since the start"),
    *wheel_places("distance", "m", "travelled by the wheel centre along the wheel since the start"),
    Place("body_distance", "m", "travelled by the centre of mass along the body"),
    # Works are integrated with the motion, so energies add up as exactly as the motion itself is.
    Place("tyre_work", "J", "taken by the tyres, in slip and in the carcass"),
    Place("friction_work", "J", "taken by brakes and rolling resistance"),
    Place("drag_work", "J", "taken by the air"),
    Place("gravity_work", "J", "taken from the body by the slope"),
    Place("holding_work", "J", "taken from the body by the force that holds its speed"),
    Place("damper_work", "J", "taken by the dampers as the body rolls"),
)
INTEGRATED_SIZE = len(INTEGRATED_PLACES)
RATES_SIZE = len(_MOTION_PLACES)


def _rate_of(place: Place) -> Place:
    """The place of the rate of a number, with the wheel behind its name."""
    name, dot, wheel = place.name.partition(".")
    by = "; of wheels by the road alone" if name == "wheel_speed" else ""
    return Place(f"{name}_rate{dot}{wheel}", f"{place.unit}/s", f"mean over the last step{by}")


_RATES_PLACES = tuple(_rate_of(place) for place in _MOTION_PLACES)

Row = MutableSequence[float]  # what is integrated, or its rates

LONGEST_DELAY = 50  # [control periods]


@dataclass(slots=True)
class CarFaultState:
    """State of the faults; without any, `is_struck` is 0 and nothing else matters."""

    is_struck: float = entry(unit="1", about="1 while there are faults")
    share: list[float] = per_wheel(1.0, unit="1", about="of its torque that the motor gives")
    stuck: list[float] = per_wheel(unit="1", about="1 while the torque is stuck")
    stuck_torque: list[float] = per_wheel(unit="N m", about="of the motor, at its shaft")
    trips_at: list[float] = per_wheel(unit="N m", about="asked for at the shaft; 0: never")
    tripped: list[float] = per_wheel(unit="1", about="1 once the inverter has switched off")
    delay: list[float] = per_wheel(
        unit="1", about="control periods until the inverter gets its command"
    )
    hall: list[float] = per_wheel(unit="1", about="1 while a Hall sensor is stuck")
    power: float = entry(1.0, unit="1", about="share of the battery's power limits")
    flat: list[float] = per_wheel(unit="1", about="share of the air that is lost")
    # A ring, so that an inverter may get the command of up to LONGEST_DELAY periods ago.
    asked: list[float] = series(
        4 * LONGEST_DELAY, unit="N m", about="last drive torques, wheel by wheel"
    )


@dataclass(slots=True)
class PlanarState:
    """Integrated numbers, those that a step advances, and those that a period leaves behind."""

    motion: list[float] = row(INTEGRATED_PLACES)
    rates: list[float] = row(_RATES_PLACES)  # 0 but for the semi-implicit integrator
    x: float = entry(unit="m", about="of the centre of mass, odom frame")
    y: float = entry(unit="m", about="of the centre of mass, odom frame")
    motor_torque: list[float] = per_wheel(unit="N m", about="at the shaft")
    motor_heat: list[float] = per_wheel(
        unit="1", about="squared torque over squared nominal torque, through the thermal lag"
    )
    torque_share: list[float] = per_wheel(
        unit="1", about="of the drive torque, behind the clutches"
    )
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
    mean_drive: list[float] = per_wheel(
        unit="N m", about="drive torque at the wheel, mean over the last period"
    )
    road_wheel_angle: float = entry(
        unit="rad", about="mean of the front wheels, at the end of the last period"
    )
    rear_angle: float = entry(
        unit="rad", about="of the rear wheels by an actuator, at the end of the last period"
    )
    rear_rate: float = entry(
        unit="rad/s", about="of the rear wheels by an actuator, over the last period"
    )
    imposed_acceleration: float = entry(
        unit="m/s^2", about="that an outer force gave the body over the last period"
    )
    periods: float = entry(unit="1", about="number of periods so far")
    battery_empty: float = entry(
        unit="", about="1 if the battery has been empty at the end of a period"
    )
    lifted: list[float] = per_wheel(
        unit="1", about="1 if the wheel has been off the ground at the end of a period"
    )
    engine: EngineState = part(EngineState)
    guard: GuardState = part(GuardState)
    faults: CarFaultState = part(CarFaultState)


_PLACES = {
    name.removesuffix(".front_left"): n
    # Backwards, so that of numbers with one name the first place stays.
    for n, name in reversed(list(enumerate(names(PlanarState()))))
}


def index(name: str) -> int:
    """Place of a number in the row of the state, of values by wheel that of the first."""
    return _PLACES[name]


VX = index("longitudinal_velocity")
VY = index("lateral_velocity")
YAW_RATE = index("yaw_rate")
HEADING = index("heading")
WHEEL_ANGLE = index("wheel_angle")
WHEEL_SPEED = index("wheel_speed")
TRANSFER_X, TRANSFER_Y = index("longitudinal_transfer"), index("lateral_transfer")
ROLL_ANGLE, ROLL_RATE = index("roll_angle"), index("roll_rate")
DEFLECTION_X, DEFLECTION_Y = index("longitudinal_deflection"), index("lateral_deflection")
SLIP_X, SLIP_Y = index("longitudinal_slip"), index("lateral_slip")
DISTANCE, BODY_DISTANCE = index("distance"), index("body_distance")
TYRE_WORK = index("tyre_work")
FRICTION_WORK = index("friction_work")
DRAG_WORK = index("drag_work")
GRAVITY_WORK, HOLDING_WORK = index("gravity_work"), index("holding_work")
DAMPER_WORK = index("damper_work")


@inlined
def wheels_from(values: Row, place: int) -> Wheels:
    """Four values of a row from a place on, by wheel."""
    return Wheels(values[place], values[place + 1], values[place + 2], values[place + 3])


@dataclass(slots=True)
class TyreRecord:
    """The tyre of one wheel on the surface under it, as `surfaces.TyreOnRoad`."""

    c0: float = entry(unit="1", about="coefficient of the friction curve")
    c1: float = entry(unit="1", about="coefficient of the friction curve")
    c2: float = entry(unit="1", about="coefficient of the friction curve")
    c3: float = entry(unit="1", about="coefficient of the friction curve")
    rolling_resistance: float = entry(
        unit="1", about="that the surface adds to that of the vehicle"
    )
    friction: float = entry(unit="1", about="available")


@dataclass(slots=True)
class Contacts:
    """The contacts of the wheels with the road.

    Velocities are in the frame of each wheel; friction gives forces there. A slip velocity over the
    transport velocity is a slip; the force of the friction curve over that slip is its secant.
    """

    cosine: list[float] = per_wheel(unit="1", about="of the angle of the wheel, bent by compliance")
    sine: list[float] = per_wheel(unit="1", about="of the angle of the wheel, bent by compliance")
    wheel_speed: list[float] = per_wheel(
        unit="rad/s", about="0 if the brake has stopped it within the step"
    )
    along: list[float] = per_wheel(unit="m/s", about="of the wheel centre")
    speed: list[float] = per_wheel(unit="m/s", about="of the wheel centre, magnitude")
    rim: list[float] = per_wheel(unit="m/s")
    slip_x: list[float] = per_wheel(unit="m/s")
    slip_y: list[float] = per_wheel(unit="m/s")
    transport_x: list[float] = per_wheel(unit="m/s")
    transport_y: list[float] = per_wheel(unit="m/s")
    grip: list[float] = per_wheel(
        unit="1", about="what the road scales the friction of an mf_tyre by"
    )
    stiffness: list[float] = per_wheel(
        unit="1", about="what its air pressure scales its slip stiffness by"
    )
    secant_x: list[float] = per_wheel(unit="N")
    secant_y: list[float] = per_wheel(unit="N")
    largest_x: list[float] = per_wheel(unit="N", about="force that the road holds")
    largest_y: list[float] = per_wheel(unit="N", about="force that the road holds")


@dataclass(slots=True)
class Stages:
    """Rates at the stages of the Runge-Kutta method, and the state at one of them.

    Their units are those of the state, per s.
    """

    state: list[float] = series(INTEGRATED_SIZE, unit="")
    k1: list[float] = series(INTEGRATED_SIZE, unit="")
    k2: list[float] = series(INTEGRATED_SIZE, unit="")
    k3: list[float] = series(INTEGRATED_SIZE, unit="")
    k4: list[float] = series(INTEGRATED_SIZE, unit="")


@dataclass(slots=True)
class Step:
    """One step: commands, loads of the wheels, and results of the last evaluation of the rates."""

    drive_command: list[float] = per_wheel(unit="N m", about="at the wheels")
    brake_command: list[float] = per_wheel(unit="N m", about="at the wheels")
    imposed_acceleration: float = entry(
        unit="m/s^2", about="of the longitudinal velocity, by an outer force"
    )
    static_radius: list[float] = per_wheel(
        unit="m", about="true rolling radius under the static load, of a flat tyre a smaller one"
    )
    radius: list[float] = per_wheel(unit="m", about="true rolling radius")
    drive: list[float] = per_wheel(unit="N m", about="at the wheels, behind motors and driveline")
    brake: list[float] = per_wheel(unit="N m", about="at the wheels")
    pushed: list[float] = per_wheel(
        unit="N m", about="of `drive` what imposes the speed, beside the motors"
    )
    cos_steer: list[float] = per_wheel(unit="1", about="cosine of the angle of the wheel")
    sin_steer: list[float] = per_wheel(unit="1", about="sine of the angle of the wheel")
    gravity_x: float = entry(unit="m/s^2", about="gravity in the frame of the road")
    gravity_y: float = entry(unit="m/s^2", about="gravity in the frame of the road")
    gravity_z: float = entry(
        unit="m/s^2", about="gravity in the frame of the road, pressing the car on it"
    )
    tyre: list[TyreRecord] = each_wheel(TyreRecord)
    segment: list[float] = per_wheel(
        unit="1", about="of the road under the wheel, from which the next is looked for"
    )
    slope_segment: float = entry(unit="1", about="of the slope, from which the next is looked for")
    contact: Contacts = part(Contacts)
    motion: list[float] = per_wheel(
        unit="1", about="direction that dry friction opposes: -1, 1, or 0 for none"
    )
    held: list[float] = per_wheel(
        unit="1", about="1 while dry friction holds the wheel at rest, else 0"
    )
    load: list[float] = per_wheel(unit="N")
    force_x: list[float] = per_wheel(
        unit="N", about="of the road on the tyre, in the frame of the wheel"
    )
    force_y: list[float] = per_wheel(
        unit="N", about="of the road on the tyre, in the frame of the wheel"
    )
    acceleration_x: float = entry(unit="m/s^2", about="of the centre of mass")
    acceleration_y: float = entry(unit="m/s^2", about="of the centre of mass")
    voltage: float = entry(unit="V", about="of the DC link, where the electrical side is modelled")
    asked: list[float] = per_wheel(unit="N m", about="of the motors, at the wheels")
    shaft: list[float] = per_wheel(
        unit="rad/s", about="speed of the motor's shaft, at the wheel side of the gear"
    )
    target: list[float] = per_wheel(
        unit="N m", about="of the motor, then what comes out behind its gear"
    )
    motor: list[float] = per_wheel(
        unit="N m", about="mean torque of the motor over the step, at its shaft"
    )
    turned: list[float] = per_wheel(unit="rad", about="by the wheel in the step")
    mean_speed: list[float] = per_wheel(unit="rad/s", about="of the wheel over the step")
    stages: Stages = part(Stages)


STEP_MEMORY = memory_type(Step)
