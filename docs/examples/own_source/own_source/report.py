"""The report on the scenario own_source: its verdicts as metrics, and figure 1 of the source."""

from ev_stack.figures.panels import degrees, over_time
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.metric import channel
from ev_study.verdicts.need import ScenarioRuns
from ev_study.verdicts.verdict import metrics_at_hand


def metrics(runs, vehicle, parameters):
    """What the source is judged by."""
    return metrics_at_hand("own_source", "own_source", ScenarioRuns(runs, vehicle, parameters))


def figures(runs):
    """Figure 1."""
    return {"fig1": Sheet([yaw_rates(runs)])}


def yaw_rates(runs):
    """Figure 1: the yaw rates of all runs."""
    return over_time(
        runs, "1  Yaw rate", "yaw rate [deg/s]", degrees(lambda run: channel(run, motion.YAW_RATE))
    )
