"""Energy of electric cars from the wall to the wheels on UDDS and HWFET, compared with an EPA test car list.

The plant is compact_ev with the mass, the road load and the driven axles of each car, and with the
assumptions about its class of drives (`electric_cars`). The tyres, wheels and gear ratio of
compact_ev stand for all cars, and neither motors nor battery have a limit.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError
from ev_sim.profiles.profile import cycle_values
from ev_stack.measures import motion
from ev_stack.measures.metric import Metric, channel
from ev_stack.recording.recording import Recording
from ev_stack.report.tables import Table
from ev_stack.scenarios.files import vehicle_of
from ev_stack.scenarios.records import Run
from ev_study.studies.electric_cars import (
    CYCLES,
    FITTED,
    REFERENCE_MASS,
    Assumptions,
    ElectricCar,
    assumption_rows,
    fit,
    held_out,
    read_assumptions,
    read_cars,
)
from ev_study.studies.study import Case, Results

ABOUT = "Energy of the electric cars of an EPA test car list, wall to wheels, on UDDS and HWFET"
_OF_A_CYCLE = ("W h/km", "measured", "error")
COLUMNS = (
    "car",
    "drive",
    "part",
    *(f"{cycle}: {what}" for cycle in CYCLES for what in _OF_A_CYCLE),
)
LEFT = 3
SUMS = ("median", "ninety")
_SCENARIO, _VEHICLE = "coast_down", "compact_ev"
_NO_LIMIT, _LARGE_TORQUE = 5e6, 2e4  # W, N m
_FIT, _NEW = "fit", "new"


def add_options(parser: argparse.ArgumentParser) -> None:
    """The list of cars, the assumptions, and which cars."""
    parser.add_argument(
        "cars", type=Path, metavar="CARS.csv", help="test car list (docs/energy.md)"
    )
    parser.add_argument(
        "--assumptions", type=Path, metavar="FILE", help="default: config/energy/assumptions.csv"
    )
    parser.add_argument(
        "--fit",
        action="store_true",
        help="fit the assumptions to the cars of this list that are not held out, and print them",
    )
    parser.add_argument(
        "--only",
        nargs="+",
        default=[],
        metavar="TEXT",
        help="cars with one of these texts in their names",
    )


def _cars(given: argparse.Namespace) -> list[ElectricCar]:
    cars = read_cars(given.cars)
    return [car for car in cars if not given.only or any(text in car.name for text in given.only)]


def _assumptions(given: argparse.Namespace) -> Assumptions:
    return _fitted(given.cars) if given.fit else read_assumptions(given.assumptions)


@cache
def _fitted(file: Path) -> Assumptions:
    cars = read_cars(file)
    kept = held_out(cars)
    return fit([car for car in cars if car.vehicle not in kept])


def cases(given: argparse.Namespace) -> Sequence[Case]:
    """Each car on each cycle.

    Raises ParameterError for a duration: what was measured is of whole cycles.
    """
    if given.duration is not None:
        raise ParameterError(
            f"--duration {given.duration:g} is refused: what was measured is of whole cycles"
        )
    assumptions = _assumptions(given)
    found = []
    for car in _cars(given):
        for cycle in CYCLES:
            values = _values(car, cycle, assumptions)
            duration = cycle_values(cycle)[1]
            name = f"{car.name}: {cycle}"
            found.append(Case(name, _SCENARIO, values, duration=duration, vehicle=_VEHICLE))
    return found


def _values(car: ElectricCar, cycle: str, a: Assumptions) -> tuple[tuple[str, str, Any], ...]:
    base = vehicle_of(_VEHICLE)
    # One machine for each wheel of a driven axle.
    machines = 2 * car.driven_axles
    radius = base.wheel_radius
    gear = base.gear_ratio
    size = car.mass / REFERENCE_MASS
    # squared force at the wheel over squared torque at the shaft
    # All machines share the force: a F^2 = n k T^2 with F = n T times this root gives k = n a times
    # this.
    torques = (gear * a.gear_efficiency / radius) ** 2
    vehicle = {
        "mass": car.mass,
        "rolling_resistance": 0.0,
        "drag_coefficient": 0.0,
        "road_load.constant": car.constant,
        "road_load.linear": car.linear,
        "road_load.quadratic": car.quadratic,
        "driven_wheels": list(WHEEL_NAMES[:machines]),
        "motor.gear_efficiency": a.gear_efficiency,
        "motor.copper_loss": a.copper / size * machines * torques,
        "motor.iron_loss": a.idle[car.drive] * size * radius / gear / machines,
        "battery.auxiliary_power": a.auxiliary_power,
        "maximum_brake_torque": _LARGE_TORQUE,
        # So large and without resistance that the battery loses nothing: losses are those of the
        # assumptions.
        "battery.capacity": 1000.0,
        "battery.resistance": 1e-3,
        **dict.fromkeys(
            ("motor.eddy_loss", "motor.inverter_loss", "motor.inverter_torque_loss"), 0.0
        ),
        **dict.fromkeys(
            ("motor.peak_torque", "motor.nominal_torque", "motor.generator_torque"), _LARGE_TORQUE
        ),
        **dict.fromkeys(("motor.peak_power", "motor.generator_power"), _NO_LIMIT),
        **dict.fromkeys(("battery.discharge_power", "battery.charge_power"), _NO_LIMIT),
    }
    control = {
        # In proportion to the mass, so that all cars follow the cycle alike.
        "proportional_gain": 5.0 * car.mass,
        "integral_gain": 5.0 * car.mass,
        "max_drive_torque": _LARGE_TORQUE,
        "max_brake_torque": _LARGE_TORQUE,
        "max_regenerative_torque": a.recovery[car.drive] * car.mass * radius,
    }
    return (
        *(("*", f"vehicle.{name}", value) for name, value in vehicle.items()),
        *(("driver", f"speed_control.{name}", value) for name, value in control.items()),
        ("driver", "pedals.begin", False),
        ("driver", "speed_profile.file", f"cycles/{cycle}.csv"),
        ("plant", "initial_speed", 0.0),
    )


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Consumption from the battery [W h/km] and largest difference from the cycle's speed [m/s]."""
    # The current of the battery is positive when it is charged.
    power = -channel(recording, "battery.voltage") * channel(recording, "battery.current")
    # The power at the end of a step held over it.
    energy = float((power[1:] * np.diff(recording.time)).sum())
    distance = float(motion.distance_on_path(recording)[-1])
    wanted = run.configurations["driver"].parameters.speed_profile
    asked = np.interp(recording.time, wanted.time, wanted.speed)
    return {
        "consumption": energy / 3600.0 / (distance / 1000.0),
        "speed_error": float(np.abs(motion.speed(recording) - asked).max()),
    }


class _Compared(NamedTuple):
    """A car that was driven, and by cycle ours and what was measured [W h/km]."""

    car: ElectricCar
    is_new: bool  # to the assumptions
    pairs: list[tuple[float, float]]


def _compared(given: argparse.Namespace, results: Results) -> list[_Compared]:
    assumed = _assumptions(given)
    found = []
    for car in _cars(given):
        driven = [results[f"{car.name}: {cycle}"].measured for cycle in CYCLES]
        if all(driven):
            ours = [each["consumption"] / assumed.charger_efficiency for each in driven]
            pairs = list(zip(ours, car.measured.values(), strict=True))
            found.append(_Compared(car, car.vehicle not in assumed.fitted, pairs))
    return found


def metrics(given: argparse.Namespace, results: Results) -> dict[str, Metric]:
    """Median and ninetieth percentile of the relative error.

    They are those of all cars and of those new to the assumptions.
    """
    compared = _compared(given, results)
    found = {}
    for part, of in (("", compared), ("_new", [each for each in compared if each.is_new])):
        errors = []
        for each in of:
            errors += [abs(ours / measured - 1.0) for ours, measured in each.pairs]
        if errors:
            found[f"median_error{part}"] = Metric(float(np.median(errors)), "1")
            found[f"ninety_percent_within{part}"] = Metric(float(np.quantile(errors, 0.9)), "1")
    return found


def rows(given: argparse.Namespace, results: Results) -> list[tuple[str, ...]]:
    """Car, class of its drive, whether it was fitted or is new; by cycle numbers and the error."""
    found = []
    for car, is_new, pairs in _compared(given, results):
        row = [car.name, car.drive, _NEW if is_new else _FIT]
        for ours, measured in pairs:
            error = 100 * (ours / measured - 1)
            row += [f"{ours:.0f}", f"{measured:.0f}", f"{error:+.1f} %"]
        found.append(tuple(row))
    return found


def tables(given: argparse.Namespace, results: Results) -> str:
    """The assumptions, the rows, and the errors in sum."""
    # The codes of the fitted cars only for a fit of this list: a user may want its assumptions
    # to keep.
    shown = [row for row in assumption_rows(_assumptions(given)) if given.fit or row[0] != FITTED]
    assumed = Table(("quantity", "class", "value", "unit"), shown, left=2)
    lines = [assumed.text(), "", Table(COLUMNS, rows(given, results), LEFT).text()]
    found = metrics(given, results)
    parts = {"": "all cars", "_new": "cars that the assumptions were not fitted to"}
    for part, which in parts.items():
        if f"median_error{part}" in found:
            median = 100.0 * float(found[f"median_error{part}"].value or 0.0)
            ninety = 100.0 * float(found[f"ninety_percent_within{part}"].value or 0.0)
            errors = f"median error {median:.1f} %, 90 % of the rows within {ninety:.1f} %"
            lines.append(f"{which}: {errors}")
    return "\n".join(lines)
