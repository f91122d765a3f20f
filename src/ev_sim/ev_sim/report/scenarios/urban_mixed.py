"""Report on the urban cycle on mixed surfaces: efficiencies and energies in the traction windows.

Dissertation, eqs 2.37 to 2.40. Its tables compare methods over many roads; the study `five_methods` does that.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.metric import Metric, NotMeasured, metric
from ev_sim.report.quantities import cycle_efficiency as cycle
from ev_sim.report.quantities import derived, motion
from ev_sim.report.quantities.surfaces_under import share_of
from ev_sim.report.samples import Parameters, Runs, channel
from ev_sim.run.recording.recording import Recording

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROLLING = 1.0  # [m/s], above it slip is more than the first turn of a wheel
SNOW = "packed_snow"  # begins the names of the surfaces that count as snow
_SIDES = ("left", "right")
_KILOWATT_HOUR = 3.6e6  # [J]


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Efficiencies, energies, slip and how the cycle was followed, for each run."""
    driver = parameters.get("driver", {})
    return motion.of_each_run(runs, lambda run: _metrics(run, vehicle, driver))


def figures(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Figure]:
    """Counterparts of figures 2.8, 2.13, 3.1 to 3.10 and 5.1 to 5.25, of the first run."""
    from ev_sim.report.figures.slip_curve import slip_curve_figure
    from ev_sim.report.figures.urban_cycle import cycle_figure
    from ev_sim.report.figures.urban_mixed import detail, electrical, torques_and_speeds, wheel_efficiency

    run = next(iter(runs.values()))
    driver = parameters.get("driver", {})
    return {
        "figure_2_8": slip_curve_figure(run, vehicle),
        "figure_2_13": cycle_figure(run, vehicle, driver),
        "figure_3_torques_and_speeds": torques_and_speeds(run, vehicle, driver),
        "figure_3_wheel_efficiency": wheel_efficiency(run, vehicle, driver),
        "figure_3_detail": detail(run, vehicle, driver),
        "figure_5_electrical": electrical(run, vehicle, driver),
    }


def _metrics(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> dict[str, Metric]:
    # Several metrics share them, and a cycle has a hundred thousand samples.
    sums = cache(lambda: cycle.wheel_sums(run, vehicle, driver))
    energies = cache(lambda: cycle.energies(run, driver))

    def of_wheels(quantity: Callable[[cycle.WheelSums], float], side: str = "") -> float:
        values = [quantity(wheel) for name, wheel in sums().items() if name.endswith(side)]
        if not values:
            raise NotMeasured(f"no wheel is driven on the {side}" if side else "no wheel is driven")
        return sum(values) / len(values)

    def wheels(side: str = "") -> float:
        return of_wheels(lambda wheel: wheel.efficiency, side)

    def drives() -> float:
        shaft, battery = energies()
        if battery <= 0.0:
            raise NotMeasured("the battery gave nothing in the traction windows")
        return shaft / battery

    def energy() -> float:
        return energies()[1]

    return {
        **{f"wheel_efficiency_{side}": metric(lambda side=side: wheels(side), "1") for side in _SIDES},
        "wheel_efficiency": metric(wheels, "1"),
        "wheel_speed_efficiency": metric(lambda: of_wheels(lambda wheel: wheel.speed_efficiency), "1"),
        "drive_efficiency": metric(drives, "1"),
        "total_efficiency": metric(lambda: wheels() * drives(), "1"),
        "energy": metric(energy, "J"),
        "energy_in_kwh": metric(lambda: energy() / _KILOWATT_HOUR, "kW h"),
        "slip_energy": metric(lambda: cycle.slip_energy(run, vehicle, driver), "J"),
        "distance": metric(lambda: motion.distance_on_path(run)[-1], "m"),
        "traction_time": metric(lambda: _traction_time(run, driver), "s"),
        "peak_slip": metric(lambda: _peak_slip(run, vehicle, driver), "1"),
        "mean_speed_error": metric(lambda: np.abs(_speed_error(run, driver)).mean(), "m/s"),
        **{f"share_of_snow_{side}": metric(lambda side=side: _snow(run, vehicle, side), "1") for side in _SIDES},
    }


def _traction_time(run: Recording, driver: Mapping[str, Any]) -> float:
    return (cycle.traction(run, driver) * np.diff(run.time, prepend=run.time[0])).sum()


def _peak_slip(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> float:
    """Largest slip of a driven wheel in the traction windows of the rolling car [1]."""
    counts = cycle.traction(run, driver) & (derived.speed(run) > ROLLING)
    if not counts.any():
        raise NotMeasured("the car is not driven while it rolls")
    return max(channel(run, f"tire_forces.slip_ratio.{wheel}")[counts].max() for wheel in vehicle.driven_wheels)


def _speed_error(run: Recording, driver: Mapping[str, Any]) -> np.ndarray:
    return derived.speed(run) - cycle.wanted_speed(run, driver)


def _snow(run: Recording, vehicle: Vehicle, side: str) -> float:
    """Share under the driven wheel of a side, the front one where both are driven."""
    driven = [wheel for wheel in vehicle.driven_wheels if wheel.endswith(side)]
    if not driven:
        raise NotMeasured(f"no wheel is driven on the {side}")
    return share_of(run, vehicle, driven[0], SNOW)
