"""Time of one 1 ms step of the planar plant, beside other models of cars, measured in one run.

    python benchmarks/plant.py [--json FILE] [--peer PROGRAM]

All rows are measured in alternating rounds, by processor time (`rounds`).
Peers: pip install commonroad-vehicle-models. Rows that need a package which is not installed say
so. A compiled peer is a program of one's own around its step: called with a number of steps of
1 ms it prints the processor time that they took [s].
"""

from __future__ import annotations

import argparse
import importlib
import json
import math
import statistics
import subprocess
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from numba import njit
from rounds import alternating, as_json, machine, processor_time, ratio_of
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
COMPILED_PEER = "compiled peer"
CARS = {"audi_a2": AUDI} | {name: vehicle_of(name) for name in ("compact_ev", "sedan")}
PEER_STEPS = 30000
OF_REFERENCE, OF_PEER = 0.5, 1.0  # goals of the semi-implicit integrator


class Row(NamedTuple):
    """One line of the table: what makes a call, and how many steps the call takes; or why there is none."""

    name: str
    make: Callable[[], Callable[[], Any]] | None
    steps: int = 1
    note: str = ""

    def measure(self) -> float:
        """Processor time of a step [s]; what comes before the call does not count."""
        return processor_time(self.make()) / self.steps


class Program(NamedTuple):
    """One line of the table, of a compiled peer."""

    name: str
    path: Path
    note: str

    def measure(self) -> float:
        """Processor time of a step [s], as the program prints it."""
        words = [str(self.path), str(PEER_STEPS)]
        return float(subprocess.run(words, check=True, stdout=subprocess.PIPE).stdout) / PEER_STEPS


class PlanarPlant:
    """A car at 15 m/s on dry asphalt, with drives, losses and battery, between two frames."""

    def __init__(self, period: float, vehicle: Vehicle = AUDI, **chosen: Any) -> None:
        parameters = PlanarPlantParameters(initial_speed=SPEED, **chosen)
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


def own_rows() -> Iterator[Row]:
    """The planar plant in its ways of use."""
    steps = 3000

    def fused(vehicle: Vehicle = AUDI, **chosen: Any) -> Callable[[], Any]:
        car = PlanarPlant(steps * STEP, vehicle, **chosen)
        return car.advance

    def one_call_per_step() -> Callable[[], Any]:
        car = PlanarPlant(STEP)
        return lambda: [car.advance() for _ in range(steps)]

    def control_period() -> Callable[[], Any]:
        car = PlanarPlant(10 * STEP)
        return lambda: [(car.advance(), car.outputs()) for _ in range(steps // 10)]

    yield Row(REFERENCE, fused, steps)
    yield Row("the same with its electrical side", partial(fused, electrical=True), steps)
    for name, vehicle in CARS.items():
        if vehicle is not AUDI:
            yield Row(integrated(name, "runge_kutta"), partial(fused, vehicle), steps)
        once = partial(fused, vehicle, integrator="semi_implicit")
        yield Row(integrated(name, "semi_implicit"), once, steps)
    yield Row("planar plant, 10 ms period with all signals", control_period, steps)
    yield Row("planar plant, one call per step", one_call_per_step, steps)
    yield Row(
        "bare numba loop of about the same arithmetic", lambda: partial(bare_loop, steps), steps
    )


def integrated(car: str, integrator: str) -> str:
    """Name of the row of a car by an integrator."""
    if (car, integrator) == ("audi_a2", "runge_kutta"):
        return REFERENCE
    return f"{car}, {integrator}"


def pairs(has_peer: bool) -> Iterator[tuple[str, str, float]]:
    """Rows whose ratio has a goal: of the one, to the other, at most."""
    for car in CARS:
        once = integrated(car, "semi_implicit")
        yield once, integrated(car, "runge_kutta"), OF_REFERENCE
        if has_peer:
            yield once, COMPILED_PEER, OF_PEER


def scipy_row() -> Row:
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

    note = "rtol 1e-6"
    return Row("the same wheels and body, scipy solve_ivp RK45", lambda: call, 1000, note)


def commonroad_rows() -> Iterator[Row]:
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
            yield Row(name, None, note="pip install commonroad-vehicle-models")
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

        yield Row(name, lambda run=runge_kutta: run, steps)


def plain_attributes(tree: Any) -> Any:
    """Nested mappings as plain objects, because the attributes of OmegaConf are slow to read."""
    if hasattr(tree, "items"):
        return SimpleNamespace(**{name: plain_attributes(value) for name, value in tree.items()})
    return tree


def main() -> None:
    """Print the table and, if asked for, write it as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", type=Path, help="write the table to this file")
    parser.add_argument("--repeats", type=int, default=15, help="rounds")
    parser.add_argument("--peer", type=Path, metavar="PROGRAM", help="a compiled peer, see above")
    arguments = parser.parse_args()
    rows: dict[str, Row | Program] = {
        row.name: row for row in (*own_rows(), scipy_row(), *commonroad_rows())
    }
    if arguments.peer:
        rows[COMPILED_PEER] = Program(COMPILED_PEER, arguments.peer, arguments.peer.name)
    missing = {row.name for row in rows.values() if isinstance(row, Row) and row.make is None}
    measures = {name: row.measure for name, row in rows.items() if name not in missing}
    seconds = alternating(measures, arguments.repeats)
    print(f"{'per 1 ms step':<48}{'us':>10}  ratio")
    table = []
    for name, row in rows.items():
        if name in missing:
            print(f"{name:<48}{'-':>10}  {row.note}")
            table.append({"name": name, "seconds": None, "ratio": None, "note": row.note})
            continue
        took = statistics.median(seconds[name])
        ratio = ratio_of(seconds[name], seconds[REFERENCE])
        print(f"{name:<48}{took * 1e6:>10.2f}  {ratio}  {row.note}")
        table.append({"name": name, "seconds": took, **as_json(ratio), "note": row.note})
    goals = []
    for of, to, goal in pairs(COMPILED_PEER in rows):
        ratio = ratio_of(seconds[of], seconds[to], goal)
        print(f"{of} over {to}: {ratio}")
        goals.append({"name": f"{of} over {to}", **as_json(ratio)})
    if arguments.json:
        document = {**machine(), "seconds per": "1 ms step", "rows": table, "goals": goals}
        arguments.json.write_text(json.dumps(document, indent=2) + "\n")


if __name__ == "__main__":
    main()
