"""Constants of the planar plant for a run: step width, car, and tables.

How it works: everything that does not change within a run is worked out here in plain Python, which
may refuse a car in a message. Compiled functions then get numbers and tables alone. The step is the
longest that divides the period and is stable for this car.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from ev_core.law import WHEEL_NAMES, ParameterError, Vehicle, exp, expm1, sqrt
from ev_core.vehicle.driveline import has_equal_motors, has_own_motors
from ev_core.vehicle.losses import NO_MAP, EfficiencyMap, efficiency_map
from ev_core.vehicle.tyre import OF_LOAD
from ev_sim.drives.brushless_motor import phase_of, torque_constant
from ev_sim.drives.drive import DRIVE_MODELS
from ev_sim.plant.guard import GuardLimits, guard_limits
from ev_sim.plant.planar.given import (
    BodyConstants,
    CarFaults,
    PlanarParameters,
    body_constants,
    car_faults,
)
from ev_sim.profiles.profile import Profile, wanted_speed
from ev_sim.surfaces import RoadParameters, Segments, TyreOnRoad, left_and_right, tyre_on_road

# Largest product of step and eigenvalue; the Runge-Kutta method is stable up to 2.78, and at half
# of that the motion that decays within a step is still no worse than it would be if it were exact.
LARGEST_PRODUCT = 1.4
# The same of the semi-implicit method: of what it solves implicitly, which is stable at any product
# but swings from step to step beyond 2, and of what it leads on from the step before, forces on the
# body, which is stable up to 1.
LARGEST_IMPLICIT_PRODUCT = 4.0
LARGEST_LED_PRODUCT = 0.5
# The same for brushless DC drives, which take turns with the wheels: far below the limit of 2 of
# such schemes.
BRUSHLESS_PRODUCT = 0.4
SHORTEST_STEP = 1e-5  # [s], the least that the parameter `step` may be


def longest_step(vehicle: Vehicle, integrator: str = "runge_kutta") -> float:
    """The longest step [s] at which every motion against the carcass springs is stable.

    A mass m_e on a spring k with a damper k tau has eigenvalues of magnitude sqrt(k/m_e) if it
    oscillates, and of at most k tau/m_e if it does not; sliding in the contact only softens that.
    m_e is the least inertia that a carcass can move: the wheel's J/r^2, the car's m/4 and, for its
    yaw, J_z over four squared levers. ParameterError if the step would be below `SHORTEST_STEP`.
    The semi-implicit integrator solves what moves a wheel. The converter of an engine asks for
    none: its stiffness follows the speed, and its torques are taken implicitly where they need it
    (drives/driveline.py).
    """
    tyre = vehicle.tyre
    widest = max(vehicle.front_track, vehicle.rear_track)
    squared_lever = vehicle.wheelbase * vehicle.wheelbase + widest * widest
    body = min(vehicle.mass / 4.0, vehicle.yaw_inertia / (4.0 * squared_lever))
    radius = vehicle.wheel_radius * max(vehicle.wheel_radius_ratio)
    lightest = vehicle.wheel_inertia * min(vehicle.undriven_inertia_ratio, 1.0)
    wheel = min(lightest / (radius * radius), body)
    # A longitudinal carcass moves the rotation of its wheel or the body, a lateral one the body.
    on_tyres = max(
        _fastest(tyre.longitudinal_stiffness, tyre.longitudinal_damping_time, wheel),
        _fastest(tyre.lateral_stiffness, tyre.lateral_damping_time, body),
    )
    _refuse_too_fast(
        on_tyres,
        "tyre: stiffness and damping_time",
        f"wheels of {lightest:g} kg m^2 and a car of {vehicle.mass:g} kg",
    )
    rolling = _fastest_roll(vehicle)
    if integrator == "runge_kutta":
        return LARGEST_PRODUCT / max(on_tyres, rolling)
    led = max(
        _swing(tyre.longitudinal_stiffness, tyre.longitudinal_damping_time, body),
        _swing(tyre.lateral_stiffness, tyre.lateral_damping_time, body),
        rolling,
    )
    return min(LARGEST_IMPLICIT_PRODUCT / on_tyres, LARGEST_LED_PRODUCT / led)


def _refuse_too_fast(fastest: float, what: str, moved: str) -> None:
    """Refuse a motion [rad/s] of what is `moved` that needs steps below `SHORTEST_STEP`."""
    step = LARGEST_PRODUCT / fastest
    if step < SHORTEST_STEP:
        raise ParameterError(
            f"vehicle.{what} need steps of {step:.2g} s with {moved}, "
            f"expected {SHORTEST_STEP:g} s or more"
        )


def _fastest_roll(vehicle: Vehicle) -> float:
    """The fastest motion of a body that rolls [rad/s], 0 for a rigid one.

    A lateral carcass moves less than the car, for the body sways over the axles:
    1/m_e = 4 (1/m + e^2/I).
    """
    suspension, tyre = vehicle.suspension, vehicle.tyre
    if not suspension.rolls:
        return 0.0
    body = vehicle.rolling_body
    mass = 0.25 / (1.0 / vehicle.mass + body.lever * body.lever / body.inertia)
    damping = suspension.front_roll_damping + suspension.rear_roll_damping
    fastest = max(
        _fastest(tyre.lateral_stiffness, tyre.lateral_damping_time, mass),
        sqrt(suspension.stiffness / body.inertia),
        damping / body.inertia,
    )
    moved = f"an inertia of {body.inertia:.4g} kg m^2 in roll"
    _refuse_too_fast(fastest, "suspension: roll stiffness and damping", moved)
    return fastest


def _swing(stiffness: float, damping_time: float, mass: float) -> float:
    squared = stiffness / mass
    return max(sqrt(squared), squared * damping_time)


def _fastest(stiffness: float, damping_time: float, mass: float) -> float:
    # Swinging, overdamped, and a carcass under a sliding contact, which unwinds by u' = -u/tau.
    return max(_swing(stiffness, damping_time, mass), 1.0 / damping_time)


class Track(NamedTuple):
    """Starts of segments [m], and the numbers of `TyreOnRoad` on each, one after the other."""

    start: tuple[float, ...]
    tyres: tuple[float, ...]


class Slope(NamedTuple):
    """Distances [m], grade and side slope [1] there."""

    distance: tuple[float, ...]
    grade: tuple[float, ...]
    side_slope: tuple[float, ...]


class RoadTables(NamedTuple):
    """A road for the tyres of one vehicle."""

    left: Track
    right: Track
    slope: Slope


def road_tables(road: RoadParameters, vehicle: Vehicle) -> RoadTables:
    """The road for this vehicle's tyres."""
    left, right = left_and_right(road)
    scale = road.rolling_resistance_scale
    slope = Slope(road.slope_distance, road.grade, road.side_slope)
    of = {
        name: tyre_on_road(vehicle.tyre, road.surface(name), scale)
        for name in {*left.surface, *right.surface}
    }
    return RoadTables(_track(left, of), _track(right, of), slope)


def _track(segments: Segments, of: Mapping[str, TyreOnRoad]) -> Track:
    return Track(segments.start, tuple(number for name in segments.surface for number in of[name]))


class Lags(NamedTuple):
    """Shares that lags with time constants tau close over a step [1]: 1 - exp(-h/tau)."""

    torque: float
    torque_mean: float  # the mean of the torque's over the step
    clutch: float
    heat: float


class Electrical(NamedTuple):
    """Zeros where it is not modelled."""

    modelled: float = 0.0  # 1 where it is
    # Temperatures [degC] between which cells may be discharged and charged, see
    # `cells.temperature_share`.
    discharge_temperature: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    charge_temperature: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    relaxation_resistance: float = 0.0  # of the battery [ohm]
    relaxation_share: float = 0.0  # what relaxation closes over a step [1]
    # What a step leaves of a difference of temperature [1].
    cells_left: float = 0.0
    winding_left: float = 0.0
    inverter_left: float = 0.0


class PowerConstants(NamedTuple):
    """Constants of battery and motors."""

    capacity: float  # charge between empty and full [A s]
    voltage: tuple[
        float, ...
    ]  # open circuit, at equally spaced states of charge from empty to full [V]
    resistance: float  # of the battery, at once [ohm]
    map: EfficiencyMap
    electrical: Electrical
    gearbox: tuple[float, ...]  # ratios of an engine's gears


class PlanarConstants(NamedTuple):
    """Constants that the functions of the plant get as `c`."""

    h: float  # width of a step [s]
    steps: float  # in a control period
    semi_implicit: float | None  # 1, or None for the Runge-Kutta method: a type of its own
    limits: GuardLimits
    body: BodyConstants
    lags: Lags
    power: PowerConstants
    road: RoadTables
    initial_drive_torque: tuple[float, ...]  # of each wheel [N m]
    imposed: Profile  # speed [m/s]
    faults: CarFaults


def prepare(parameters: PlanarParameters, vehicle: Vehicle, period: float) -> PlanarConstants:
    """The constants of a plant; ParameterError if a file that it names has not been read."""
    p = parameters
    brushless = p.drive in DRIVE_MODELS
    if brushless and not has_equal_motors(vehicle):
        raise ParameterError(
            f"drive {p.drive} needs equal motors and gears at all driven wheels, and no engine"
        )
    steps = number_of_steps(p, vehicle, period)
    motor_torque = p.motor.torque_limit if brushless else vehicle.motor.peak_torque
    return PlanarConstants(
        h=period / steps,
        steps=steps,
        semi_implicit=1.0 if p.integrator == "semi_implicit" else None,
        limits=guard_limits(vehicle, motor_torque, vehicle.maximum_road_wheel_angle),
        body=body_constants(vehicle),
        lags=lags_over(period / steps, vehicle),
        power=PowerConstants(
            # The vehicle has it in A h.
            capacity=vehicle.battery.capacity * 3600.0,
            voltage=vehicle.battery.open_circuit_voltage,
            resistance=vehicle.battery.resistance,
            map=NO_MAP if brushless else efficiency_map(vehicle.motor),
            electrical=Electrical(),
            gearbox=vehicle.engine.gearbox.ratios,
        ),
        road=road_tables(p.road, vehicle),
        initial_drive_torque=checked_initial_torque(p, vehicle),
        imposed=wanted_speed(p.imposed_speed, "imposed_speed"),
        faults=car_faults(
            p.faults, vehicle, period, brushless, vehicle.tyre.lateral_curve == "same"
        ),
    )


def prepare_electrical(
    parameters: PlanarParameters, vehicle: Vehicle, period: float
) -> PlanarConstants:
    """The same with cells and the electrical side of the motors."""
    if parameters.drive in DRIVE_MODELS:
        raise ParameterError(f"electrical needs drive torque_controlled, not {parameters.drive}")
    if vehicle.engine.peak_power > 0.0:
        raise ParameterError("electrical needs motors, not vehicle.engine")
    c, cells = prepare(parameters, vehicle, period), vehicle.battery.cells
    power = c.power._replace(
        voltage=tuple(cells.in_series * voltage for voltage in cells.open_circuit_voltage),
        resistance=cells.in_series * cells.resistance,
        electrical=electrical_over(c.h, vehicle),
    )
    return c._replace(power=power)


def checked_initial_torque(parameters: PlanarParameters, vehicle: Vehicle) -> tuple[float, ...]:
    """Drive torques of the four wheels at the start [N m].

    ParameterError for a car that cannot have them.
    """
    torques = parameters.initial_drive_torque
    undriven = [
        n
        for n, torque in zip(WHEEL_NAMES, torques, strict=True)
        if torque and n not in vehicle.driven_wheels
    ]
    for lacks, needed in (
        (parameters.initial_speed == 0.0, "an initial_speed other than 0"),
        (parameters.drive in DRIVE_MODELS, "drive torque_controlled"),
        (not has_own_motors(vehicle), "vehicle.driveline.coupling individual"),
        (
            # `begin_driven` looks for the slip on one curve over slip.
            vehicle.tyre.curve in (*OF_LOAD, "dry_friction"),
            "a vehicle.tyre.curve over slip, without load dependence of its own",
        ),
        (undriven, f"a motor at {', '.join(undriven)}"),
    ):
        if any(torques) and lacks:
            raise ParameterError(f"initial_drive_torque needs {needed}")
    return torques


def number_of_steps(parameters: PlanarParameters, vehicle: Vehicle, period: float) -> int:
    """Steps in a period, each as wide as it may be at most."""
    longest = min(parameters.step, longest_step(vehicle, parameters.integrator))
    if parameters.integrator == "runge_kutta":
        # The lags of the loads are integrated as well: a step longer than one would overshoot.
        longest = min(longest, parameters.load_transfer_lag)
    if parameters.integrator == "runge_kutta" and vehicle.suspension.roll_lag > 0.0:
        longest = min(longest, vehicle.suspension.roll_lag)
    if parameters.drive in DRIVE_MODELS:
        # A brushless DC drive may see one shaft speed over a step: without voltage to spare its
        # current swings against the wheel with n k/sqrt(2 L J_w), torque constant k behind the gear
        # ratio n.
        constant = vehicle.gear_ratio * torque_constant(parameters.motor)
        inductance = phase_of(parameters.motor).inductance
        longest = min(
            longest, BRUSHLESS_PRODUCT / constant * sqrt(2.0 * inductance * vehicle.wheel_inertia)
        )
    rounding = 1e-12  # a period of a whole number of steps gets no more than that
    return max(math.ceil(period / longest * (1.0 - rounding)), 1)


def lags_over(h: float, vehicle: Vehicle) -> Lags:
    """Shares that the lags close over a step of h [s]."""
    motor = vehicle.motor
    return Lags(
        torque=-expm1(-h / motor.torque_lag),
        # Mean of 1 - exp(-t/tau) over the step: 1 - (1 - exp(-h/tau)) tau/h.
        torque_mean=1.0 + expm1(-h / motor.torque_lag) * motor.torque_lag / h,
        clutch=-expm1(-h / vehicle.driveline.clutch_lag),
        heat=-expm1(-h / motor.overload_time),
    )


def electrical_over(h: float, vehicle: Vehicle) -> Electrical:
    """The constants for steps of h [s]."""
    cells, thermal = vehicle.battery.cells, vehicle.motor.thermal
    return Electrical(
        modelled=1.0,
        discharge_temperature=cells.discharge_temperature,
        charge_temperature=cells.charge_temperature,
        relaxation_resistance=cells.in_series * cells.relaxation_resistance,
        relaxation_share=-expm1(-h / cells.relaxation_time),
        cells_left=exp(-h / (cells.heat_capacity * cells.thermal_resistance)),
        winding_left=exp(-h / (thermal.winding_capacity * thermal.winding_resistance)),
        inverter_left=exp(-h / (thermal.inverter_capacity * thermal.inverter_resistance)),
    )
