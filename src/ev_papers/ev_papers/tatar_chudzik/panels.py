"""The figures of Tatar & Chudzik: forces in the axes of the car and wheel speeds over time, for each layout."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.tatar_chudzik.verdicts import CORRECTED, EQUAL, LAYOUTS, RUNS, WHEELS
from ev_sim.figures.panels import Curve, Panel, panel
from ev_sim.measures.car_axes import tyre_force
from ev_sim.measures.samples import channel, run_named
from ev_sim.recording.recording import Recording
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.panels_page import PublishedPanel, cannot_be_drawn, over_time

_OfWheel = Callable[[Recording, str, Vehicle], np.ndarray]


def _force_x(run: Recording, wheel: str, vehicle: Vehicle) -> np.ndarray:
    return tyre_force(run, wheel, vehicle).x


def _force_y(run: Recording, wheel: str, vehicle: Vehicle) -> np.ndarray:
    return tyre_force(run, wheel, vehicle).y


def _speed(run: Recording, wheel: str, vehicle: Vehicle) -> np.ndarray:
    return channel(run, f"wheel_states.velocity.{wheel}")


def _row(
    title: str, ylabel: str, first: int, step: int, control: str, of: _OfWheel, split: bool = False
) -> tuple[PublishedPanel, ...]:
    """The same panel for the three layouts; `first` and `step` number the figures, `split` ids go wheel by wheel."""

    def shown(layout: str, number: int) -> Callable[[ScenarioRuns], Panel]:
        def curves(driven: ScenarioRuns) -> list[Curve]:
            run = run_named(driven.runs, f"{layout}_{control}")
            return [
                Curve(run.time, of(run, wheel, driven.vehicle), wheel.replace("_", " ")) for wheel in WHEELS.values()
            ]

        return lambda driven: panel(f"{title}, {layout}-wheel drive", ylabel, lambda: curves(driven))

    panels = []
    for place, layout in enumerate(LAYOUTS):
        number = first + step * place
        ids = tuple(f"tatar.fig{number}.{wheel}" for wheel in WHEELS) if split else (f"tatar.fig{number}",)
        panels.append(PublishedPanel(str(number), "", title, ids, (RUNS,), over_time(shown(layout, number))))
    return tuple(panels)


PANELS = (
    cannot_be_drawn("1", "", "Schemes", "a scheme of the forces, no quantity over another one", "tatar.fig1"),
    cannot_be_drawn("2", "", "Schemes", "a scheme of inputs and outputs, no quantity over another one", "tatar.fig2"),
    *_row("Forces along y of the car, equal torques", "force [N]", 3, 3, EQUAL, _force_y),
    *_row("Forces along x of the car, equal torques", "force [N]", 4, 3, EQUAL, _force_x),
    *_row("Wheel speeds, equal torques", "speed [rad/s]", 5, 3, EQUAL, _speed),
    *_row("Forces along y of the car, corrected torques", "force [N]", 12, 1, CORRECTED, _force_y, split=True),
)
