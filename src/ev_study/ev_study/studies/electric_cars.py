"""Electric cars of an EPA test car list, the named assumptions about their drives, and their consumption by sums.

The sums over a cycle are quasi-static: speed and acceleration follow the cycle exactly, so the work
at the wheels and the losses are integrals that need no run. They serve to fit the assumptions. The
study `energy` drives the plant.
"""

from __future__ import annotations

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from scipy.optimize import least_squares

from ev_core.parameters.data_file import find_file, read_data
from ev_core.vehicle.car import GRAVITY
from ev_msgs_py.refusal import ParameterError, quoted
from ev_sim.profiles.profile import SpeedProfileParameters, with_profile_from_file

CYCLES = ("udds", "hwfet")
POUND, POUND_FORCE, MILE_PER_HOUR, MILE = 0.45359237, 4.4482216, 0.44704, 1609.344  # kg, N, m/s, m
ENERGY_OF_A_GALLON = 33_705.0  # W h, of gasoline: what the EPA's miles per gallon equivalent count
REFERENCE_MASS = 2000.0  # kg: idle and copper losses are in proportion to the car's mass over this
CLASSES, ASSUMPTIONS = "energy/drive_classes.csv", "energy/assumptions.csv"
# quantity of a row of the assumptions with the code of a fitted vehicle as its class
FITTED = "fitted"
# of cars that no line of the classes names, by their driven axles
_ONE, _TWO = "one machine", "two machines"
_MOST = 1 << 22  # bytes of a file
_LARGEST = 1e4  # of an assumption in its unit: no car has 10 kW of auxiliaries
_INTERVAL = 0.2  # s, of the sums
_DRIVEN_AXLES = {
    "2-Wheel Drive, Front": 1,
    "2-Wheel Drive, Rear": 1,
    "All Wheel Drive": 2,
    "4-Wheel Drive": 2,
    "Part-time 4-Wheel Drive": 2,
}
# Of compact_ev, which the plant drives: wheels, and a rotor with its gear, as mass [kg]; slip
# stiffness over load [1].
WHEELS, ROTOR, SLIP_STIFFNESS = 43.0, 13.8, 20.0
_BOUNDS = {  # lowest, highest, expected before anything is known, and how firmly
    "gear_efficiency": (0.85, 0.99, 0.95, 0.02),
    "copper": (0.0, 1e-2, 2e-4, 1e-3),
    "auxiliary_power": (100.0, 600.0, 300.0, 100.0),
    "charger_efficiency": (0.80, 0.95, 0.88, 0.03),
    "idle": (0.0, 500.0, 0.0, 50.0),
    "recovery": (0.3, 2.5, 1.2, 0.5),
}
_SPREAD = 0.03  # relative deviation of the measured consumption beyond which a row weighs less


@dataclass(frozen=True, slots=True)
class ElectricCar:
    """A row of the list, in SI units.

    `measured` is the consumption from the wall by cycle [W h/km].
    """

    name: str
    vehicle: str
    mass: float
    constant: float
    linear: float
    quadratic: float
    driven_axles: int
    drive: str
    measured: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Assumptions:
    """Assumptions on all cars, and on each class of drives: idle force [N] and recovery [m/s^2].

    `copper` is a loss over the squared force at the wheels [W/N^2], `idle` a force that the
    machines take at any speed, both for a car of REFERENCE_MASS; `recovery` is the deceleration up
    to which the drives brake. `fitted` has the codes of the vehicles that they were fitted to:
    other cars are new to them.
    """

    gear_efficiency: float
    copper: float
    auxiliary_power: float
    charger_efficiency: float
    idle: Mapping[str, float]
    recovery: Mapping[str, float]
    fitted: frozenset[str] = frozenset()


def read_cars(file: Path | str) -> list[ElectricCar]:
    """The cars of a list.

    Raises ParameterError that names line and column of what is missing or no number.

    Columns: model, vehicle, configuration, drive, test_weight_lb, A_lbf, B_lbf_per_mph,
    C_lbf_per_mph2, udds_mpge and hwfet_mpge. Further ones are not read.
    """
    cars = []
    for line, row in _rows(file):
        # Line and row as defaults: a closure would see those of the last turn.
        def number(
            column: str, least: float, line: int = line, row: Mapping[str, str] = row
        ) -> float:
            text = row.get(column) or ""
            try:
                value = float(text)
            except ValueError:
                value = np.nan
            if not least < value < 1e6:
                raise ParameterError(
                    f"{file}, line {line}, column {column}: {quoted(text)} is refused, "
                    f"expected a number above {least:g}"
                )
            return value

        drive, name = row.get("drive") or "", f"{row.get('model')} {row.get('configuration')}"
        if drive not in _DRIVEN_AXLES:
            known = f"one of {', '.join(_DRIVEN_AXLES)}"
            raise ParameterError(
                f"{file}, line {line}, column drive: {quoted(drive)} is refused, expected {known}"
            )
        # From miles per gallon equivalent to W h per mile.
        per_mile = {cycle: ENERGY_OF_A_GALLON / number(f"{cycle}_mpge", 0.0) for cycle in CYCLES}
        axles = _DRIVEN_AXLES[drive]
        cars.append(
            ElectricCar(
                f"{name} ({row.get('vehicle')})",
                row.get("vehicle") or "",
                number("test_weight_lb", 0.0) * POUND,
                number("A_lbf", -1e3) * POUND_FORCE,
                number("B_lbf_per_mph", -1e2) * POUND_FORCE / MILE_PER_HOUR,
                number("C_lbf_per_mph2", -1.0) * POUND_FORCE / MILE_PER_HOUR**2,
                axles,
                _class_of(name, axles),
                {cycle: energy / MILE * 1e3 for cycle, energy in per_mile.items()},
            )
        )
    if not cars:
        raise ParameterError(f"{file}: no car is in it, expected a row for each")
    return cars


def _rows(file: Path | str) -> list[tuple[int, dict[str, str]]]:
    """The rows below the header, with their lines in the file.

    A line that begins with # is a comment.
    """
    text = read_data(file, _MOST).decode("utf-8-sig", "replace")
    lines = [(n, line) for n, line in enumerate(text.splitlines(), 1) if not line.startswith("#")]
    reader = csv.DictReader(line for _, line in lines)
    return [(lines[reader.line_num - 1][0], row) for row in reader]


@cache
def _classes() -> tuple[tuple[str, str], ...]:
    """Part of the name of a model, and its class, in the order of the file: the first that fits counts."""
    return tuple((row["model"], row["class"]) for _, row in _rows(find_file(CLASSES)))


def _class_of(name: str, axles: int) -> str:
    fallback = _ONE if axles == 1 else _TWO
    # By the driven axles where the name tells nothing.
    return next((drive for part, drive in _classes() if part in name), fallback)


def read_assumptions(file: Path | str | None = None) -> Assumptions:
    """Those of a file such as `config/energy/assumptions.csv`, which is the default.

    Raises ParameterError if one lacks, is there twice or beyond what it can be.
    """
    path = find_file(ASSUMPTIONS) if file is None else Path(file)
    values: dict[tuple[str, str], float] = {}
    fitted = set()
    for line, row in _rows(path):
        if row.get("quantity") == FITTED:
            fitted.add(row.get("class") or "")
            continue
        try:
            quantity, drive, value = row["quantity"], row["class"], float(row["value"])
        except (KeyError, TypeError, ValueError):
            raise ParameterError(
                f"{path}, line {line}: {quoted(str(row))} is refused, expected quantity, class and"
                " a number as value"
            ) from None
        most = 1.0 if quantity.endswith("efficiency") else _LARGEST
        if not (0.0 < value <= most or (value == 0.0 and most > 1.0)):
            expected = "above 0 and at most 1" if most == 1.0 else f"0 to {most:g}"
            raise ParameterError(
                f"{path}, line {line}: {quantity} of {drive} is {value:g}, expected {expected}"
            )
        if (quantity, drive) in values:
            raise ParameterError(
                f"{path}, line {line}: {quantity} of {drive} is there twice, expected once"
            )
        values[quantity, drive] = value
    classes = tuple(dict.fromkeys((_ONE, _TWO, *(drive for _, drive in _classes()))))
    try:
        return Assumptions(
            *(
                values[name, "all"]
                for name in ("gear_efficiency", "copper", "auxiliary_power", "charger_efficiency")
            ),
            idle={drive: values["idle", drive] for drive in classes},
            recovery={drive: values["recovery", drive] for drive in classes},
            fitted=frozenset(fitted),
        )
    except KeyError as error:
        quantity, drive = error.args[0]
        raise ParameterError(f"{path} lacks {quantity} of {drive}") from None


@cache
def _cycle(name: str) -> tuple[np.ndarray, np.ndarray, float]:
    """Mean speeds [m/s] and accelerations [m/s^2] of the intervals of a cycle, (n,), and their length [s]."""
    profile = with_profile_from_file(SpeedProfileParameters(file=f"cycles/{name}.csv"), "cycle")
    speeds = np.interp(
        np.arange(0.0, profile.time[-1] + 1e-9, _INTERVAL), profile.time, profile.speed
    )
    return (speeds[1:] + speeds[:-1]) / 2, np.diff(speeds) / _INTERVAL, _INTERVAL


def consumption(car: ElectricCar, cycle: str, a: Assumptions) -> float:
    """Consumption from the wall [W h/km] by sums over the cycle."""
    speed, acceleration, h = _cycle(cycle)
    # Two machines per driven axle, as in the plant; each turns its rotor along.
    inertia = car.mass + WHEELS + ROTOR * 2 * car.driven_axles
    force = (
        # At rest nothing rolls.
        car.constant * (speed > 0.0)
        + car.linear * speed
        + car.quadratic * speed**2
        + inertia * acceleration
    )
    # A heavier car has larger machines: less copper loss at a force, more drag at idle.
    size, efficiency = car.mass / REFERENCE_MASS, a.gear_efficiency
    driving = np.maximum(force, 0.0)
    # Beyond the recovery the friction brakes do the rest.
    braking = np.minimum(np.maximum(-force, 0.0), a.recovery[car.drive] * car.mass)
    # Small slip: force over slip stiffness; each axle is taken to carry half the car.
    slip = driving / (SLIP_STIFFNESS * car.mass * GRAVITY * car.driven_axles / 2)
    # The wheel turns faster than the car by the slip. A gear takes its share either way.
    power = driving * speed * (1.0 + slip) / efficiency - braking * speed * efficiency
    # At the shaft a drive force is divided by the efficiency and a brake force multiplied by it;
    # squared and related to the drive force that is its fourth power.
    power += a.copper / size * (driving**2 + efficiency**4 * braking**2)
    power += a.idle[car.drive] * size * speed + a.auxiliary_power
    # J per m over 3.6 are W h per km.
    return float(power.sum() * h / 3.6 / (speed.sum() * h) / a.charger_efficiency)


def fit(cars: Sequence[ElectricCar]) -> Assumptions:
    """The assumptions that fit the measured consumption of cars best, held to what is expected beforehand.

    A robust loss (soft L1) keeps rows that do not fit from deciding. The same cars give the same
    numbers.
    """
    classes = list(read_assumptions().idle)
    common = [name for name in _BOUNDS if name not in ("idle", "recovery")]
    names = [*common, *("idle" for _ in classes), *("recovery" for _ in classes)]
    # All numbers as deviations from what is expected, in units of how firm that is: the prior is a
    # residual like the others.
    low, high, expected, firm = (np.array([_BOUNDS[name][i] for name in names]) for i in range(4))

    def assumptions(scaled: np.ndarray) -> Assumptions:
        values, n = expected + firm * scaled, len(common)
        of_class = (values[n : n + len(classes)], values[n + len(classes) :])
        idle, recovery = (dict(zip(classes, map(float, each), strict=True)) for each in of_class)
        return Assumptions(*map(float, values[:n]), idle=idle, recovery=recovery)

    def residuals(scaled: np.ndarray) -> np.ndarray:
        a = assumptions(scaled)
        errors = [
            consumption(car, cycle, a) / car.measured[cycle] - 1.0
            for car in cars
            for cycle in CYCLES
        ]
        return np.concatenate((np.array(errors) / _SPREAD, scaled))

    bounds = ((low - expected) / firm, (high - expected) / firm)
    # What is expected beforehand, inside the bounds: that of idle is the lower one itself.
    start = np.clip(np.zeros(len(names)), bounds[0] + 1e-6, bounds[1] - 1e-6)
    found = assumptions(least_squares(residuals, start, bounds=bounds, loss="soft_l1").x)
    return replace(found, fitted=frozenset(car.vehicle for car in cars))


def held_out(cars: Sequence[ElectricCar]) -> set[str]:
    """The vehicles of every third place in the order of their codes, with all configurations: not for `--fit`."""
    return set(sorted({car.vehicle for car in cars})[::3])


def assumption_rows(a: Assumptions) -> list[tuple[str, str, str, str]]:
    """Quantity, class, value and unit, as in the file of the assumptions.

    The fitted vehicles last.
    """
    units = {
        "gear_efficiency": "1",
        "copper": "W/N^2",
        "auxiliary_power": "W",
        "charger_efficiency": "1",
    }
    rows = [(name, "all", f"{getattr(a, name):.4g}", unit) for name, unit in units.items()]
    rows += [("idle", drive, f"{force:.3g}", "N") for drive, force in a.idle.items()]
    rows += [("recovery", drive, f"{limit:.3g}", "m/s^2") for drive, limit in a.recovery.items()]
    return rows + [(FITTED, vehicle, "", "") for vehicle in sorted(a.fitted)]
