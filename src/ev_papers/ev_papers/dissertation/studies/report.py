"""Report on the urban cycle on mixed surfaces: efficiencies and energies in the traction windows.

Dissertation, eqs 2.37 to 2.40. Its tables compare methods over many roads; the study `five_methods` does that.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.dissertation.figures.urban_mixed import (
    detail,
    electrical,
    panels,
    slip_curve_figure,
    wheel_efficiency,
)
from ev_papers.dissertation.figures.urban_sheets import (
    cycle_figure,
    left_and_right,
    motors_and_cells,
)
from ev_papers.dissertation.measures import circuits
from ev_papers.dissertation.measures import traction_windows as cycle
from ev_papers.dissertation.measures.circuits import CircuitSums
from ev_papers.dissertation.measures.motors_and_cells import electrical_metrics, is_modelled
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.handling import share_of
from ev_stack.measures.metric import (
    HIGHER,
    LOWER,
    Metric,
    NotMeasured,
    Parameters,
    Runs,
    channel,
    metric,
)
from ev_stack.measures.named import DrivenRun
from ev_stack.measures.registry import METRICS
from ev_stack.recording.recording import Recording

ROLLING = 1.0  # [m/s], above it slip is more than the first turn of a wheel
SNOW = "packed_snow"  # begins the names of the surfaces that count as snow
_SIDES = ("right", "left")
_KILOWATT_HOUR = 3.6e6  # [J]


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Efficiencies, energies, slip and how the cycle was followed, for each run."""
    driver = parameters.get("driver", {})
    return motion.of_each_run(runs, lambda run: _metrics(run, vehicle, driver))


def figures(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Sheet]:
    """Counterparts of figures 2.8, 2.13, 3.1 to 3.10 and 5.1 to 5.25, of the first run."""
    run = next(iter(runs.values()))
    driver = parameters.get("driver", {})
    figures = {
        "figure_2_8": slip_curve_figure(run, vehicle),
        "figure_2_13": cycle_figure(run, vehicle, driver),
        "figure_3_torques_and_speeds": electrical(run, vehicle, driver, ("torque", "speed")),
        "figure_3_wheel_efficiency": wheel_efficiency(
            run, vehicle, driver, left_and_right(vehicle), panels(run, vehicle, driver)["torque"]
        ),
        "figure_3_detail": detail(run, vehicle, driver),
        "figure_5_electrical": electrical(run, vehicle, driver, columns=2),
    }
    if is_modelled(run):
        figures["motors_and_cells"] = motors_and_cells(run, vehicle, driver)
    return figures


_WHEN = {False: "under traction", True: "in the windows of the cycle"}


def _metrics(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> dict[str, Metric]:
    # Several metrics share them, and a cycle has a hundred thousand samples.
    shares = cache(lambda: circuits.circuit_shares(run, vehicle))
    pressed = cache(lambda: cycle.traction(run, driver))
    windows = cache(lambda: cycle.in_windows(run, driver))

    @cache
    def sums(whole: bool) -> dict[str, CircuitSums]:
        counted = windows() if whole else pressed()
        return {wheel: of.sums(counted) for wheel, of in shares().items()}

    def of_circuits(
        quantity: Callable[[CircuitSums], float], side: str = "", whole: bool = False
    ) -> list[float]:
        values = [quantity(circuit) for name, circuit in sums(whole).items() if name.endswith(side)]
        if not values:
            raise NotMeasured(f"no wheel is driven on the {side}" if side else "no wheel is driven")
        return values

    def rows(
        name: str, quantity: Callable[[CircuitSums], float], whole: bool = False
    ) -> dict[str, Metric]:
        """Right, left and mean, as the tables of the source have them."""

        def mean(side: str) -> float:
            values = of_circuits(quantity, side, whole)
            return sum(values) / len(values)

        ending = {side: f"_{side}" for side in _SIDES} | {"": ""}
        formula = (
            f"{name.removesuffix('_windows').replace('_', ' ')} of its circuits {_WHEN[whole]}"
        )
        return {
            name + end: metric(lambda side=side: mean(side), "1", formula, HIGHER)
            for side, end in ending.items()
        }

    def energy(whole: bool = False) -> float:
        return sum(of_circuits(lambda circuit: circuit.electrical_work, whole=whole))

    def energy_as_printed() -> float:
        time = cycle.cycle_time(driver)
        return sum(of_circuits(lambda circuit: circuit.energy(time), whole=True))

    return {
        **rows("wheel_efficiency", lambda circuit: circuit.efficiency),
        **rows("wheel_speed_efficiency", lambda circuit: circuit.speed_efficiency),
        **rows("wheel_power_efficiency", lambda circuit: circuit.power_efficiency),
        **rows("drive_efficiency", lambda circuit: circuit.drive_efficiency),
        **rows("total_efficiency", lambda circuit: circuit.total_efficiency),
        **rows("wheel_efficiency_windows", lambda circuit: circuit.efficiency, whole=True),
        **rows("drive_efficiency_windows", lambda circuit: circuit.drive_efficiency, whole=True),
        "energy": metric(energy, "J", f"electrical work of the circuits {_WHEN[False]}", LOWER),
        "energy_windows": metric(lambda: energy(whole=True), "J", f"the same {_WHEN[True]}"),
        "energy_as_printed": metric(
            energy_as_printed, "J", "the same by the equation as it is printed"
        ),
        "energy_as_printed_in_kwh": metric(
            lambda: energy_as_printed() / _KILOWATT_HOUR, "kW h", "the same in another unit"
        ),
        "traction_slip_energy": metric(
            lambda: circuits.slip_energy(run, vehicle, pressed()),
            "J",
            "sum of F_x r (w - w_free) of the driven wheels under traction",
            LOWER,
        ),
        "distance": METRICS["distance"].measured(DrivenRun(run, vehicle)),
        "traction_time": metric(lambda: _time_in(run, pressed()), "s", "time under traction"),
        "window_time": metric(lambda: _time_in(run, windows()), "s", "time in the windows"),
        "traction_peak_slip": metric(
            lambda: _peak_slip(run, vehicle, driver),
            "1",
            "max slip of a driven wheel under traction",
            LOWER,
        ),
        "mean_speed_error": metric(
            lambda: np.abs(_speed_error(run, driver)).mean(),
            "m/s",
            "mean |V - speed of the cycle|",
            LOWER,
        ),
        **{
            f"share_of_snow_{side}": metric(
                lambda side=side: _snow(run, vehicle, side), "1", "share of the way on snow"
            )
            for side in _SIDES
        },
        **electrical_metrics(run, vehicle),
    }


def _time_in(run: Recording, counted: np.ndarray) -> float:
    return (counted * np.diff(run.time, prepend=run.time[:1])).sum()


def _peak_slip(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> float:
    """Largest slip of a driven wheel in the traction windows of the rolling car [1]."""
    counts = cycle.traction(run, driver) & (motion.path_speed(run) > ROLLING)
    if not counts.any():
        raise NotMeasured("the car is not driven while it rolls")
    return max(
        channel(run, f"tire_forces.slip_ratio.{wheel}")[counts].max()
        for wheel in vehicle.driven_wheels
    )


def _speed_error(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    return motion.path_speed(run) - cycle.wanted_speed(run, driver)


def _snow(run: Recording, vehicle: Vehicle, side: str) -> float:
    """Share under the driven wheel of a side, the front one where both are driven."""
    driven = [wheel for wheel in vehicle.driven_wheels if wheel.endswith(side)]
    if not driven:
        raise NotMeasured(f"no wheel is driven on the {side}")
    return share_of(run, vehicle, driven[0], SNOW)
