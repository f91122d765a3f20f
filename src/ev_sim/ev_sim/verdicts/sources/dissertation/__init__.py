"""How the ids of config/published/dissertation.csv are judged."""

from ev_sim.verdicts.sources.dissertation import (
    bench,
    cycle,
    drives,
    energy,
    figures,
    gains,
    metrics,
    regulation,
    surfaces,
    survey,
    vehicle,
    wheels,
)

DECLARATIONS = (
    *survey.DECLARATIONS,
    *vehicle.DECLARATIONS,
    *surfaces.DECLARATIONS,
    *cycle.DECLARATIONS,
    *regulation.DECLARATIONS,
    *metrics.DECLARATIONS,
    *wheels.DECLARATIONS,
    *drives.DECLARATIONS,
    *energy.DECLARATIONS,
    *gains.DECLARATIONS,
    *bench.DECLARATIONS,
    *figures.DECLARATIONS,
)
