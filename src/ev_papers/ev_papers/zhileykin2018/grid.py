"""Grid of drive forces and steering angles over which the controls of zhileykin2018 are driven.

M. M. Zhileykin, A. V. Eranosyan, "Improvement of four-wheel drive vehicle controllability with a
connected front axle through the redistribution of torque" (in Russian), Bauman University, 2018.

The source has one run without its force and angle, so each claim is counted over 40 of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ev_msgs_py.contract.roles import MASTER
from ev_papers.zhileykin2018.shares import SHARES, reversals
from ev_stack.measures.handling import peak_sideslip
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Run
from ev_stack.scenarios.scenario import load_scenario
from ev_study.studies.study import Case, Results

Values = tuple[tuple[str, str, Any], ...]

SCENARIO = "zhileykin2018"
LAW = "electronic_differential"
# Sideslip angle beyond which the rear axle has slid out [rad]; assumed, the source has none.
LIMIT = math.radians(15.0)
CALM = 1  # turn-arounds of one share that entering the bend explains
NOMINAL = "k1"  # the run with the factor 1 in the proportionalities of the law
REAR_DRIVE = "rear_drive"
BY_LAW = ("k05", NOMINAL, "equality")
FIXED = "fixed_split"
CONTROLS = (REAR_DRIVE, *BY_LAW, FIXED)
# Readings of the source without a run of their own: the run they change, and what in it.
FURTHER_READINGS: Mapping[str, tuple[str, Values]] = {
    "k048": ("k1", ((LAW, "factor", "inertia"),)),
    "k1_derived": ("k1", ((LAW, "second_branch", "derived"),)),
    "k1_rear_share": ("k1", ((LAW, "second_branch", "rear_share"),)),
    "k1_by_geometry": ("k1", ((LAW, "rear_wheels", "by_geometry"),)),
    "equality_by_geometry": ("equality", ((LAW, "rear_wheels", "by_geometry"),)),
}
SWEPT = (
    REAR_DRIVE,
    "k048",
    "k05",
    "k1",
    "k1_derived",
    "k1_rear_share",
    "k1_by_geometry",
    "equality",
    "equality_by_geometry",
    FIXED,
)
FORCES = (2000.0, 2500.0, 3000.0, 3500.0, 4000.0)  # of all wheels together [N]
ANGLES = tuple(range(3, 11))  # of the road wheels [deg]
SIZE = len(FORCES) * len(ANGLES)
MOTORS = "motors"
# An engine of the same 60 kW with converter, gearbox and final drive, as docs/drivelines.md has
# them, in place of the motors; `motor` is the drive as laws know it. All of it is assumed: the
# source has eight equations of its driveline, which the page lists, and no value for any of them.
ENGINE: Values = (
    ("*", "vehicle.engine.peak_power", 60e3),
    ("*", "vehicle.gear_ratio", 4.1),
    ("*", "vehicle.motor.peak_torque", 400.0),
    ("*", "vehicle.motor.nominal_torque", 400.0),
    ("*", "vehicle.motor.peak_power", 60e3),
    ("*", "vehicle.motor.maximum_speed", 812.0),
)
# The source's own: its i_g is one ratio, so nothing interrupts the torque of its engine.
ONE_GEAR: Values = (*ENGINE, ("*", "vehicle.engine.gearbox.ratios", (2.2,)))
DRIVES: Mapping[str, Values] = {MOTORS: (), "engine": ENGINE, "engine_in_one_gear": ONE_GEAR}


def cases_of(controls: Iterable[str], values: Values = (), variant: str = "") -> list[Case]:
    """Every control or reading at every force and angle, with further values of a variant."""
    vehicle = load_scenario(SCENARIO).runs[0].configurations[MASTER].common.vehicle
    radius, ratio = vehicle.wheel_radius, vehicle.steering_ratio
    # Set as well, so that a force and an angle stay the same whatever car is driven.
    of_vehicle = (
        ("*", "vehicle.wheel_radius", radius),
        ("*", "vehicle.steering_ratio", ratio),
    )
    controls = tuple(controls)
    found = []
    for force in FORCES:
        for angle in ANGLES:
            for control in controls:
                run, reading = FURTHER_READINGS.get(control, (control, ()))
                changed = (
                    *of_vehicle,
                    ("driver", "pedals.drive_torque", (force * radius,)),
                    ("steering_column", "profile.angle", (0.0, math.radians(angle) * ratio)),
                    *reading,
                    *values,
                )
                name = name_of(control, force, angle, variant)
                found.append(Case(name, SCENARIO, changed, run))
    return found


def name_of(control: str, force: float, angle: float, variant: str = "") -> str:
    """Name of a case; force [N], angle [deg]."""
    return f"{control} {force:g} N {angle:g} deg {variant}".strip()


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Largest sideslip angle of the moving car [rad], and reversals of each share."""
    turned = {share: reversals(recording, share) for share in SHARES}
    return {"peak_sideslip": peak_sideslip(recording), **turned}


def of_all(
    results: Results, control: str, quantity: str = "peak_sideslip", variant: str = ""
) -> np.ndarray:
    """Numbers measured with a control, (forces, angles), in their unit; NaN if refused."""

    def number(force: float, angle: float) -> float:
        return results[name_of(control, force, angle, variant)].measured.get(quantity, math.nan)

    return np.array([[number(force, angle) for angle in ANGLES] for force in FORCES])


def holds(results: Results, control: str, variant: str = "") -> np.ndarray:
    """True where the sideslip angle stays below the limit, (forces, angles)."""
    return of_all(results, control, variant=variant) < LIMIT


def spins(results: Results, variant: str = "") -> np.ndarray:
    """True where the rear-driven car passes the limit, (forces, angles)."""
    return of_all(results, REAR_DRIVE, variant=variant) >= LIMIT


def is_calm(results: Results, control: str, share: str) -> np.ndarray:
    """True where a share turns around no more than entering a bend explains, (forces, angles)."""
    return of_all(results, control, share) <= CALM
