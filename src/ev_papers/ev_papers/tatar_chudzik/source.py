"""The place of Tatar & Chudzik among the sources, what measures the numbers of published.csv, and the figures."""

from __future__ import annotations

from ev_papers.tatar_chudzik import measures
from ev_papers.tatar_chudzik.report import panels
from ev_sim.verdicts.check import measures_of
from ev_sim.verdicts.need import ScenarioNeed
from ev_sim.verdicts.panels_page import PublishedPanel, cannot_be_drawn, over_time

ORDER = 2  # among the sources, in tables
MEASURES = measures_of(measures)


def _row(title: str, numbers: range) -> tuple[PublishedPanel, ...]:
    """The figures of the three layouts; of those with corrected torques each wheel has an id."""
    ends = [f".{wheel}" for wheel in measures.WHEELS] if numbers[0] == 12 else [""]
    return tuple(
        PublishedPanel(
            str(number),
            "",
            title,
            tuple(f"tatar.fig{number}{end}" for end in ends),
            (ScenarioNeed("tatar_chudzik"),),
            over_time(lambda driven, number=number: panels(driven.runs, driven.vehicle)[number]),
        )
        for number in numbers
    )


PANELS = (
    cannot_be_drawn("1", "", "Schemes", "a scheme of the forces, no quantity over another one", "tatar.fig1"),
    cannot_be_drawn("2", "", "Schemes", "a scheme of inputs and outputs, no quantity over another one", "tatar.fig2"),
    *_row("Forces along y of the car, equal torques", range(3, 12, 3)),
    *_row("Forces along x of the car, equal torques", range(4, 12, 3)),
    *_row("Wheel speeds, equal torques", range(5, 12, 3)),
    *_row("Forces along y of the car, corrected torques", range(12, 15)),
)
