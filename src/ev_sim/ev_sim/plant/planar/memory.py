"""Working memory of the planar plant: what acts in a step and what an evaluation finds. Nothing of it lasts."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.contract.record import each_wheel, entry, memory_type, part, per_wheel, series
from ev_sim.plant.planar.state import INTEGRATED_SIZE


@dataclass(slots=True)
class TyreRecord:
    """The tyre of one wheel on the surface under it, as `surfaces.table.TyreOnRoad`."""

    c0: float = entry(unit="1", about="coefficient of the friction curve")
    c1: float = entry(unit="1", about="coefficient of the friction curve")
    c2: float = entry(unit="1", about="coefficient of the friction curve")
    c3: float = entry(unit="1", about="coefficient of the friction curve")
    rolling_resistance: float = entry(unit="1", about="that the surface adds to that of the vehicle")
    friction: float = entry(unit="1", about="available")


@dataclass(slots=True)
class Contacts:
    """The contacts of the wheels with the road: velocities in the frame of each wheel, and what friction gives there.

    A slip velocity over the transport velocity is a slip; the force of the friction curve over that slip is its secant.
    """

    cosine: list[float] = per_wheel(unit="1", about="of the angle of the wheel, bent by compliance")
    sine: list[float] = per_wheel(unit="1", about="of the angle of the wheel, bent by compliance")
    wheel_speed: list[float] = per_wheel(unit="rad/s", about="0 if the brake has stopped it within the step")
    along: list[float] = per_wheel(unit="m/s", about="of the wheel centre")
    speed: list[float] = per_wheel(unit="m/s", about="of the wheel centre, magnitude")
    rim: list[float] = per_wheel(unit="m/s")
    slip_x: list[float] = per_wheel(unit="m/s")
    slip_y: list[float] = per_wheel(unit="m/s")
    transport_x: list[float] = per_wheel(unit="m/s")
    transport_y: list[float] = per_wheel(unit="m/s")
    grip: list[float] = per_wheel(unit="1", about="what the road scales the friction of an mf_tyre by")
    stiffness: list[float] = per_wheel(unit="1", about="what its air pressure scales its slip stiffness by")
    secant_x: list[float] = per_wheel(unit="N")
    secant_y: list[float] = per_wheel(unit="N")
    largest_x: list[float] = per_wheel(unit="N", about="force that the road holds")
    largest_y: list[float] = per_wheel(unit="N", about="force that the road holds")


@dataclass(slots=True)
class Step:
    """One step: commands, what acts on the wheels, and the results of the last evaluation of the rates."""

    drive_command: list[float] = per_wheel(unit="N m", about="at the wheels")
    brake_command: list[float] = per_wheel(unit="N m", about="at the wheels")
    imposed_acceleration: float = entry(unit="m/s^2", about="of the longitudinal velocity, by an outer force")
    radius: list[float] = per_wheel(unit="m", about="true rolling radius")
    drive: list[float] = per_wheel(unit="N m", about="at the wheels, behind motors and driveline")
    brake: list[float] = per_wheel(unit="N m", about="at the wheels")
    cos_steer: list[float] = per_wheel(unit="1", about="cosine of the angle of the wheel")
    sin_steer: list[float] = per_wheel(unit="1", about="sine of the angle of the wheel")
    gravity_x: float = entry(unit="m/s^2", about="gravity in the frame of the road")
    gravity_y: float = entry(unit="m/s^2", about="gravity in the frame of the road")
    gravity_z: float = entry(unit="m/s^2", about="gravity in the frame of the road, pressing the car on it")
    tyre: list[TyreRecord] = each_wheel(TyreRecord)
    segment: list[float] = per_wheel(unit="1", about="of the road under the wheel, from which the next is looked for")
    slope_segment: float = entry(unit="1", about="of the slope, from which the next is looked for")
    contact: Contacts = part(Contacts)
    motion: list[float] = per_wheel(unit="1", about="direction that dry friction opposes: -1, 1, or 0 for none")
    held: list[float] = per_wheel(unit="1", about="1 while dry friction holds the wheel at rest, else 0")
    load: list[float] = per_wheel(unit="N")
    force_x: list[float] = per_wheel(unit="N", about="of the road on the tyre, in the frame of the wheel")
    force_y: list[float] = per_wheel(unit="N", about="of the road on the tyre, in the frame of the wheel")
    acceleration_x: float = entry(unit="m/s^2", about="of the centre of mass")
    acceleration_y: float = entry(unit="m/s^2", about="of the centre of mass")
    voltage: float = entry(unit="V", about="of the DC link, where the electrical side is modelled")
    asked: list[float] = per_wheel(unit="N m", about="of the motors, at the wheels")
    shaft: list[float] = per_wheel(unit="rad/s", about="speed of the motor's shaft, at the wheel side of the gear")
    target: list[float] = per_wheel(unit="N m", about="of the motor, then what comes out behind its gear")
    motor: list[float] = per_wheel(unit="N m", about="mean torque of the motor over the step, at its shaft")
    turned: list[float] = per_wheel(unit="rad", about="by the wheel in the step")
    mean_speed: list[float] = per_wheel(unit="rad/s", about="of the wheel over the step")


@dataclass(slots=True)
class Stages:
    """The rates at the stages of the Runge-Kutta method, and the state at one of them; units of the state, per s."""

    state: list[float] = series(INTEGRATED_SIZE, unit="")
    k1: list[float] = series(INTEGRATED_SIZE, unit="")
    k2: list[float] = series(INTEGRATED_SIZE, unit="")
    k3: list[float] = series(INTEGRATED_SIZE, unit="")
    k4: list[float] = series(INTEGRATED_SIZE, unit="")


STEP, STAGES = memory_type(Step), memory_type(Stages)
