"""Report on Tatar & Chudzik, figs 3 to 14: lateral forces with equal and with corrected torques, for three layouts.

A run is called LAYOUT_CTRL: front, rear or all wheels driven, equal or corrected torques. Forces are compared when the
cars have the same speed in the bend: at the same time the corrected car is faster, and a faster car needs more force.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.report.claim import LARGER, SMALLER, comparison
from ev_sim.report.figures.panels import Curve, Panel, panel
from ev_sim.report.metric import Band, Metric, NotMeasured, metric
from ev_sim.report.quantities import derived, handling, motion
from ev_sim.report.samples import Runs, channel, run_named
from ev_sim.run.recording.recording import Recording

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LAYOUTS = ("front", "rear", "all")
CONTROLS = ("equal", "corrected")
SPEED = 8.5  # [m/s], which every run passes in the bend, some seconds after turning in
CLAIMS: dict[str, dict[str, Band]] = {
    "front": {"front_left": SMALLER, "rear_left": LARGER, "rear_right": LARGER},
    "rear": {"front_left": SMALLER, "front_right": SMALLER, "rear_left": LARGER, "rear_right": LARGER},
    "all": {"front_left": SMALLER, "front_right": SMALLER, "rear_left": LARGER, "rear_right": LARGER},
}
FIGURES = {"front": "12 against 3", "rear": "13 against 6", "all": "14 against 9"}
ASSUMPTION = f"drive torque, gain and sign of the correction, tyre (none is given); compared at {SPEED:g} m/s"


def metrics(runs: Runs) -> dict[str, Metric]:
    """Lateral forces, total tyre force and drive energy at equal speed, and the published claims."""
    result = {}
    for name in (f"{layout}_{control}" for layout in LAYOUTS for control in CONTROLS):
        for wheel in WHEEL_NAMES:
            result[f"lateral_force_{wheel}_{name}"] = metric(_lateral_force(runs, name, wheel), "N")
        result[f"total_tyre_force_{name}"] = metric(_when_fast(runs, name, _total_force), "N")
        result[f"drive_energy_{name}"] = metric(_when_fast(runs, name, energy_since_turning_in), "J")
        result[f"time_to_speed_{name}"] = metric(_when_fast(runs, name, _time_since_turning_in), "s")
    for layout, claims in CLAIMS.items():
        for wheel, band in claims.items():
            falls = band == SMALLER
            result[f"claim_{'smaller' if falls else 'larger'}_lateral_force_{wheel}_{layout}"] = comparison(
                f"the correction {'lowers' if falls else 'raises'} the lateral force (fig. {FIGURES[layout]})",
                band,
                _lateral_force(runs, f"{layout}_corrected", wheel),
                _lateral_force(runs, f"{layout}_equal", wheel),
                "N",
                ASSUMPTION,
            )
    return result


def figures(runs: Runs) -> dict[str, Figure]:
    """Lateral forces of each wheel as in figs 3 to 14, equal beside corrected, over the speed in the bend."""
    from ev_sim.report.figures.drawing import sheet

    over_speed = [_panel(runs, wheel, layout) for wheel in WHEEL_NAMES for layout in LAYOUTS]
    return {
        "lateral_forces": sheet(over_speed, "speed [m/s]", columns=len(LAYOUTS)),
        "time": sheet(_over_time(runs), "time [s]", columns=len(LAYOUTS)),
    }


def turning_in(run: Recording) -> int:
    """The first sample with turned front wheels; NotMeasured if there is none."""
    return motion.first(channel(run, derived.ROAD_WHEEL_ANGLE) != 0.0, "steering")


def _when_fast(runs: Runs, name: str, values: Callable[[Recording], np.ndarray]) -> Callable[[], float]:
    """The quantity (n,) at the instant at which the run passes SPEED in the bend."""

    def measure() -> float:
        run = run_named(runs, name)
        start = turning_in(run)
        speed = derived.speed(run)
        if speed[start] >= SPEED:
            raise NotMeasured(f"the car is faster than {SPEED:g} m/s before the bend")
        time = motion.crossing_time(run.time[start:], speed[start:], SPEED, f"{SPEED:g} m/s")
        return motion.value_at(run, values(run), time)

    return measure


def _lateral_force(runs: Runs, name: str, wheel: str) -> Callable[[], float]:
    return _when_fast(runs, name, lambda run: channel(run, f"tire_forces.lateral_force.{wheel}"))


def _total_force(run: Recording) -> np.ndarray:
    """Sum of the magnitudes of the four tyre forces in the plane of the road, (n,) [N]."""
    along, across = (
        [channel(run, f"tire_forces.{kind}_force.{wheel}") for wheel in WHEEL_NAMES]
        for kind in ("longitudinal", "lateral")
    )
    return np.hypot(along, across).sum(axis=0)


def energy_since_turning_in(run: Recording) -> np.ndarray:
    """Work of the drives at the wheels since the front wheels are turned, (n,) [J]."""
    work = handling.drive_work(run)
    return work - work[turning_in(run)]


def _time_since_turning_in(run: Recording) -> np.ndarray:
    return run.time - run.time[turning_in(run)]


def _panel(runs: Runs, wheel: str, layout: str) -> Panel:
    def curves() -> list[Curve]:
        found = []
        for control in CONTROLS:
            run = run_named(runs, f"{layout}_{control}")
            start = turning_in(run) + int(1.0 / (run.time[1] - run.time[0]))  # when the turn-in is over
            force = channel(run, f"tire_forces.lateral_force.{wheel}")
            found.append(Curve(derived.speed(run)[start:], force[start:], control))
        return found

    return panel(f"{wheel.replace('_', ' ')}, {layout}-wheel drive", "lateral force [N]", curves)


def _over_time(runs: Runs) -> list[Panel]:
    """Figs 3 to 11 with equal torques: forces across and along, wheel speeds."""

    def of(layout: str, title: str, ylabel: str, quantity: str) -> Panel:
        def curves() -> list[Curve]:
            run = run_named(runs, f"{layout}_equal")
            return [Curve(run.time, channel(run, f"{quantity}.{w}"), w.replace("_", " ")) for w in WHEEL_NAMES]

        return panel(f"{title}, {layout}-wheel drive", ylabel, curves)

    rows = (
        ("Lateral force", "force [N]", "tire_forces.lateral_force"),
        ("Longitudinal force", "force [N]", "tire_forces.longitudinal_force"),
        ("Wheel speed", "speed [rad/s]", "wheel_states.velocity"),
    )
    return [of(layout, *row) for row in rows for layout in LAYOUTS]
