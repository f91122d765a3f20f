"""Report on the urban cycle on mixed surfaces: efficiencies and energies in the traction windows.

Dissertation, eqs 2.37 to 2.40. Its tables compare methods over many roads, as the study
`five_methods` does.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.dissertation.figures.slip_curve import slip_curve_figure
from ev_papers.dissertation.figures.urban_mixed import (
    detail,
    electrical,
    panels,
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
_UNDER_TRACTION = "under traction"
_IN_WINDOWS = "in the windows of the cycle"

Quantity = Callable[[CircuitSums], float]


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Efficiencies, energies, slip and distance from the cycle, for each run."""
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


class _Circuits:
    """Sums of the circuits of a run, under traction or in whole windows of the cycle.

    Several metrics share them, and a cycle has a hundred thousand samples: each is computed once,
    and not before a metric asks for it, as it may be that nothing can be measured.
    """

    def __init__(self, run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> None:
        self._shares = cache(lambda: circuits.circuit_shares(run, vehicle))
        self.pressed = cache(lambda: cycle.traction(run, driver))
        self.windows = cache(lambda: cycle.in_windows(run, driver))
        self._sums = cache(self._summed)

    def _summed(self, whole: bool) -> dict[str, CircuitSums]:
        counted = self.windows() if whole else self.pressed()
        return {wheel: of.sums(counted) for wheel, of in self._shares().items()}

    def each(self, quantity: Quantity, side: str = "", whole: bool = False) -> list[float]:
        """A quantity of each circuit, or of those of a side."""
        sums = self._sums(whole)
        values = [quantity(circuit) for wheel, circuit in sums.items() if wheel.endswith(side)]
        if not values:
            raise NotMeasured(f"no wheel is driven on the {side}" if side else "no wheel is driven")
        return values

    def rows(self, name: str, quantity: Quantity, whole: bool = False) -> dict[str, Metric]:
        """Right, left and mean of an efficiency, as the tables of the source have them."""

        def mean(side: str) -> float:
            values = self.each(quantity, side, whole)
            return sum(values) / len(values)

        words = name.removesuffix("_windows").replace("_", " ")
        formula = f"{words} of its circuits {_IN_WINDOWS if whole else _UNDER_TRACTION}"
        found = {}
        for side in (*_SIDES, ""):
            key = f"{name}_{side}" if side else name
            found[key] = metric(lambda side=side: mean(side), "1", formula, HIGHER)
        return found


def _metrics(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> dict[str, Metric]:
    return {
        **_efficiencies_and_energies(run, vehicle, driver),
        **_of_the_motion(run, vehicle, driver),
        **electrical_metrics(run, vehicle),
    }


def _efficiencies_and_energies(
    run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]
) -> dict[str, Metric]:
    of = _Circuits(run, vehicle, driver)

    def energy(whole: bool = False) -> float:
        return sum(of.each(lambda circuit: circuit.electrical_work, whole=whole))

    def energy_as_printed() -> float:
        time = cycle.cycle_time(driver)
        return sum(of.each(lambda circuit: circuit.energy(time), whole=True))

    return {
        **of.rows("wheel_efficiency", lambda circuit: circuit.efficiency),
        **of.rows("wheel_speed_efficiency", lambda circuit: circuit.speed_efficiency),
        **of.rows("wheel_power_efficiency", lambda circuit: circuit.power_efficiency),
        **of.rows("drive_efficiency", lambda circuit: circuit.drive_efficiency),
        **of.rows("total_efficiency", lambda circuit: circuit.total_efficiency),
        **of.rows("wheel_efficiency_windows", lambda circuit: circuit.efficiency, whole=True),
        **of.rows("drive_efficiency_windows", lambda circuit: circuit.drive_efficiency, whole=True),
        "energy": metric(energy, "J", f"electrical work of the circuits {_UNDER_TRACTION}", LOWER),
        "energy_windows": metric(lambda: energy(whole=True), "J", f"the same {_IN_WINDOWS}"),
        "energy_as_printed": metric(
            energy_as_printed, "J", "the same by the equation as it is printed"
        ),
        "energy_as_printed_in_kwh": metric(
            lambda: energy_as_printed() / _KILOWATT_HOUR, "kW h", "the same in another unit"
        ),
        "traction_slip_energy": metric(
            lambda: circuits.slip_energy(run, vehicle, of.pressed()),
            "J",
            "sum of F_x r (w - w_free) of the driven wheels under traction",
            LOWER,
        ),
        "distance": METRICS["distance"].measured(DrivenRun(run, vehicle)),
        "traction_time": metric(lambda: _time_in(run, of.pressed()), "s", "time under traction"),
        "window_time": metric(lambda: _time_in(run, of.windows()), "s", "time in the windows"),
    }


def _of_the_motion(
    run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]
) -> dict[str, Metric]:
    found = {
        "traction_peak_slip": metric(
            lambda: _peak_slip(run, vehicle, driver),
            "1",
            "max slip of a driven wheel under traction",
            LOWER,
        ),
        "mean_speed_error": metric(
            lambda: np.abs(motion.path_speed(run) - cycle.wanted_speed(run, driver)).mean(),
            "m/s",
            "mean |V - speed of the cycle|",
            LOWER,
        ),
    }
    for side in _SIDES:
        found[f"share_of_snow_{side}"] = metric(
            lambda side=side: _snow(run, vehicle, side), "1", "share of the way on snow"
        )
    return found


def _time_in(run: Recording, counted: np.ndarray) -> float:
    return (counted * np.diff(run.time, prepend=run.time[:1])).sum()


def _peak_slip(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> float:
    """Largest slip of a driven wheel in the traction windows of the rolling car [1]."""
    counts = cycle.traction(run, driver) & (motion.path_speed(run) > ROLLING)
    if not counts.any():
        raise NotMeasured("the car is not driven while it rolls")
    slips = (channel(run, f"tire_forces.slip_ratio.{wheel}") for wheel in vehicle.driven_wheels)
    return max(slip[counts].max() for slip in slips)


def _snow(run: Recording, vehicle: Vehicle, side: str) -> float:
    """Share of snow under the driven wheel of a side, the front one where both are driven [1]."""
    driven = [wheel for wheel in vehicle.driven_wheels if wheel.endswith(side)]
    if not driven:
        raise NotMeasured(f"no wheel is driven on the {side}")
    return share_of(run, vehicle, driven[0], SNOW)
