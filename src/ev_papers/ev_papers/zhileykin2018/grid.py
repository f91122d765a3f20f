"""Drive force by steering angle for the controls of the scenario zhileykin2018, and who holds where."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ev_msgs_py.contract.roles import MASTER
from ev_papers.zhileykin2018.quantities import CALM, LIMIT, SHARES, SWING, turn_arounds
from ev_sim.measures.handling import peak_sideslip
from ev_sim.recording.recording import Recording
from ev_sim.scenarios.scenario import Run, load_scenario
from ev_sim.study.study import Case, Results

SCENARIO = "zhileykin2018"
REAR_DRIVE = "rear_drive"
BY_LAW = ("k05", "k1", "equality")
FIXED = "fixed_split"
CONTROLS = (REAR_DRIVE, *BY_LAW, FIXED)
LAW = "electronic_differential"
READINGS = {  # of the source besides those that have a run of their own: that run, and what the law is told
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

Values = tuple[tuple[str, str, Any], ...]
MOTORS = "motors"
# An engine of the same 60 kW with converter, gearbox and final drive, as docs/drivelines.md has them, in place of the
# motors; `motor` is the drive as laws know it. All of it is assumed: the source has eight
# equations of its driveline, which the page lists, and no value for any of them.
ENGINE: Values = (
    ("*", "vehicle.engine.peak_power", 60e3),
    ("*", "vehicle.gear_ratio", 4.1),
    ("*", "vehicle.motor.peak_torque", 400.0),
    ("*", "vehicle.motor.nominal_torque", 400.0),
    ("*", "vehicle.motor.peak_power", 60e3),
    ("*", "vehicle.motor.maximum_speed", 812.0),
)
DRIVES: Mapping[str, Values] = {MOTORS: (), "engine": ENGINE}


def cases_of(controls: Iterable[str], values: Values = (), variant: str = "") -> list[Case]:
    """Every control or reading at every force and angle, with further parameters (node, name, value) of a variant."""
    vehicle = load_scenario(SCENARIO).runs[0].configurations[MASTER].common.vehicle
    # With these a force and an angle become a torque and an angle of the steering wheel, whatever car is driven.
    told = [("*", f"vehicle.{name}", getattr(vehicle, name)) for name in ("wheel_radius", "steering_ratio")]
    return [
        Case(
            name_of(control, force, angle, variant),
            SCENARIO,
            (
                *told,
                ("driver", "pedals.drive_torque", (force * vehicle.wheel_radius,)),
                ("steering_column", "profile.angle", (0.0, math.radians(angle) * vehicle.steering_ratio)),
                *READINGS.get(control, ("", ()))[1],
                *values,
            ),
            READINGS.get(control, (control, ()))[0],
        )
        for force in FORCES
        for angle in ANGLES
        for control in controls
    ]


def name_of(control: str, force: float, angle: float, variant: str = "") -> str:
    """Name of a case; force [N], angle [deg]."""
    return f"{control} {force:g} N {angle:g} deg {variant}".strip()


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Largest sideslip angle of the moving car [rad], and turn-arounds of each share of the torque."""
    shares = {name: turn_arounds(share(recording), SWING) for name, share in SHARES.items()}
    return {"peak_sideslip": peak_sideslip(recording), **shares}


def of_all(results: Results, control: str, quantity: str = "peak_sideslip", variant: str = "") -> np.ndarray:
    """What was measured with a control, (forces, angles), in its unit; NaN where a case was refused."""
    return np.array(
        [
            [results[name_of(control, force, angle, variant)].measured.get(quantity, math.nan) for angle in ANGLES]
            for force in FORCES
        ]
    )


def holds(results: Results, control: str, variant: str = "") -> np.ndarray:
    """Whether the sideslip angle stays below the limit, (forces, angles)."""
    return of_all(results, control, variant=variant) < LIMIT


def spins(results: Results, variant: str = "") -> np.ndarray:
    """Whether the rear-driven car passes the limit, (forces, angles)."""
    return of_all(results, REAR_DRIVE, variant=variant) >= LIMIT


def is_calm(results: Results, control: str, share: str) -> np.ndarray:
    """Whether a share (h_n, h_2, h_4) turns around no more than entering a bend explains, (forces, angles)."""
    return of_all(results, control, share) <= CALM
