"""What the checks drive: cars, roads, manoeuvres, laws in named combinations, and draws that are the same for all laws.

All of it is assumed: the abstracts name neither car nor manoeuvre. Draws vary what laws are told (mass, yaw inertia)
and what they are not (friction, noise).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

from ev_control.torque_vectoring.reference import (
    UNDERSTEER,
    ReferenceParameters,
    ReferenceState,
    wanted_motion,
)
from ev_core.lockstep.configuration import Configuration
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.surfaces import SURFACES
from ev_sim.understeer import axle_cornering_stiffnesses
from ev_stack.measures import motion
from ev_stack.measures.handling import peak_sideslip
from ev_stack.measures.metric import channel
from ev_stack.measures.named import DrivenRun
from ev_stack.measures.registry import METRICS
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.scenario import Overrides, Run, load_scenario
from ev_stack.scenarios.slow_ramp import AT_CROSSING, angle_at
from ev_study.studies.study import Case, Results

Values = tuple[tuple[str, str, Any], ...]
LAW = "electronic_differential"
DRAWS = 10
SEED = 34
REAR = (("*", "vehicle.driven_wheels", ("rear_left", "rear_right")),)
CARS: Mapping[str, tuple[str, Values]] = {  # by driven wheels
    "all": ("layout_1_8_c", ()),
    "rear": ("compact_ev", REAR),
    "front": ("audi_a2", ()),
}
ROADS = {"dry": "dry_asphalt", "wet": "wet_asphalt_2", "snow": "packed_snow_1"}
_SCALE = (("steering_column", "scale", 1.0),)  # angles of the file, whatever the car
# Scenario, its run, duration [s], and what differs from the file.
MANOEUVRES: Mapping[str, tuple[str, str, float, Values]] = {
    "ramp": ("sine_with_dwell", "slowly_increasing_steer", 5.0, _SCALE),
    "step": ("step_steer", "left", 5.0, (("steering_column", "scale", 2.0),)),
    "hard_step": (
        "step_steer",
        "left",
        6.0,
        (("steering_column", "scale", 3.0),),
    ),  # beyond any grip on a wet road
    "sine": ("sine_with_dwell", "times_3_5", 5.0, _SCALE),
    "lane_change": ("double_lane_change", "", 8.0, ()),
    "lap": ("lap", "", 70.0, ()),
}
TRUTH, SENSORS = "truth", "estimated"
BASE = "equal_torque"
CONTROLLERS = ("pi", "lqr", "sliding_mode", "super_twisting", "suboptimal")
SECOND_ORDER = ("super_twisting", "suboptimal")
PARTS: Mapping[str, Mapping[str, str]] = {  # a part other than that of `pi`
    "pi_neutral": {"controller": "pi", "reference": "neutral"},
    "pi_load": {"controller": "pi", "allocation": "load"},
    "pi_least_squares": {"controller": "pi", "allocation": "least_squares"},
    "pi_neutral_least_squares": {
        "controller": "pi",
        "reference": "neutral",
        "allocation": "least_squares",
    },
}
LIMIT = math.radians(
    10.0
)  # of sideslip; assumed: the abstract calls its own limits acceptable and names none
RAMP_ACCELERATION = 4.0  # [m/s^2], at which the steering-wheel angle of the ramp is read


def law(name: str, known: str = TRUTH, told: float = 1.0, **parts: str) -> Values:
    """A law by its name, with what it knows, and the friction that it believes in over the true one."""
    if name == BASE:
        return ((LAW, "method", BASE),)
    chosen = {**PARTS.get(name, {"controller": name}), "estimation": known, **parts}
    given = tuple((LAW, part, value) for part, value in chosen.items())
    return ((LAW, "method", "direct_yaw_moment"), *given, (LAW, "known.error_factor", told))


@cache
def drawn() -> Mapping[str, np.ndarray]:
    """By name a number for each draw, even within its bounds."""
    random = np.random.Generator(np.random.PCG64(SEED))
    bounds = {
        "mass": (1.0, 1.2),  # factors
        "yaw_inertia": (0.9, 1.2),
        "friction": (0.8, 1.05),
        "imu_yaw_rate": (0.0, 0.01),  # noise [rad/s]
        "imu_acceleration": (0.0, 0.2),  # [m/s^2]
        "wheel_speed": (0.0, 0.1),  # [rad/s]
        "front": (
            0.6,
            1.4,
        ),  # cornering stiffness that a law believes in over the true one, where it is told wrongly
        "rear": (0.6, 1.4),
    }
    return {name: low + (high - low) * random.random(DRAWS) for name, (low, high) in bounds.items()}


@cache
def _configurations(car: str, manoeuvre: str) -> Mapping[str, Configuration]:
    vehicle, values = CARS[car]
    scenario, run, duration, _ = MANOEUVRES[manoeuvre]
    found = load_scenario(scenario, Overrides((), values, duration, vehicle), (run,) if run else ())
    return found.runs[0].configurations


def case(
    name: str,
    car: str,
    manoeuvre: str,
    road: str,
    draw: int,
    of_law: Values,
    wrong_tyres: bool = False,
) -> Case:
    """A draw of a law on a car, in a manoeuvre, on a road; with `wrong_tyres` the law believes in drawn stiffnesses."""
    of_draw, vehicle = drawn(), _configurations(car, manoeuvre)[MASTER].common.vehicle
    scenario, run, duration, values = MANOEUVRES[manoeuvre]
    surface, friction = SURFACES[ROADS[road]], float(of_draw["friction"][draw])
    of_road = {
        "pattern": "constant",
        "own": ("drawn",),
        "left": ("drawn",),
        "right": ("drawn",),
        "own_c1": (friction * surface.c1,),
        "own_c2": (surface.c2,),
        "own_c3": (friction * surface.c3,),
        "own_rolling_resistance": (surface.rolling_resistance,),
    }
    noise = [
        (MASTER, f"sensors.{n}.noise", float(of_draw[n][draw]))
        for n in ("imu_yaw_rate", "imu_acceleration", "wheel_speed")
    ]
    believed: list[tuple[str, str, Any]] = []
    for axle, stiffness in zip(("front", "rear"), axle_cornering_stiffnesses(vehicle), strict=True):
        factor = float(of_draw[axle][draw]) if wrong_tyres else 1.0
        for group in ("single_track", "known.observer"):
            believed.append((LAW, f"{group}.{axle}_cornering_stiffness", factor * stiffness))
    return Case(
        name,
        scenario,
        (
            *CARS[car][1],
            *values,
            *((MASTER, f"road.{key}", value) for key, value in of_road.items()),
            ("*", "seed", draw + 1),
            *(
                ("*", f"vehicle.{n}", getattr(vehicle, n) * float(of_draw[n][draw]))
                for n in ("mass", "yaw_inertia")
            ),
            *noise,
            *(believed if of_law[0][2] != BASE else ()),
            *of_law,
        ),
        run,
        duration=duration,
        vehicle=CARS[car][0],
    )


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Tracking error [rad/s], largest sideslip angle [rad], battery energy [J] and, on a ramp, its angle [rad]."""
    vehicle = run.configurations[MASTER].common.vehicle
    driven = DrivenRun(recording, vehicle)
    found: dict[str, Any] = {
        "tracking": tracking_error(recording, run),
        "sideslip": peak_sideslip(recording),
        "energy": METRICS["battery_energy"].of(driven),
    }
    if run.name == MANOEUVRES["ramp"][1]:
        found["angle"] = angle_at(recording, RAMP_ACCELERATION, AT_CROSSING)
    return found


def tracking_error(recording: Recording, run: Run) -> float:
    """Root mean square of the yaw rate less the designed one [rad/s].

    The designed yaw rate is that of the reference `understeer` with its default parameters and the true grip,
    whatever the law knows and whichever reference it has.
    """
    vehicle = run.configurations[MASTER].common.vehicle
    load, friction = (
        np.array([channel(recording, f"tire_forces.{name}.{wheel}") for wheel in WHEEL_NAMES])
        for name in ("load", "friction_coefficient")
    )
    grip = (load * friction).sum(axis=0) / vehicle.mass
    speed, angle = (
        channel(recording, "twist.longitudinal"),
        channel(recording, motion.ROAD_WHEEL_ANGLE),
    )
    state, wanted = ReferenceState(), np.zeros_like(speed)
    period = float(recording.time[1] - recording.time[0])
    for n in range(len(speed)):
        if abs(speed[n]) > 1.0:
            wanted[n] = wanted_motion(
                ReferenceParameters(),
                vehicle,
                state,
                period,
                UNDERSTEER,
                speed[n],
                angle[n],
                grip[n],
                0.0,
                0.0,
            ).yaw_rate
    return float(np.sqrt(np.mean((channel(recording, motion.YAW_RATE) - wanted) ** 2)))


def of_draws(results: Results, name: str, quantity: str) -> np.ndarray:
    """What was measured on the draws of a cell, (draws,); NaN where one was refused."""
    return np.array(
        [results[f"{name}: {draw}"].measured.get(quantity, math.nan) for draw in range(DRAWS)]
    )


RESAMPLES = 1000


@cache
def _chosen(draws: int) -> np.ndarray:
    """Which draws each resample has, (resamples, draws)."""
    return np.random.Generator(np.random.PCG64(SEED)).integers(draws, size=(RESAMPLES, draws))


def interval(values: np.ndarray) -> tuple[float, float, float]:
    """The median of the draws and the ends of its 95 % interval by a seeded bootstrap."""
    low, high = np.percentile(np.median(values[_chosen(len(values))], axis=1), (2.5, 97.5))
    return float(np.median(values)), float(low), float(high)
