"""Which lateral forces the correction lowers and which it raises, at equal speed, in the axes of the car."""

from __future__ import annotations

from ev_sim.verdicts.check import Comparison
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.sources.tatar_chudzik.runs import (
    ASSUMPTION,
    CORRECTED,
    EQUAL,
    RUNS,
    SPEEDS,
    WHEELS,
    force_y,
    passing,
)

MARGIN, WHY = 0.001, "a sign at each of four speeds; numerical noise is below 0.01 % of the force"
RISES, FALLS = True, False
CLAIMS = {  # figure with the correction: the layout, and what happens to each wheel
    "fig12": ("front", {"FL": FALLS, "RL": RISES, "RR": RISES, "FR": RISES}),
    "fig13": ("rear", {"FL": FALLS, "FR": FALLS, "RL": RISES, "RR": RISES}),
    "fig14": ("all", {"FL": FALLS, "FR": FALLS, "RL": RISES, "RR": RISES}),
}


def _claim(figure: str, layout: str, wheel: str, rises: bool) -> Declaration:
    force = force_y(WHEELS[wheel])
    return judged(
        f"tatar.{figure}.{wheel}",
        RUNS,
        *(
            Comparison(
                "N",
                rises,
                MARGIN,
                WHY,
                passing(f"{layout}_{CORRECTED}", speed, force),
                passing(f"{layout}_{EQUAL}", speed, force),
                f"at {speed:g} m/s",
            )
            for speed in SPEEDS
        ),
        assumption=ASSUMPTION,
    )


DECLARATIONS = tuple(
    _claim(figure, layout, wheel, rises)
    for figure, (layout, wheels) in CLAIMS.items()
    for wheel, rises in wheels.items()
)
