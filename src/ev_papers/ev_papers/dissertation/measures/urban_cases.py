"""The five torque control methods of the dissertation in its urban cycle, with three drivers."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError
from ev_papers.dissertation.measures import circuits, traction_windows
from ev_papers.dissertation.measures.circuits import CircuitSums
from ev_stack.measures.metric import NotMeasured
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Run
from ev_study.studies.study import Case

SCENARIO, BENCH = "urban_mixed", "urban_mixed_bench"
Values = tuple[tuple[str, str, Any], ...]
FIVE = ("1", "2", "3", "4", "5")  # as printed
# Without table 2.2: surfaces of table 2.3 alone; f_0 and the driver's k are fitted to table 3.6 by
# eq 2.37 in full, two numbers for five.
WITHOUT_F_SURFACE: Values = (
    ("plant", "road.rolling_resistance_scale", 0.0),
    ("*", "vehicle.rolling_resistance", 0.005),
    ("driver", "level.rolling_resistance", 0.005),
    ("driver", "level.factor", 1.095),
)
DRIVERS = ("tracking", "imposed_speed", "pulse")
SIDES = ("right", "left")
QUANTITIES: dict[str, Callable[[CircuitSums], float]] = {
    "wheel_efficiency": lambda circuit: circuit.efficiency,
    "wheel_speed_efficiency": lambda circuit: circuit.speed_efficiency,
    "wheel_power_efficiency": lambda circuit: circuit.power_efficiency,
    "drive_efficiency": lambda circuit: circuit.drive_efficiency,
    "total_efficiency": lambda circuit: circuit.total_efficiency,
}


@dataclass(frozen=True, slots=True)
class Method:
    """One of the five methods of chapter 3: number, title, and differences from the scenario."""

    number: int
    title: str
    differential: str
    asr: str
    further: Values = ()


METHODS = {
    "1": Method(1, "adaptive", "adaptive", "least_squares"),
    "1b": Method(
        1,
        "adaptive, refused torque offered on",
        "adaptive",
        "least_squares",
        (("electronic_differential", "redistribute", True),),
    ),
    "2": Method(2, "open differential", "open_differential", "off"),
    "3": Method(3, "limited slip", "limited_slip", "off"),
    "4": Method(4, "limited slip, variable", "limited_slip_variable", "off"),
    "5": Method(5, "by adhesion", "adhesion_share", "off"),
}


def case(
    method: str,
    driver: str,
    seed: int,
    name: str = "",
    further: Values = (),
    scenario: str = SCENARIO,
) -> Case:
    """One cycle of a method with a driver on the road of a seed, and further differences."""
    of = METHODS[method]
    # Only with its speed imposed is the car driven through the cycle whatever its torque.
    values: Values = (
        ("electronic_differential", "method", of.differential),
        ("asr", "method", of.asr),
        ("driver", "method", driver),
        ("plant", "speed", "imposed" if driver == "imposed_speed" else "free"),
        ("plant", "road.seed", seed),
        *of.further,
    )
    return Case(name or case_name(method, driver, seed), scenario, (*values, *further))


def roads(given: argparse.Namespace) -> range:
    """The seeds 1 to N of the option --seeds; ParameterError if there is none."""
    if given.seeds < 1:
        raise ParameterError(f"--seeds {given.seeds} is refused, expected 1 or more")
    return range(1, given.seeds + 1)


def case_name(method: str, driver: str, seed: int) -> str:
    """Name of a case without changes."""
    return f"method {method} {driver} seed {seed}"


def measure(recording: Recording, run: Run) -> Mapping[str, Any]:
    """Efficiencies [1] and energies [J] of a cycle, with the pedal pressed and over all windows.

    Right, left and their mean, as tables 3.1 to 3.6 and 5.1 to 5.6 have them; those over all
    windows end with `_windows`. Nothing is measured of a short run without traction.
    """
    vehicle = run.configurations[MASTER].common.vehicle
    driver = run.configurations["driver"].values()
    try:
        shares = circuits.circuit_shares(recording, vehicle)
        pressed = traction_windows.traction(recording, driver)
        windows = traction_windows.in_windows(recording, driver)
        under_traction = {wheel: of.sums(pressed) for wheel, of in shares.items()}
        in_windows = {wheel: of.sums(windows) for wheel, of in shares.items()}
        found = _efficiencies(under_traction, "") | _efficiencies(in_windows, "_windows")
        cycle_time = traction_windows.cycle_time(driver)
        found["energy_as_printed"] = sum(each.energy(cycle_time) for each in in_windows.values())
        found["energy_windows"] = sum(each.electrical_work for each in in_windows.values())
        found["energy"] = sum(each.electrical_work for each in under_traction.values())
        found["slip_energy"] = circuits.slip_energy(recording, vehicle, pressed)
    except NotMeasured:
        return {}
    found["distance"] = float(recording.channels["pose.x"][-1])
    return found


def _efficiencies(of: Mapping[str, CircuitSums], ending: str) -> dict[str, float]:
    """Efficiencies by side and their mean, of the sums of each wheel."""
    found = {}
    for name, quantity in QUANTITIES.items():
        values = []
        for wheel, circuit in of.items():
            _, _, side = wheel.rpartition("_")
            value = quantity(circuit)
            found[f"{name}_{side}{ending}"] = value
            values.append(value)
        found[name + ending] = sum(values) / len(values)
    return found
