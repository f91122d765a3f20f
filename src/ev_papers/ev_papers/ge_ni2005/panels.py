"""The figures of Ge & Ni (2005): 3 with the law, in each reading of it, 4 with equal torques; 3 s with u held."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.ge_ni2005.claims import BASELINE, COMPARED, READINGS
from ev_papers.ge_ni2005.quantities import SIDES, ground_speed, slip
from ev_sim.figures.panels import Curve, Panel, panel
from ev_sim.measures import motion
from ev_sim.measures.samples import channel, run_named
from ev_sim.recording.recording import Recording
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.panels_page import PublishedPanel, cannot_be_drawn, over_time

_Curves = Callable[[Recording, Vehicle, str], list[Curve]]  # the last argument is how the run is called


def _one(values: Callable[[Recording], np.ndarray]) -> _Curves:
    return lambda run, vehicle, name: [Curve(run.time, values(run), name)]


def _both_wheels(values: Callable[[Recording, str, Vehicle], np.ndarray]) -> _Curves:
    return lambda run, vehicle, name: [Curve(run.time, values(run, side, vehicle), f"{name}, {side}") for side in SIDES]


def _yaw_rate_and_lateral_speed(run: Recording, vehicle: Vehicle, name: str) -> list[Curve]:
    return [
        Curve(run.time, channel(run, motion.YAW_RATE), f"{name}, w"),
        Curve(run.time, channel(run, "twist.lateral"), f"{name}, v"),
    ]


# Letter, quantity, ordinate with the ends that the scan has kept, and curves of one run.
_QUANTITIES: tuple[tuple[str, str, str, tuple[float, float] | None, _Curves], ...] = (
    ("a", "Sideslip angle", "angle [rad]", None, _one(motion.sideslip_angle)),
    ("b", "Radius of the path", "radius [m]", (0.0, 70.0), _one(motion.radius_of_path)),
    ("c", "Centripetal acceleration", "acceleration [m/s²]", (0.0, 0.6), _one(motion.lateral_acceleration_on_path)),
    ("d", "Yaw rate w and lateral speed v", "[rad/s], [m/s]", None, _yaw_rate_and_lateral_speed),
    ("e", "Slips of the driven wheels", "slip [1]", None, _both_wheels(lambda run, side, vehicle: slip(run, side))),
    ("f", "Longitudinal speed of the driven wheels", "speed [m/s]", None, _both_wheels(ground_speed)),
)
_AXES_LEFT = ("4b", "4c")  # of the others the scan has lost the numbers
_IDS = {
    "4b": ("ge.fig4b.axis", "ge.eq.radius"),
    "4c": ("ge.fig4c.axis", "ge.eq.centripetal"),
    "3f": ("ge.fig3f_4f",),
    "4f": ("ge.fig3f_4f", "ge.eq.speeds"),
}


def _panel(figure: str, letter: str, title: str, ylabel: str, ends: tuple[float, float] | None, of: _Curves):
    names = (BASELINE,) if figure == "4" else READINGS

    def curves(driven: ScenarioRuns) -> list[Curve]:
        return [
            curve
            for name in names
            for curve in of(run_named(driven.runs, name), driven.vehicle, name.replace("_", " "))
        ]

    def shown(driven: ScenarioRuns) -> Panel:
        return panel(f"{letter}  {title}", ylabel, lambda: curves(driven))

    ids = _IDS.get(figure + letter, (f"ge.fig{figure}{letter}",))
    return PublishedPanel(figure, letter, title, ids, (COMPARED,), over_time(shown, ends=ends))


PANELS = (
    cannot_be_drawn("1", "", "Schemes", "a scheme of the model, no quantity over another one", "ge.fig1"),
    cannot_be_drawn("2", "", "Schemes", "a scheme of the law, no quantity over another one", "ge.fig2"),
    *(_panel(figure, *quantity) for quantity in _QUANTITIES for figure in ("3", "4")),
)
