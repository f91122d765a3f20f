"""What a scenario says about itself, in its section /**/scenario."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ev_msgs_py.nodes.master_parameters import LONGEST
from ev_msgs_py.parameters.declaration import ParameterError, group, parameter
from ev_msgs_py.parameters.shown import quoted
from ev_msgs_py.parameters.values import build
from ev_sim.report.reports import refuse_unknown_report
from ev_sim.running.scenarios.configured_file import configured_file
from ev_sim.running.scenarios.parameter_file import ParameterFile
from ev_sim.running.scenarios.slow_ramp import SlowRampParameters

NAMESPACE = "/ev"  # of all nodes; of one run among several /ev/RUN
SCENARIO_NODE = "scenario"
_LONGEST = 100  # characters of the name of a run
_RUN = re.compile(rf"[A-Za-z_][A-Za-z0-9_]{{0,{_LONGEST - 1}}}")  # a token of a namespace


@dataclass(frozen=True, slots=True)
class ScenarioParameters:
    """What a scenario says about itself, in its section /**/scenario.

    The nodes of a run live in the namespace /ev/RUN, or in /ev if there is one run only; so `/**/RUN/driver` means the
    driver of one run, and `/**/driver` that of all.
    """

    about: str = parameter("", about="one line for --list")
    vehicle: str = parameter("audi_a2", about="name of a file in config/vehicles, or path of your own")
    duration: float = parameter(10.0, unit="s", low=0.01, high=LONGEST, about="simulated time of every run")
    runs: tuple[str, ...] = parameter((), about="names of the runs, if there are several")
    slow_ramp: SlowRampParameters = group(SlowRampParameters)
    report: str = parameter("", about="scenario whose metrics and figures it gets; empty for that of its own name")
    metrics: tuple[str, ...] = parameter(
        (), about="metrics of its own, each as NAME = REDUCTION(CHANNEL), such as peak = maximum(imu.yaw_rate)"
    )

    def __post_init__(self) -> None:
        """Names of runs are those of folders and of namespaces, and ParameterError if they cannot be."""
        for name in self.runs:
            if not _RUN.fullmatch(name) or self.runs.count(name) > 1:
                raise ParameterError(
                    f"runs: {quoted(str(name))} is refused, allowed are different names of up to {_LONGEST} letters, "
                    "digits and underscores, the first one no digit"
                )


def describe_scenario(name: str) -> str:
    """The one line that a scenario says about itself."""
    return said_by(ParameterFile(configured_file("scenario", name))).about


def said_by(file: ParameterFile) -> ScenarioParameters:
    """What the file of a scenario says; ParameterError if it is refused."""
    try:
        about = build(ScenarioParameters, file.values_for(f"{NAMESPACE}/{SCENARIO_NODE}", by_name=True))
        refuse_unknown_report(about.report, about.metrics)
        return about
    except ParameterError as error:
        raise ParameterError(f"{file.path}: {error}") from None
