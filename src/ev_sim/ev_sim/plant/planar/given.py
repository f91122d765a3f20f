"""Parameters of the planar plant, its constants of body and wheels, and its faults.

How faults work: `car_faults` makes tables of the texts before the run. At the beginning of a
control period `find_faults` sets the state of the faults from the tables, and each step acts by
that state: `delay_commands` on commands, `strike_motors` on motor torques, `deflate` on tyres.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any, NamedTuple

from ev_core.faults.fault import OF_THE_CAR, Fault, faults_parameter, parsed
from ev_core.law import (
    GRAVITY,
    WHEEL_NAMES,
    Car,
    ParameterError,
    Vehicle,
    compilable,
    group,
    parameter,
    setting,
)
from ev_core.parameters.record import each_wheel, entry, part, per_wheel
from ev_core.vehicle.driveline import AXLES, wheel_inertias
from ev_core.vehicle.tmeasy import TmeasyTyre, tmeasy_tyre
from ev_core.vehicle.tyre import MfTyres, mf_tyres
from ev_msgs_py.refusal import quoted
from ev_sim.drives.brushless_motor import torque_share
from ev_sim.drives.drive import DRIVE_MODELS, DriveParameters
from ev_sim.plant.planar.planar_state import (
    LONGEST_DELAY,
    WHEEL_ANGLE,
    CarFaultState,
    PlanarState,
    Step,
)
from ev_sim.profiles.profile import SpeedProfileParameters, with_profile_from_file
from ev_sim.surfaces import RoadParameters
from ev_sim.tyres.curve import soften
from ev_sim.tyres.mf_tyre import is_plain

TORQUE_CONTROLLED = len(DRIVE_MODELS)
SPEED_CHOICES = ("free", "held", "imposed")
SPEED_FREE, SPEED_HELD, SPEED_IMPOSED = range(len(SPEED_CHOICES))
INTEGRATORS = ("runge_kutta", "semi_implicit")
LONGEST_OF_RUNGE_KUTTA = 1e-3  # [s]
IMPOSED_AT = ("body", "wheels")
AT_BODY, AT_WHEELS = range(len(IMPOSED_AT))


CODES = tuple(OF_THE_CAR)
MOTOR_SHARE, MOTOR_STUCK, INVERTER_TRIP, INVERTER_DELAY, HALL_STUCK, BATTERY_SHARE, FLAT_TYRE = (
    range(len(CODES))
)


@dataclass(frozen=True, slots=True)
class PunctureParameters:
    """A tyre without air, beside the sound one; all of it is assumed."""

    radius: float = setting(
        0.9, unit="1", low=0.5, high=1.0, about="rolling radius over that of the sound tyre"
    )
    stiffness: float = setting(
        0.3,
        unit="1",
        low=0.05,
        high=1.0,
        about="slip stiffness over that of the sound tyre, along and across",
    )
    rolling_resistance: float = setting(
        0.2,
        unit="1",
        low=0.0,
        high=1.0,
        about="that a tyre without air adds to that of the sound one",
    )
    time: float = setting(
        0.5, unit="s", low=0.0, high=1000.0, about="in which the air is lost, evenly"
    )


@dataclass(frozen=True, slots=True)
class PlanarParameters(DriveParameters):
    """Drives, step, start and road of the planar plant; the car is the vehicle description."""

    drive: str = setting(
        "torque_controlled",
        choices=(*DRIVE_MODELS, "torque_controlled"),
        about="torque_controlled: the motor of the vehicle description; the others: a brushless "
        "DC drive, `motor`",
    )
    integrator: str = setting(
        "runge_kutta",
        choices=INTEGRATORS,
        about="of body and wheels; semi_implicit: one evaluation of the forces a step in place of "
        "four (docs/planar_plant.md)",
        read_only=True,
    )
    step: float = setting(
        1e-3,
        unit="s",
        low=1e-5,
        high=5e-3,
        about="longest step, above 1 ms for semi_implicit alone; stiff tyres on light wheels get "
        "shorter ones",
    )
    load_transfer_lag: float = setting(
        0.02,
        unit="s",
        low=0.002,
        high=1.0,
        about="time in which the wheel loads follow the tyre forces: springs and dampers in one "
        "number, an assumption "
        "that also keeps loads and forces from being an implicit equation",
    )
    initial_speed: float = setting(
        0.0, unit="m/s", low=-60.0, high=120.0, about="at the start, straight ahead"
    )
    initial_x: float = setting(
        0.0, unit="m", low=-1e6, high=1e6, about="centre of mass in odom at the start"
    )
    initial_y: float = setting(
        0.0, unit="m", low=-1e6, high=1e6, about="centre of mass in odom at the start", lateral=True
    )
    initial_heading: float = setting(
        0.0, unit="rad", low=-10.0, high=10.0, about="at the start", lateral=True
    )
    initial_lateral_velocity: float = setting(
        0.0, unit="m/s", low=-60.0, high=60.0, about="at the start, to the left", lateral=True
    )
    initial_yaw_rate: float = setting(
        0.0, unit="rad/s", low=-10.0, high=10.0, about="at the start", lateral=True
    )
    initial_hold: float = setting(
        0.0,
        unit="s",
        low=0.0,
        high=10.0,
        about="so long these and a free speed stay; wheels, carcasses, loads settle",
    )
    initial_drive_torque: tuple[float, ...] = parameter(
        (0.0, 0.0, 0.0, 0.0),
        unit="N m",
        low=-1e5,
        high=1e5,
        about="asked of each wheel: with any, the run begins in the equilibrium of straight "
        "running at constant speed "
        "with these torques, wheels at the slip that holds them; without, the wheels begin "
        "without slip",
        source="Ge & Ni 2005: straight running with T* comes before the turn",
        per_wheel=True,
    )
    speed: str = parameter(
        "free",
        choices=SPEED_CHOICES,
        about="longitudinal velocity of the centre of mass; held: that of the start; imposed: that "
        "of `imposed_speed`. "
        "A force along the car in the plane of the road takes or gives what that needs, as an "
        "ideal dynamometer does",
        source="Ge & Ni 2005: u is held; dissertation, chapter 3: the cycle imposes the speed "
        "(one of three readings)",
    )
    imposed_speed: SpeedProfileParameters = group(SpeedProfileParameters, time=(0.0,), speed=(0.0,))
    imposed_at: str = setting(
        "body",
        choices=IMPOSED_AT,
        about="where the force of `imposed` acts; wheels: what mass and drag ask for at the driven "
        "wheels, or all that "
        "brake, as far as side forces leave friction, beside motors and brakes; only the rest "
        "acts on the body",
    )
    imposed_front_braking: float = setting(
        0.6,
        unit="1",
        low=0.0,
        high=1.0,
        about="share of the front axle in the force that brakes at the wheels",
    )
    road: RoadParameters = group(RoadParameters)
    faults: tuple[str, ...] = faults_parameter()
    puncture: PunctureParameters = group(PunctureParameters)

    def __post_init__(self) -> None:
        if self.integrator == "runge_kutta" and self.step > LONGEST_OF_RUNGE_KUTTA:
            raise ParameterError(
                f"parameter step: {self.step:g} is refused, expected at most "
                f"{LONGEST_OF_RUNGE_KUTTA:g} s with integrator runge_kutta"
            )
        if len(self.initial_drive_torque) != 4:
            raise ParameterError("initial_drive_torque needs four elements, one for each wheel")


def load_files(parameters: PlanarParameters) -> PlanarParameters:
    """The parameters with the imposed speed from its file, if they name one."""
    return dataclasses.replace(
        parameters, imposed_speed=with_profile_from_file(parameters.imposed_speed, "imposed_speed")
    )


@dataclass(slots=True)
class RollConstants:
    """The body that rolls, by the symbols of ev_core/vehicle/suspension.py; all 0 for a rigid one.

    What an axle takes is 0 as well where `load_transfer` leaves lateral accelerations out.
    """

    rolls: float = entry(unit="1", about="1 for a body that rolls")
    lever: float = entry(unit="m", about="sway of the centre of mass over the roll angle, e")
    inertia: float = entry(unit="kg m^2", about="of the roll motion, J_x + (1 - m_s/m) m_s d^2")
    weight: float = entry(unit="kg m", about="sprung mass times its arm over the axis, m_s d")
    stiffness: float = entry(unit="N m/rad", about="of both axles, k")
    damping: float = entry(unit="N m s/rad", about="of both axles, b")
    front_link: float = entry(unit="kg m", about="roll moment of the front axle over F_y/m")
    rear_link: float = entry(unit="kg m", about="roll moment of the rear axle over F_y/m")
    front_stiffness: float = entry(unit="N m/rad", about="that loads the front axle")
    rear_stiffness: float = entry(unit="N m/rad", about="that loads the rear axle")
    front_damping: float = entry(unit="N m s/rad", about="that loads the front axle")
    rear_damping: float = entry(unit="N m s/rad", about="that loads the rear axle")


def roll_constants(vehicle: Vehicle) -> RollConstants:
    """The constants of a vehicle's body."""
    suspension = vehicle.suspension
    if not suspension.rolls:
        return RollConstants()
    body = vehicle.rolling_body
    on_loads = float(vehicle.load_transfer in ("both", "lateral"))
    return RollConstants(
        rolls=1.0,
        lever=body.lever,
        inertia=body.inertia,
        weight=body.weight,
        stiffness=suspension.stiffness,
        damping=suspension.front_roll_damping + suspension.rear_roll_damping,
        front_link=on_loads * body.front_link,
        rear_link=on_loads * body.rear_link,
        front_stiffness=on_loads * suspension.front_roll_stiffness,
        rear_stiffness=on_loads * suspension.rear_roll_stiffness,
        front_damping=on_loads * suspension.front_roll_damping,
        rear_damping=on_loads * suspension.rear_roll_damping,
    )


@dataclass(slots=True)
class BodyConstants:
    """Numbers of body, wheels and tyres that the vehicle description does not have itself."""

    wheel_x: list[float] = per_wheel(unit="m", about="of the wheel centre from the centre of mass")
    wheel_y: list[float] = per_wheel(unit="m", about="of the wheel centre from the centre of mass")
    wheel_radius: list[float] = per_wheel(unit="m", about="true rolling radius")
    wheel_inertia: list[float] = per_wheel(
        unit="kg m^2", about="with the part of the rotor behind its gear"
    )
    static_load: list[float] = per_wheel(unit="N", about="on level ground, at rest")
    roll: RollConstants = part(RollConstants)
    cornering_stiffness: list[float] = per_wheel(
        unit="1/rad",
        about="over static load, of a linear lateral curve; itself [N/rad] of a constant stiffness",
    )
    number_of_wheels: float = entry(4.0, unit="1")
    mf: MfTyres = part(MfTyres)
    mf_is_plain: float = entry(unit="1", about="`is_plain` of the tyres")
    tmeasy: list[TmeasyTyre] = each_wheel(TmeasyTyre)
    damping_x: float = entry(unit="N s/m", about="of the carcass, along the wheel")
    damping_y: float = entry(unit="N s/m", about="of the carcass, across the wheel")
    drag: float = entry(unit="N s^2/m^2", about="rho c_d A / 2, or C of the road load")
    side_drag: float = entry(unit="N s^2/m^2", about="rho C_wy F_side / 2")


def wheel_places(vehicle: Vehicle) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """The x and the y of the four wheel centres from the centre of mass [m]."""
    rear = -vehicle.centre_of_mass_to_rear_axle
    front = vehicle.wheelbase + rear
    front_half = vehicle.front_track / 2
    rear_half = vehicle.rear_track / 2
    offset = vehicle.centre_of_mass_offset
    # A centre of mass left of the middle has the left wheels nearer.
    y = (front_half - offset, -front_half - offset, rear_half - offset, -rear_half - offset)
    return (front, front, rear, rear), y


def body_constants(vehicle: Vehicle) -> BodyConstants:
    """The constants of a vehicle; ParameterError if a file that it names has not been read."""
    v, tyre = vehicle, vehicle.tyre
    front_load = v.mass * GRAVITY * v.centre_of_mass_to_rear_axle / v.wheelbase
    rear_load = v.mass * GRAVITY - front_load
    front_stiffness, rear_stiffness = tyre.front_cornering_stiffness, tyre.rear_cornering_stiffness
    if tyre.lateral_curve == "linear":
        # Stiffness of one tyre over its static load, half of the axle's. A centre of mass above the
        # other axle leaves no load: 1 N keeps the division.
        front_stiffness = 2 * front_stiffness / max(front_load, 1.0)
        rear_stiffness = 2 * rear_stiffness / max(rear_load, 1.0)
    for axle, file in (("front", tyre.front_file), ("rear", tyre.rear_file)):
        if file:
            raise ParameterError(f"vehicle.tyre.{axle}_file: {file} has not been read")
    x, y = wheel_places(v)
    static_load = []
    for load, track in ((front_load, v.front_track), (rear_load, v.rear_track)):
        # A centre of mass left of the middle loads the left wheels.
        more = load * v.centre_of_mass_offset / track
        static_load += [0.5 * load + more, 0.5 * load - more]
    mf = mf_tyres(tyre.front_mf, tyre.rear_mf)
    of_tmeasy = []
    for axle in AXLES:
        of_axle = tyre.numbers(axle) if tyre.curve == "tmeasy" else ()
        of_tmeasy += [tmeasy_tyre(of_axle), tmeasy_tyre(of_axle)]
    return BodyConstants(
        wheel_x=list(x),
        wheel_y=list(y),
        wheel_radius=[v.wheel_radius * ratio for ratio in v.wheel_radius_ratio],
        wheel_inertia=wheel_inertias(v),
        static_load=static_load,
        roll=roll_constants(v),
        cornering_stiffness=[front_stiffness, front_stiffness, rear_stiffness, rear_stiffness],
        mf=mf,
        mf_is_plain=float(is_plain(mf)),
        tmeasy=of_tmeasy,
        damping_x=tyre.longitudinal_stiffness * tyre.longitudinal_damping_time,
        damping_y=tyre.lateral_stiffness * tyre.lateral_damping_time,
        drag=0.5 * v.air_density * v.drag_coefficient * v.frontal_area + v.road_load.quadratic,
        side_drag=0.5 * v.air_density * v.side_drag_coefficient * v.side_area,
    )


class CarFaults(NamedTuple):
    """The faults of the car, one after the other.

    Each has its kind, its first period and the first without it, its value, and its wheels.
    """

    kind: tuple[float, ...]
    begin: tuple[float, ...]
    end: tuple[float, ...]
    value: tuple[float, ...]
    wheels: tuple[float, ...]  # four for each fault, 1 where it strikes


def car_faults(
    texts: tuple[str, ...], vehicle: Vehicle, period: float, is_brushless: bool, puncture_fits: bool
) -> CarFaults:
    """The tables; ParameterError for a fault that this car cannot have."""
    faults = [fault for fault in parsed(texts) if fault.kind in OF_THE_CAR]
    for fault in faults:
        _refuse(fault, vehicle, period, is_brushless, puncture_fits)
    periods = [fault.periods(period) for fault in faults]
    return CarFaults(
        tuple(float(CODES.index(fault.kind)) for fault in faults),
        tuple(begin for begin, _ in periods),
        tuple(end for _, end in periods),
        # A delay is one of whole control periods, as commands come.
        tuple(round(f.value / period) if f.kind == "inverter_delay" else f.value for f in faults),
        tuple(wheel for fault in faults for wheel in fault.wheels()),
    )


def _refuse(
    fault: Fault, vehicle: Vehicle, period: float, is_brushless: bool, puncture_fits: bool
) -> None:
    driven = [
        n
        for n, hit in zip(WHEEL_NAMES, fault.wheels(), strict=True)
        if hit and n in vehicle.driven_wheels
    ]
    of_motor = fault.kind not in ("battery_share", "puncture")
    coupling = vehicle.driveline.coupling
    for lacks, needed in (
        (of_motor and not driven, f"a motor there, of {', '.join(vehicle.driven_wheels)}"),
        (of_motor and vehicle.engine.peak_power > 0.0, "motors, not vehicle.engine"),
        (fault.kind == "hall_stuck" and not is_brushless, "drive ideal, averaged or switched"),
        (
            fault.kind == "hall_stuck" and coupling != "individual",
            "vehicle.driveline.coupling individual",
        ),
        (fault.kind == "puncture" and not puncture_fits, "vehicle.tyre.lateral_curve same"),
        (
            fault.kind == "inverter_delay" and fault.value > LONGEST_DELAY * period,
            f"a delay of at most {LONGEST_DELAY * period:g} s, {LONGEST_DELAY} control periods",
        ),
    ):
        if lacks:
            raise ParameterError(f"faults: {quoted(fault.text)} needs {needed}")


@compilable
def find_faults(p: Any, faults: CarFaults, s: PlanarState, period: float) -> None:
    """Find what is wrong in this control period [s].

    Of several faults of a wheel the last one counts, and shares multiply.
    """
    f = s.faults
    for i in range(4):
        # Until a motor sticks its last torque is noted: that is the one at which it will stick.
        if f.stuck[i] == 0.0:
            f.stuck_torque[i] = s.motor_torque[i]
    f.power = 1.0  # as if nothing were wrong; what is remembered stays
    for i in range(4):
        f.share[i], f.flat[i] = 1.0, 0.0
        f.stuck[i] = f.trips_at[i] = f.delay[i] = f.hall[i] = 0.0
    f.is_struck = 1.0 if len(faults.kind) > 0 else 0.0
    for n in range(len(faults.kind)):
        if not faults.begin[n] <= s.periods < faults.end[n]:
            continue
        kind, value = faults.kind[n], faults.value[n]
        if kind == BATTERY_SHARE:
            f.power *= value
        for i in range(4):
            if faults.wheels[4 * n + i] == 0.0:
                continue
            if kind == MOTOR_SHARE:
                f.share[i] *= value
            elif kind == MOTOR_STUCK:
                f.stuck[i] = 1.0
            elif kind == INVERTER_TRIP:
                # 0 stands for never, so a threshold of 0 becomes one that any torque exceeds.
                f.trips_at[i] = max(value, 1e-9)
            elif kind == INVERTER_DELAY:
                f.delay[i] = value
            elif kind == HALL_STUCK:
                f.hall[i] = 1.0
            elif kind == FLAT_TYRE:
                # The time at the end of this period; a puncture that takes no time is flat in its
                # first one.
                since = (s.periods - faults.begin[n] + 1.0) * period
                f.flat[i] = value * min(since / max(p.puncture.time, period), 1.0)
    for i in range(4):
        # An inverter that has tripped stays off as long as its fault lasts.
        if f.trips_at[i] == 0.0:
            f.tripped[i] = 0.0


@compilable
def delay_commands(f: CarFaultState, periods: float, step: Step) -> None:
    """Give each inverter the drive torque asked for its delay ago, none before the start."""
    here = int(periods) % LONGEST_DELAY
    for i in range(4):
        # The ring is written without a delay, too: one that begins later looks back before its
        # begin. Reading comes first, for at the longest delay both places are the same.
        newest = step.drive_command[i]
        if f.delay[i] > 0.0:
            before = int(periods - f.delay[i])
            step.drive_command[i] = (
                f.asked[4 * (before % LONGEST_DELAY) + i] if before >= 0 else 0.0
            )
        f.asked[4 * here + i] = newest


@compilable
def strike_motors(s: PlanarState, p: Any, car: Car, step: Step) -> None:
    """Change the torques that the motors go for in this step, at their shafts."""
    f, target = s.faults, step.target
    for i in range(4):
        if car.driven[i] == 0.0:
            continue
        # By the torque that is asked for, before another fault changes it.
        if f.trips_at[i] > 0.0 and abs(target[i]) > f.trips_at[i]:
            f.tripped[i] = 1.0
        if f.stuck[i] == 1.0:
            target[i] = f.stuck_torque[i]
        if f.hall[i] == 1.0:
            # The electrical angle of the rotor, which begins at zero as that of the wheel does.
            angle = s.motion[WHEEL_ANGLE + i] * car.gear_ratio * p.motor.pole_pairs
            target[i] *= torque_share(angle)
        target[i] = 0.0 if f.tripped[i] == 1.0 else f.share[i] * target[i]


@compilable
def deflate(f: CarFaultState, p: Any, car: Car, body: BodyConstants, step: Step) -> None:
    """Make flat tyres of those under which the road has just been found.

    They are smaller, softer, and harder to roll.
    """
    for i in range(4):
        flat, tyre = f.flat[i], step.tyre[i]
        if flat > 0.0:
            radius = body.wheel_radius[i] * (1.0 - flat * (1.0 - p.puncture.radius))
            step.radius[i] = step.static_radius[i] = radius
            tyre.rolling_resistance += flat * p.puncture.rolling_resistance
            soften(car.tyre.curve, tyre, 1.0 - flat * (1.0 - p.puncture.stiffness))
