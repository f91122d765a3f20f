"""What goes wrong in the planar plant: motors, inverters, battery, tyres; docs/faults.md has the list."""

from __future__ import annotations

from typing import Any, NamedTuple

from ev_core.faults.fault import OF_THE_CAR, Fault, parsed
from ev_core.law import WHEEL_NAMES, Car, ParameterError, Vehicle, compilable
from ev_msgs_py.refusal import quoted
from ev_sim.drives.brushless_motor import torque_share
from ev_sim.plant.planar.given import BodyConstants
from ev_sim.plant.planar.planar_state import LONGEST_DELAY, WHEEL_ANGLE, CarFaultState, PlanarState, Step
from ev_sim.tyres.curve import soften

CODES = tuple(OF_THE_CAR)
MOTOR_SHARE, MOTOR_STUCK, INVERTER_TRIP, INVERTER_DELAY, HALL_STUCK, BATTERY_SHARE, FLAT_TYRE = range(len(CODES))


class CarFaults(NamedTuple):
    """The faults of the car, one after the other: kind, first period with it and first without, value, and by wheel."""

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
        tuple(round(f.value / period) if f.kind == "inverter_delay" else f.value for f in faults),
        tuple(wheel for fault in faults for wheel in fault.wheels()),
    )


def _refuse(fault: Fault, vehicle: Vehicle, period: float, is_brushless: bool, puncture_fits: bool) -> None:
    driven = [n for n, hit in zip(WHEEL_NAMES, fault.wheels(), strict=True) if hit and n in vehicle.driven_wheels]
    of_motor = fault.kind not in ("battery_share", "puncture")
    coupling = vehicle.driveline.coupling
    for lacks, needed in (
        (of_motor and not driven, f"a motor there, of {', '.join(vehicle.driven_wheels)}"),
        (of_motor and vehicle.engine.peak_power > 0.0, "motors, not vehicle.engine"),
        (fault.kind == "hall_stuck" and not is_brushless, "drive ideal, averaged or switched"),
        (fault.kind == "hall_stuck" and coupling != "individual", "vehicle.driveline.coupling individual"),
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
    """What is wrong in this control period [s]; of several faults of a wheel the last one counts, shares multiply."""
    f = s.faults
    for i in range(4):
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
                f.trips_at[i] = max(value, 1e-9)
            elif kind == INVERTER_DELAY:
                f.delay[i] = value
            elif kind == HALL_STUCK:
                f.hall[i] = 1.0
            elif kind == FLAT_TYRE:
                since = (s.periods - faults.begin[n] + 1.0) * period
                f.flat[i] = value * min(since / max(p.puncture.time, period), 1.0)
    for i in range(4):
        if f.trips_at[i] == 0.0:
            f.tripped[i] = 0.0


@compilable
def delay_commands(f: CarFaultState, periods: float, step: Step) -> None:
    """Give each inverter the drive torque that was asked for its delay ago, none before the start."""
    here = int(periods) % LONGEST_DELAY
    for i in range(4):
        newest = step.drive_command[i]
        if f.delay[i] > 0.0:
            before = int(periods - f.delay[i])
            step.drive_command[i] = f.asked[4 * (before % LONGEST_DELAY) + i] if before >= 0 else 0.0
        f.asked[4 * here + i] = newest


@compilable
def strike_motors(s: PlanarState, p: Any, car: Car, step: Step) -> None:
    """Change the torques that the motors go for in this step, at their shafts."""
    f, target = s.faults, step.target
    for i in range(4):
        if car.driven[i] == 0.0:
            continue
        if f.trips_at[i] > 0.0 and abs(target[i]) > f.trips_at[i]:
            f.tripped[i] = 1.0
        if f.stuck[i] == 1.0:
            target[i] = f.stuck_torque[i]
        if f.hall[i] == 1.0:
            angle = s.motion[WHEEL_ANGLE + i] * car.gear_ratio * p.motor.pole_pairs
            target[i] *= torque_share(angle)
        target[i] = 0.0 if f.tripped[i] == 1.0 else f.share[i] * target[i]


@compilable
def deflate(f: CarFaultState, p: Any, car: Car, body: BodyConstants, step: Step) -> None:
    """Make flat tyres of those that the road has just been looked up for: smaller, softer, harder to roll."""
    for i in range(4):
        flat, tyre = f.flat[i], step.tyre[i]
        if flat > 0.0:
            step.radius[i] = body.wheel_radius[i] * (1.0 - flat * (1.0 - p.puncture.radius))
            tyre.rolling_resistance += flat * p.puncture.rolling_resistance
            soften(car.tyre.curve, tyre, 1.0 - flat * (1.0 - p.puncture.stiffness))
