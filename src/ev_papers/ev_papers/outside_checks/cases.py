"""Cases of the checks: cars, roads, manoeuvres and laws in named combinations, over seeded draws.

All of it is assumed: the abstracts name neither car nor manoeuvre. The draws are the same for all
laws. They vary what laws know (mass, yaw inertia) and what they do not (friction, noise).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from ev_control.torque_vectoring.reference import (
    Bend,
    Reference,
    ReferenceParameters,
    ReferenceState,
    wanted_motion,
)
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.roles import MASTER
from ev_sim.surfaces import SURFACES
from ev_sim.understeer import axle_cornering_stiffnesses
from ev_stack.measures import motion
from ev_stack.measures.handling import of_wheels, peak_sideslip
from ev_stack.measures.metric import channel
from ev_stack.measures.named import DrivenRun
from ev_stack.measures.registry import METRICS
from ev_stack.recording.recording import Recording
from ev_stack.running.steering_angles import angle_at
from ev_stack.scenarios.records import Overrides, Run
from ev_stack.scenarios.scenario import load_scenario
from ev_stack.scenarios.slow_ramp import AT_CROSSING
from ev_study.studies.study import Case, Results

Values = tuple[tuple[str, str, Any], ...]
LAW = "electronic_differential"
DRAWS = 10
SEED = 34
RESAMPLES = 1000  # of the bootstrap
_REAR_DRIVEN: Values = (("*", "vehicle.driven_wheels", ("rear_left", "rear_right")),)
# By driven wheels the vehicle, and what differs from it.
CARS: Mapping[str, tuple[str, Values]] = {
    "all": ("layout_1_8_c", ()),
    "rear": ("compact_ev", _REAR_DRIVEN),
    "front": ("audi_a2", ()),
}
ROADS = {"dry": "dry_asphalt", "wet": "wet_asphalt_2", "snow": "packed_snow_1"}
RAMP = "slowly_increasing_steer"
# Scaled by one, so that the angles are those of the file, whatever the car.
_AS_IN_THE_FILE: Values = (("steering_column", "scale", 1.0),)
TRUTH = "truth"
SENSORS = "estimated"
BASE = "equal_torque"
SECOND_ORDER = ("super_twisting", "suboptimal")
CONTROLLERS = ("pi", "lqr", "sliding_mode", *SECOND_ORDER)
# Laws with another part than `pi` has.
PARTS: Mapping[str, Mapping[str, str]] = {
    "pi_neutral": {"controller": "pi", "reference": "neutral"},
    "pi_load": {"controller": "pi", "allocation": "load"},
    "pi_least_squares": {"controller": "pi", "allocation": "least_squares"},
    "pi_neutral_least_squares": {
        "controller": "pi",
        "reference": "neutral",
        "allocation": "least_squares",
    },
}
# Sideslip; assumed: the abstract calls its own limits acceptable and names none [rad].
LIMIT = math.radians(10.0)
RAMP_ACCELERATION = 4.0  # [m/s^2], at which the steering-wheel angle of the ramp is read
# Bounds of the drawn numbers: factors of the car and of the road, noise of the sensors, and the
# cornering stiffness that a law believes in over the true one, where it is given a wrong one.
_BOUNDS: Mapping[str, tuple[float, float]] = {
    "mass": (1.0, 1.2),
    "yaw_inertia": (0.9, 1.2),
    "friction": (0.8, 1.05),
    "imu_yaw_rate": (0.0, 0.01),  # [rad/s]
    "imu_acceleration": (0.0, 0.2),  # [m/s^2]
    "wheel_speed": (0.0, 0.1),  # [rad/s]
    "front": (0.6, 1.4),
    "rear": (0.6, 1.4),
}


class Manoeuvre(NamedTuple):
    """Scenario, its run, duration [s], and what differs from the file."""

    scenario: str
    run: str
    duration: float
    values: Values = ()


class Setting(NamedTuple):
    """Car, manoeuvre and road of a case, by their names."""

    car: str
    manoeuvre: str
    road: str


MANOEUVRES: Mapping[str, Manoeuvre] = {
    "ramp": Manoeuvre("sine_with_dwell", RAMP, 5.0, _AS_IN_THE_FILE),
    "step": Manoeuvre("step_steer", "left", 5.0, (("steering_column", "scale", 2.0),)),
    # Beyond any grip on a wet road.
    "hard_step": Manoeuvre("step_steer", "left", 6.0, (("steering_column", "scale", 3.0),)),
    "sine": Manoeuvre("sine_with_dwell", "times_3_5", 5.0, _AS_IN_THE_FILE),
    "lane_change": Manoeuvre("double_lane_change", "", 8.0),
    "lap": Manoeuvre("lap", "", 70.0),
}


def law(name: str, known: str = TRUTH, factor: float = 1.0, **parts: str) -> Values:
    """A law by its name, with what it knows, and the friction it believes in over the true one."""
    if name == BASE:
        return ((LAW, "method", BASE),)
    chosen = {**PARTS.get(name, {"controller": name}), "estimation": known, **parts}
    given = tuple((LAW, part, value) for part, value in chosen.items())
    return (
        (LAW, "method", "direct_yaw_moment"),
        *given,
        (LAW, "known.error_factor", factor),
    )


@cache
def drawn() -> Mapping[str, np.ndarray]:
    """A number for each draw by name, uniform within its bounds."""
    random = np.random.Generator(np.random.PCG64(SEED))
    # In the order of the bounds: another order would draw other numbers.
    return {
        name: low + (high - low) * random.random(DRAWS) for name, (low, high) in _BOUNDS.items()
    }


def number_drawn(name: str, draw: int) -> float:
    """One of the drawn numbers."""
    return float(drawn()[name][draw])


@cache
def _vehicle(car: str, manoeuvre: str) -> Vehicle:
    name, values = CARS[car]
    of = MANOEUVRES[manoeuvre]
    changed = Overrides((), values, of.duration, name)
    found = load_scenario(of.scenario, changed, (of.run,) if of.run else ())
    return found.runs[0].configurations[MASTER].common.vehicle


def case(name: str, setting: Setting, draw: int, of_law: Values, wrong_tyres: bool = False) -> Case:
    """A draw of a law in a setting; with `wrong_tyres` the law believes in drawn stiffnesses."""
    vehicle_name, of_car = CARS[setting.car]
    manoeuvre = MANOEUVRES[setting.manoeuvre]
    vehicle = _vehicle(setting.car, setting.manoeuvre)
    drawn_car = (
        ("*", "vehicle.mass", vehicle.mass * number_drawn("mass", draw)),
        ("*", "vehicle.yaw_inertia", vehicle.yaw_inertia * number_drawn("yaw_inertia", draw)),
    )
    values = (
        *of_car,
        *manoeuvre.values,
        *_drawn_road(setting.road, draw),
        ("*", "seed", draw + 1),
        *drawn_car,
        *_noise(draw),
    )
    # Equal torques believe in nothing.
    if of_law[0] != (LAW, "method", BASE):
        values += _believed_tyres(vehicle, draw, wrong_tyres)
    return Case(
        name,
        manoeuvre.scenario,
        values + of_law,
        manoeuvre.run,
        duration=manoeuvre.duration,
        vehicle=vehicle_name,
    )


def _drawn_road(road: str, draw: int) -> Values:
    """A road with the curve of a surface, and a friction of its own."""
    surface = SURFACES[ROADS[road]]
    friction = number_drawn("friction", draw)
    return (
        (MASTER, "road.pattern", "constant"),
        (MASTER, "road.own", ("drawn",)),
        (MASTER, "road.left", ("drawn",)),
        (MASTER, "road.right", ("drawn",)),
        (MASTER, "road.own_c1", (friction * surface.c1,)),
        (MASTER, "road.own_c2", (surface.c2,)),
        (MASTER, "road.own_c3", (friction * surface.c3,)),
        (MASTER, "road.own_rolling_resistance", (surface.rolling_resistance,)),
    )


def _noise(draw: int) -> Values:
    sensors = ("imu_yaw_rate", "imu_acceleration", "wheel_speed")
    return tuple((MASTER, f"sensors.{name}.noise", number_drawn(name, draw)) for name in sensors)


def _believed_tyres(vehicle: Vehicle, draw: int, wrong: bool) -> Values:
    """Cornering stiffnesses that controller and observer of a law believe in."""
    front, rear = axle_cornering_stiffnesses(vehicle)
    if wrong:
        front = number_drawn("front", draw) * front
        rear = number_drawn("rear", draw) * rear
    return (
        (LAW, "single_track.front_cornering_stiffness", front),
        (LAW, "known.observer.front_cornering_stiffness", front),
        (LAW, "single_track.rear_cornering_stiffness", rear),
        (LAW, "known.observer.rear_cornering_stiffness", rear),
    )


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Tracking error [rad/s], largest sideslip [rad], battery energy [J]; angle of a ramp [rad]."""
    vehicle = run.configurations[MASTER].common.vehicle
    found: dict[str, Any] = {
        "tracking": tracking_error(recording, vehicle),
        "sideslip": peak_sideslip(recording),
        "energy": METRICS["battery_energy"].of(DrivenRun(recording, vehicle)),
    }
    if run.name == RAMP:
        found["angle"] = angle_at(recording, RAMP_ACCELERATION, AT_CROSSING)
    return found


def tracking_error(recording: Recording, vehicle: Vehicle) -> float:
    """Root mean square of the yaw rate less the designed one [rad/s].

    The designed yaw rate is that of the reference `understeer` with its default parameters and the
    true grip, whatever the law knows and whichever reference it has.
    """
    load = of_wheels(recording, "tire_forces.load")
    friction = of_wheels(recording, "tire_forces.friction_coefficient")
    grip = (load * friction).sum(axis=0) / vehicle.mass
    speed = channel(recording, "twist.longitudinal")
    angle = channel(recording, motion.ROAD_WHEEL_ANGLE)
    period = float(recording.time[1] - recording.time[0])
    state = ReferenceState()
    wanted = np.zeros_like(speed)
    for n in range(len(speed)):
        if abs(speed[n]) > 1.0:
            bend = Bend(speed[n], angle[n], grip[n], 0.0, 0.0)
            found = wanted_motion(
                ReferenceParameters(), vehicle, state, period, Reference.UNDERSTEER, bend
            )
            wanted[n] = found.yaw_rate
    error = channel(recording, motion.YAW_RATE) - wanted
    return float(np.sqrt(np.mean(error**2)))


def of_draws(results: Results, name: str, quantity: str) -> np.ndarray:
    """Numbers measured on the draws of a law, (draws,); NaN where one was refused."""
    measured = (results[f"{name}: {draw}"].measured for draw in range(DRAWS))
    return np.array([each.get(quantity, math.nan) for each in measured])


@cache
def _chosen(draws: int) -> np.ndarray:
    """Draws that each resample has, (resamples, draws)."""
    random = np.random.Generator(np.random.PCG64(SEED))
    return random.integers(draws, size=(RESAMPLES, draws))


def interval(values: np.ndarray) -> tuple[float, float, float]:
    """The median of the draws and the ends of its 95 % interval by a seeded bootstrap."""
    medians = np.median(values[_chosen(len(values))], axis=1)
    low, high = np.percentile(medians, (2.5, 97.5))
    return float(np.median(values)), float(low), float(high)
