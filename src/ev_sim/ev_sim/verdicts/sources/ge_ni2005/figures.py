"""Curves and schemes of which only captions are left."""

from __future__ import annotations

from ev_sim.report.papers import ge_ni2005 as paper
from ev_sim.report.quantities import motion
from ev_sim.report.quantities.two_rear_motors import ground_speed
from ev_sim.report.samples import run_named
from ev_sim.verdicts.check import Measure, larger
from ev_sim.verdicts.declaration import no_verdict, not_judgeable
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.sources.ge_ni2005.claims import MARGIN, WHY
from ev_sim.verdicts.sources.ge_ni2005.runs import BASELINE, COMPARED

LOST = tuple(f"ge.fig3{panel}" for panel in "abcde") + tuple(f"ge.fig4{panel}" for panel in "ade")


def _speed(side: str, run: str) -> Measure:
    def measure(driven: ScenarioRuns) -> float:
        recording = run_named(driven.runs, run)
        return motion.value_at(recording, ground_speed(recording, side, driven.vehicle), paper.INSTANT)

    return measure


DECLARATIONS = (
    not_judgeable(
        "ge.fig3f_4f",
        "curve not in the text; beyond it, V_4 above V_3",
        (COMPARED,),
        *(
            larger("m/s", _speed("right", run), _speed("left", run), MARGIN, WHY, name)
            for name, run in (("4f", BASELINE), ("3f", "rate"))
        ),
    ),
    *(not_judgeable(id, "curve not in the text", (COMPARED,)) for id in LOST),
    *(no_verdict(id, "a scheme without numbers") for id in ("ge.fig1", "ge.fig2")),
)
