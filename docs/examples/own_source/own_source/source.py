"""How what the source published (published.csv) is judged and drawn."""

from ev_sim.measures import motion
from ev_sim.measures.samples import channel, run_named
from ev_sim.verdicts.check import Number, larger, relative
from ev_sim.verdicts.declaration import judged
from ev_sim.verdicts.need import ScenarioNeed
from ev_sim.verdicts.panels_page import PublishedPanel, over_time
from own_source.report import yaw_rates

ORDER = 100  # among the sources, in tables
RUNS = ScenarioNeed("own_source")  # every verdict is on the runs of this scenario


def at_the_end(run, quantity):
    """A measure: the last sample of a quantity (n,) of a run."""
    return lambda driven: float(quantity(run_named(driven.runs, run))[-1])


def yaw_rate(run):
    """Over time, (n,) [rad/s]."""
    return channel(run, motion.YAW_RATE)


DECLARATIONS = (
    judged(
        "own.difference",
        RUNS,
        Number("N m", 100.0, relative(0.001, "the angle is held"), at_the_end("corrected", motion.differential_torque)),
    ),
    judged(
        "own.sum",
        RUNS,
        Number("N m", 200.0, relative(0.001, "ideal drives"), at_the_end("corrected", motion.total_drive_torque)),
    ),
    judged(
        "own.turns_in",
        RUNS,
        larger("rad/s", at_the_end("corrected", yaw_rate), at_the_end("equal", yaw_rate), 0.01, "no noise in the runs"),
        assumption="the car: the source names none",
    ),
)
PANELS = (
    PublishedPanel("1", "", "Yaw rate", ("own.turns_in",), (RUNS,), over_time(lambda driven: yaw_rates(driven.runs))),
)
