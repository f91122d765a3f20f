"""The figures of the source; its numbers stand in published.csv, with the expressions that measure them."""

from ev_study.verdicts.need import ScenarioNeed
from ev_study.verdicts.panels_page import PublishedPanel, over_time
from own_source.report import yaw_rates

ORDER = 100  # among the sources, in tables
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
