"""What measures the numbers of published.csv, and the figures of the source."""

from ev_sim.measures import motion
from ev_sim.measures.metric import channel, run_named
from ev_study.verdicts.need import ScenarioNeed
from ev_study.verdicts.panels_page import PublishedPanel, over_time
from own_source.report import yaw_rates

ORDER = 100  # among the sources, in tables


def difference(driven, run):
    """Torque of the right front wheel minus that of the left one at the end of a run [N m]."""
    return motion.differential_torque(run_named(driven.runs, run))[-1]


def total(driven, run):
    """Drive torque of all wheels at the end of a run [N m]."""
    return motion.total_drive_torque(run_named(driven.runs, run))[-1]


def yaw_rate(driven, run):
    """Yaw rate at the end of a run [rad/s]."""
    return channel(run_named(driven.runs, run), motion.YAW_RATE)[-1]


MEASURES = {"difference": difference, "total": total, "yaw_rate": yaw_rate}  # by their names in published.csv
PANELS = (
    PublishedPanel(
        figure="1",
        letter="",
        row="Yaw rate",
        ids=("own.turns_in",),
        needs=(ScenarioNeed("own_source"),),
        draw=over_time(lambda driven: yaw_rates(driven.runs)),
    ),
)
