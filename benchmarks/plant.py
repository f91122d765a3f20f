"""Time of one 1 ms step of the planar plant, beside other models of cars, measured in one run.

    python benchmarks/plant.py [--json FILE]

Peers: pip install commonroad-vehicle-models. Rows that need a package which is not installed say
so.
"""

from __future__ import annotations

import argparse
import importlib
import json
import math
import platform
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

from ev_core.compiled.part import CompiledPart
from ev_core.lockstep.finding import find_method
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.frame import PLACES, Frame, numbers_of
from ev_msgs_py.contract.signals import SteeringColumnState, WheelTorqueCommand
from ev_msgs_py.contract.wheels import Wheels
from ev_sim.plant.planar.body import Equations
from ev_sim.plant.planar.planar import PlanarPlantParameters
from ev_sim.plant.planar.planar_state import INTEGRATED_SIZE
from ev_stack.scenarios.files import vehicle_of

STEP = 1e-3  # [s]
SPEED = 15.0  # [m/s]
COMMAND = WheelTorqueCommand(Wheels.front(120.0, 120.0))
COLUMN = SteeringColumnState(0.0, 0.0, 0.0, 0.02, 0.0)
PARAMETERS = PlanarPlantParameters(initial_speed=SPEED)
AUDI = Vehicle()
REFERENCE = "planar plant, one compiled loop"
MAIN_PEER = "commonroad single-track drift, RK4"


@dataclass(frozen=True)
class Row:
    """One line of the table: time per step [s], or why there is none."""

    name: str
    seconds: float | None
    note: str = ""


def best_time(make: Callable[[], Callable[[], Any]], repeats: int) -> float:
    """Shortest time [s] of a prepared call: the other processes of the machine only ever add time."""
    best = math.inf
    for _ in range(repeats):
        call = make()
        start = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - start)
    return best


class PlanarPlant:
    """A car at 15 m/s on dry asphalt, with drives, losses and battery, between two frames."""

    def __init__(self, period: float, electrical: bool = False, vehicle: Vehicle = AUDI) -> None:
        parameters = PlanarPlantParameters(initial_speed=SPEED, electrical=electrical)
        self._method = find_method("plant", "planar").with_options(parameters, vehicle)
        self.part = CompiledPart(self._method, parameters, vehicle, period)
        self._here, self._there = Frame(), Frame()
        for signal in (COMMAND, COLUMN):
            self._here.numbers[PLACES[type(signal)]] = numbers_of(
                shape_of(type(signal)).flat(signal)
            )

    def advance(self) -> None:
        """One step."""
        self.part.step(self._here, self._there)

    def outputs(self) -> list[Any]:
        """All signals behind it."""
        numbers = self._there.numbers
        return [
            shape_of(kind).signal_of(numbers[PLACES[kind]].tolist()) for kind in self._method.writes
        ]


@njit
def bare_loop(steps: int) -> float:
    """About the arithmetic of one step, nothing else: per wheel and stage 1 exp, 2 roots, 5 divisions, 70 others."""
    total = 0.0
    for n in range(steps):
        for stage in range(4):
            for wheel in range(4):
                a = 1.0 + 1e-3 * wheel + 1e-6 * n
                b = 0.5 + 1e-3 * stage
                for _ in range(6):
                    a = a * 0.99 + b * 0.01 + a * b * 1e-3
                    b = b * 0.98 + a * 0.02 - a * b * 1e-3
                root = math.sqrt(a * a + b * b)
                other = math.sqrt(a + b)
                total += (
                    math.exp(-root) / a
                    + other / root
                    + b / (a + 1.0)
                    + a / (b + 1.0)
                    + root / (other + 1.0)
                )
    return total


def own_rows(repeats: int) -> Iterator[Row]:
    """The planar plant in its ways of use."""
    steps = 3000
    PlanarPlant(STEP).advance()  # compiles

    def fused(electrical: bool = False, vehicle: Vehicle = AUDI) -> Callable[[], Any]:
        car = PlanarPlant(steps * STEP, electrical, vehicle)
        return lambda: car.advance()

    def one_call_per_step() -> Callable[[], Any]:
        car = PlanarPlant(STEP)
        return lambda: [car.advance() for _ in range(steps)]

    def control_period() -> Callable[[], Any]:
        car = PlanarPlant(10 * STEP)
        return lambda: [(car.advance(), car.outputs()) for _ in range(steps // 10)]

    yield Row(REFERENCE, best_time(fused, repeats) / steps)
    fused(electrical=True)()  # compiles
    yield Row(
        "the same with its electrical side",
        best_time(lambda: fused(electrical=True), repeats) / steps,
    )
    believable = vehicle_of("compact_ev")
    yield Row(
        "the same with real tyres (compact_ev)",
        best_time(lambda: fused(vehicle=believable), repeats) / steps,
    )
    yield Row(
        "planar plant, 10 ms period with all signals", best_time(control_period, repeats) / steps
    )
    yield Row("planar plant, one call per step", best_time(one_call_per_step, repeats) / steps)
    bare_loop(10)
    bare = best_time(lambda: lambda: bare_loop(steps), repeats) / steps
    yield Row("bare numba loop of about the same arithmetic", bare)


def scipy_row(repeats: int) -> Row:
    """The body and the wheels of the planar plant (no drives) by solve_ivp, as most scripts would call it."""
    car = PlanarPlant(STEP)
    car.advance()
    start = car.part.state[:INTEGRATED_SIZE].copy()
    equations = Equations(PARAMETERS, Vehicle())
    equations.look(start)
    equations.hold(COLUMN.road_wheel_angle, COMMAND.drive)
    equations.rates(start, starts=True)

    def right_hand_side(_time: float, y: np.ndarray) -> np.ndarray:
        return equations.rates(y)

    def call() -> Any:
        return solve_ivp(right_hand_side, (0.0, 1.0), start, rtol=1e-6, atol=1e-9)

    call()
    return Row(
        "the same wheels and body, scipy solve_ivp RK45",
        best_time(lambda: call, repeats) / 1000,
        "rtol 1e-6",
    )


def commonroad_rows(repeats: int) -> Iterator[Row]:
    """CommonRoad's models by the same Runge-Kutta method and step, as installed, parameters as plain attributes."""
    models = (
        ("commonroad single-track, RK4", "vehicle_dynamics_st", None),
        (MAIN_PEER, "vehicle_dynamics_std", "init_std"),
        ("commonroad multi-body, RK4", "vehicle_dynamics_mb", "init_mb"),
    )
    try:
        parameters = importlib.import_module(
            "vehiclemodels.parameters_vehicle2"
        ).parameters_vehicle2()
    except ImportError:
        for name, _, _ in models:
            yield Row(name, None, "pip install commonroad-vehicle-models")
        return
    plain = plain_attributes(parameters)
    steps = 200
    for name, dynamics, initial in models:
        function = getattr(importlib.import_module(f"vehiclemodels.{dynamics}"), dynamics)
        core = [0.0, 0.0, 0.02, SPEED, 0.0, 0.0, 0.0]
        state = (
            getattr(importlib.import_module(f"vehiclemodels.{initial}"), initial)(core, plain)
            if initial
            else core
        )

        def runge_kutta(function=function, state=state) -> None:
            x = np.array(state, dtype=float)
            for _ in range(steps):
                k1 = np.array(function(x, [0.0, 0.5], plain))
                k2 = np.array(function(x + 0.5 * STEP * k1, [0.0, 0.5], plain))
                k3 = np.array(function(x + 0.5 * STEP * k2, [0.0, 0.5], plain))
                k4 = np.array(function(x + STEP * k3, [0.0, 0.5], plain))
                x += STEP / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)

        yield Row(name, best_time(lambda run=runge_kutta: run, repeats) / steps)


def plain_attributes(tree: Any) -> Any:
    """Nested mappings as plain objects, because the attributes of OmegaConf are slow to read."""
    if hasattr(tree, "items"):
        return SimpleNamespace(**{name: plain_attributes(value) for name, value in tree.items()})
    return tree


def main() -> None:
    """Print the table and, if asked for, write it as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", type=Path, help="write the table to this file")
    parser.add_argument("--repeats", type=int, default=15, help="the best of so many counts")
    arguments = parser.parse_args()
    rows = [
        *own_rows(arguments.repeats),
        scipy_row(arguments.repeats),
        *commonroad_rows(arguments.repeats),
    ]
    reference = next(row.seconds for row in rows if row.name == REFERENCE)
    print(f"{'per 1 ms step':<48}{'us':>10}{'ratio':>10}")
    for row in rows:
        if row.seconds is None:
            print(f"{row.name:<48}{'-':>10}{'-':>10}  {row.note}")
        else:
            print(
                f"{row.name:<48}{row.seconds * 1e6:>10.2f}{row.seconds / reference:>10.1f} "
                f" {row.note}"
            )
    if arguments.json:
        table = [{**asdict(row), "ratio": row.seconds and row.seconds / reference} for row in rows]
        machine = platform.processor() or platform.machine()
        document = {
            "machine": machine,
            "python": platform.python_version(),
            "seconds per": "1 ms step",
            "rows": table,
        }
        arguments.json.write_text(json.dumps(document, indent=2) + "\n")


if __name__ == "__main__":
    main()
