"""Drive force by steering angle for the controls of the scenario zhileykin2018: who holds, how calm the shares are.

M. M. Zhileykin, A. V. Eranosyan, "Improvement of four-wheel drive vehicle controllability with a connected front axle
through the redistribution of torque" (in Russian), Bauman University, 2018.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from ev_msgs_py.contract.roles import MASTER
from ev_stack.measures.handling import peak_sideslip
from ev_stack.measures.metric import NotMeasured, channel
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.scenario import Run, load_scenario
from ev_study.studies.study import Case, Results

LIMIT = math.radians(
    15.0
)  # sideslip angle beyond which the rear axle has slid out [rad]; assumed, the source has none
SWING = 0.005  # [1], least way of a share between two turn-arounds; assumed: what moves less is no oscillation
CALM = 1  # turn-arounds of one share that entering the bend explains
NOMINAL = "k1"  # the run whose law has the factor 1 of its proportionalities


def deviation_from_circle(run: Recording, begin: float) -> float:
    """Largest distance of the path of the centre of mass after `begin` [s] from the circle that fits it best [m].

    The circle is that of least squares in x^2 + y^2 = 2 a x + 2 b y + c. NotMeasured if the car stands still.
    """
    later = run.time >= begin
    x, y = channel(run, "pose.x")[later], channel(run, "pose.y")[later]
    if len(x) < 3 or np.ptp(x) + np.ptp(y) < 1.0:
        raise NotMeasured("the car does not move")
    x, y = x - x.mean(), y - y.mean()
    (a, b, c), *_ = np.linalg.lstsq(
        np.column_stack((2 * x, 2 * y, np.ones_like(x))), x**2 + y**2, rcond=None
    )
    return float(np.abs(np.hypot(x - a, y - b) - np.sqrt(c + a**2 + b**2)).max())


def off_the_path(run: Recording, x: Sequence[float], y: Sequence[float]) -> float:
    """Largest distance of the centre of mass from a path of straight legs between points [m]."""
    points, at = (
        np.column_stack((x, y)),
        np.column_stack((channel(run, "pose.x"), channel(run, "pose.y"))),
    )
    leg = np.diff(points, axis=0)
    along = np.einsum("nkd,kd->nk", at[:, None] - points[:-1], leg) / (leg**2).sum(axis=1)
    nearest = points[:-1] + np.clip(along, 0.0, 1.0)[..., None] * leg
    return float(np.linalg.norm(at[:, None] - nearest, axis=2).min(axis=1).max())


def front_share(run: Recording) -> np.ndarray:
    """Torque of the front axle over that of the car, h_n, (n,) [1]."""
    front = _asked(run, "front_left") + _asked(run, "front_right")
    return front / (front + _asked(run, "rear_left") + _asked(run, "rear_right"))


def rear_left_share(run: Recording) -> np.ndarray:
    """Torque of the left rear wheel over that of its axle, h_2, (n,) [1]."""
    return _asked(run, "rear_left") / (_asked(run, "rear_left") + _asked(run, "rear_right"))


def rear_right_share(run: Recording) -> np.ndarray:
    """The same of the right one, h_4, (n,) [1]."""
    return _asked(run, "rear_right") / (_asked(run, "rear_left") + _asked(run, "rear_right"))


SHARES = {"h_n": front_share, "h_2": rear_left_share, "h_4": rear_right_share}


def _asked(run: Recording, wheel: str) -> np.ndarray:
    return channel(run, f"torque_request.drive.{wheel}")


def turn_arounds(values: np.ndarray, swing: float) -> int:
    """How often a series turns around after a way of more than `swing`, in its unit."""
    count, direction = 0, 0
    low = high = values[0]
    for value in values:
        low, high = min(low, value), max(high, value)
        if direction >= 0 and value < high - swing:
            count, direction, low = count + (direction > 0), -1, value
        elif direction <= 0 and value > low + swing:
            count, direction, high = count + (direction < 0), 1, value
    return count


SCENARIO = "zhileykin2018"
REAR_DRIVE = "rear_drive"
BY_LAW = ("k05", "k1", "equality")
FIXED = "fixed_split"
CONTROLS = (REAR_DRIVE, *BY_LAW, FIXED)
LAW = "electronic_differential"
FURTHER_READINGS = {  # of the source besides those that have a run of their own: that run, and the law's parameters
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
    of_vehicle = [
        ("*", f"vehicle.{name}", getattr(vehicle, name))
        for name in ("wheel_radius", "steering_ratio")
    ]
    return [
        Case(
            name_of(control, force, angle, variant),
            SCENARIO,
            (
                *of_vehicle,
                ("driver", "pedals.drive_torque", (force * vehicle.wheel_radius,)),
                (
                    "steering_column",
                    "profile.angle",
                    (0.0, math.radians(angle) * vehicle.steering_ratio),
                ),
                *FURTHER_READINGS.get(control, ("", ()))[1],
                *values,
            ),
            FURTHER_READINGS.get(control, (control, ()))[0],
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


def of_all(
    results: Results, control: str, quantity: str = "peak_sideslip", variant: str = ""
) -> np.ndarray:
    """What was measured with a control, (forces, angles), in its unit; NaN where a case was refused."""
    return np.array(
        [
            [
                results[name_of(control, force, angle, variant)].measured.get(quantity, math.nan)
                for angle in ANGLES
            ]
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
