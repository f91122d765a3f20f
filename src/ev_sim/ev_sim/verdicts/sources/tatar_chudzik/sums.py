"""Sums over all wheels, which the source aims at or announces, and the radius that its geometry gives."""

from __future__ import annotations

import math

import numpy as np

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.quantities import motion
from ev_sim.report.quantities.car_axes import tyre_force
from ev_sim.report.quantities.passing_speed import energy_since_turning_in, total_force
from ev_sim.report.samples import channel, run_named
from ev_sim.running.recording.recording import Recording
from ev_sim.verdicts.check import Comparison, Number
from ev_sim.verdicts.declaration import judged, no_verdict
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_sim.verdicts.sources.tatar_chudzik.claims import FALLS, MARGIN
from ev_sim.verdicts.sources.tatar_chudzik.runs import CORRECTED, EQUAL, LAYOUTS, RUNS, WHEELS, Values, passing
from ev_sim.verdicts.tolerance import relative

SPEED = 8.5  # [m/s]
ANGLE, REAR_ARM, WHEELBASE = math.pi / 10, 2.0, 4.0  # delta [rad], a_2 and a_1 + a_2 [m]
WALKING = ScenarioNeed(
    "tatar_chudzik",
    (
        ("plant", "initial_speed", 1.0),
        ("plant", "speed", "held"),
        ("driver", "pedals.drive_torque", (0.0,)),
        ("*", "vehicle.steering_geometry", "ackermann"),
        ("steering_column", "profile.time", (0.0,)),
        ("steering_column", "profile.angle", (16.0 * ANGLE,)),
    ),
    ("all_equal",),
    duration=10.0,
)


def sum_of_magnitudes(run: Recording, vehicle: Vehicle) -> np.ndarray:
    """Sum of |F_y| of the four wheels, (n,) [N]."""
    return np.sum([np.abs(tyre_force(run, wheel, vehicle).y) for wheel in WHEELS.values()], axis=0)


def signed_sum(run: Recording, vehicle: Vehicle) -> np.ndarray:
    """Sum of F_y of the four wheels, (n,) [N]."""
    return np.sum([tyre_force(run, wheel, vehicle).y for wheel in WHEELS.values()], axis=0)


def _changes(**quantities: tuple[str, Values]) -> tuple[Comparison, ...]:
    """How the correction changes quantities (unit and values by name) of each layout."""
    return tuple(
        Comparison(
            unit,
            FALLS,
            MARGIN,
            "shown, not judged",
            passing(f"{layout}_{CORRECTED}", SPEED, values),
            passing(f"{layout}_{EQUAL}", SPEED, values),
            f"{layout} {name.replace('_', ' ')}",
        )
        for layout in LAYOUTS
        for name, (unit, values) in quantities.items()
    )


def _radius(driven: ScenarioRuns) -> float:
    run = run_named(driven.runs, "all_equal")
    lateral, yaw_rate = channel(run, "twist.lateral")[-1], channel(run, motion.YAW_RATE)[-1]
    return math.hypot(channel(run, "twist.longitudinal")[-1], lateral - REAR_ARM * yaw_rate) / yaw_rate


DECLARATIONS = (
    no_verdict(
        "tatar.aim",
        "at equal speed and radius the signed sum is m a_y, which no correction can change",
        (RUNS,),
        *_changes(sum_of_magnitudes=("N", sum_of_magnitudes), signed_sum=("N", signed_sum)),
    ),
    judged(
        "tatar.radius",
        WALKING,
        Number(
            "m", WHEELBASE / math.tan(ANGLE), relative(0.01, "no slip angles: 1 m/s, where they are 0.1 deg"), _radius
        ),
        assumption="Ackermann geometry; two parallel wheels, which cannot both roll without slip, turn on 12.6 m",
    ),
    no_verdict(
        "tatar.resistance",
        "announced in the source, not published",
        (RUNS,),
        *_changes(
            drive_energy=("J", lambda run, _: energy_since_turning_in(run)),
            total_tyre_force=("N", lambda run, _: total_force(run)),
        ),
    ),
)
