"""What goes wrong in the planar plant: motors, inverters, battery, tyres; docs/faults.md says how each is meant."""

from __future__ import annotations

from typing import Any

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.vehicle.car import Car
from ev_sim.drives.hall_fault import torque_share
from ev_sim.plant.planar.constants import BodyConstants
from ev_sim.plant.planar.faults.parameters import (
    BATTERY,
    DELAY,
    HALL,
    LONGEST_DELAY,
    PUNCTURE,
    SHARE,
    STUCK,
    TRIP,
    CarFaults,
)
from ev_sim.plant.planar.faults.state import FaultState
from ev_sim.plant.planar.memory import Step
from ev_sim.plant.planar.state import WHEEL_ANGLE, PlanarState
from ev_sim.tyres.softened import soften


@compilable
def find_faults(p: Any, faults: CarFaults, s: PlanarState, period: float) -> None:
    """What is wrong in this control period [s]; of several faults of a wheel the last one counts, shares multiply."""
    f = s.faults
    for i in range(4):
        if f.stuck[i] == 0.0:
            f.stuck_torque[i] = s.motor_torque[i]
    clear(f)
    f.is_struck = 1.0 if len(faults.kind) > 0 else 0.0
    for n in range(len(faults.kind)):
        if not faults.begin[n] <= s.periods < faults.end[n]:
            continue
        kind, value = faults.kind[n], faults.value[n]
        if kind == BATTERY:
            f.power *= value
        for i in range(4):
            if faults.wheels[4 * n + i] == 0.0:
                continue
            if kind == SHARE:
                f.share[i] *= value
            elif kind == STUCK:
                f.stuck[i] = 1.0
            elif kind == TRIP:
                f.trips_at[i] = max(value, 1e-9)
            elif kind == DELAY:
                f.delay[i] = value
            elif kind == HALL:
                f.hall[i] = 1.0
            elif kind == PUNCTURE:
                since = (s.periods - faults.begin[n] + 1.0) * period
                f.flat[i] = value * min(since / max(p.puncture.time, period), 1.0)
    for i in range(4):
        if f.trips_at[i] == 0.0:
            f.tripped[i] = 0.0


@compilable
def clear(f: FaultState) -> None:
    """As if nothing were wrong; what is remembered stays."""
    f.power = 1.0
    for i in range(4):
        f.share[i], f.flat[i] = 1.0, 0.0
        f.stuck[i] = f.trips_at[i] = f.delay[i] = f.hall[i] = 0.0


@compilable
def delay_commands(f: FaultState, periods: float, step: Step) -> None:
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
def deflate(f: FaultState, p: Any, car: Car, body: BodyConstants, step: Step) -> None:
    """Make flat tyres of those that the road has just been looked up for: smaller, softer, harder to roll."""
    for i in range(4):
        flat, tyre = f.flat[i], step.tyre[i]
        if flat > 0.0:
            step.radius[i] = body.wheel_radius[i] * (1.0 - flat * (1.0 - p.puncture.radius))
            tyre.rolling_resistance += flat * p.puncture.rolling_resistance
            soften(car.tyre.curve, tyre, 1.0 - flat * (1.0 - p.puncture.stiffness))
