"""How the ids of config/published/shchur2019.csv are judged."""

from ev_sim.verdicts.sources.shchur2019 import cycle, cycle_wheel_speeds, geometry, holding, steps

DECLARATIONS = (
    *steps.DECLARATIONS,
    *holding.DECLARATIONS,
    *cycle.DECLARATIONS,
    *cycle_wheel_speeds.DECLARATIONS,
    *geometry.DECLARATIONS,
)
