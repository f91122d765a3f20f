"""Statements of a scenario about itself, in its section /**/scenario."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ev_core.lockstep.configuration import changeable_numbers
from ev_core.methods.offered import offered
from ev_core.parameters.declaration import group, setting
from ev_core.parameters.values import build
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_nodes.master.real_time import LONGEST
from ev_stack.measures.course import Course
from ev_stack.measures.own_metrics import named_metrics
from ev_stack.scenarios.curves import DEFAULT, refuse_curves
from ev_stack.scenarios.files import configured_file
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.slow_ramp import SlowRampParameters

# of entry points: the name of a scenario, and the module of its report
REPORTS = "ev_stack.reports"
_OF_COURSES = "double_lane_change"  # its report measures and draws any course
NAMESPACE = "/ev"  # of all nodes; of one run among several /ev/RUN
SCENARIO_NODE = "scenario"
_LONGEST = 100  # characters of the name of a run
_RUN = re.compile(rf"[A-Za-z_][A-Za-z0-9_]{{0,{_LONGEST - 1}}}")  # a token of a namespace


@dataclass(frozen=True, slots=True)
class ScenarioParameters:
    """Statements of a scenario about itself, in its section /**/scenario.

    The nodes of a run live in the namespace /ev/RUN, or in /ev if there is one run only; so
    `/**/RUN/driver` means the driver of one run, and `/**/driver` that of all.
    """

    about: str = setting("", about="one line for --list")
    vehicle: str = setting(
        "audi_a2", about="name of a file in config/vehicles, or path of your own"
    )
    duration: float = setting(
        10.0,
        unit="s",
        low=0.0,
        high=LONGEST,
        about="simulated time of every run; 0: what laps of a closed course take",
    )
    runs: tuple[str, ...] = setting((), about="names of the runs, if there are several")
    slow_ramp: SlowRampParameters = group(SlowRampParameters)
    report: str = setting(
        "",
        about="scenario with the metrics and figures for it; empty for its own, "
        "and with a course for that of courses",
    )
    metrics: tuple[str, ...] = setting(
        (),
        about="metrics besides those of its report: "
        "names of docs/metrics.md, or NAME [UNIT] = EXPRESSION",
    )
    course: Course = group(Course)
    lesson: tuple[str, ...] = setting(
        (), about="numbers, as NODE.NAME, that the live page has beside its plots"
    )
    curves: tuple[str, ...] = setting(
        DEFAULT,
        about="up to four that the report has beside the car: "
        "channels, fields of topics with all their channels, or series of docs/metrics.md",
    )

    def __post_init__(self) -> None:
        """ParameterError for names of runs that cannot be those of folders and of namespaces."""
        for name in self.runs:
            if not _RUN.fullmatch(name) or self.runs.count(name) > 1:
                raise ParameterError(
                    f"runs: {quoted(str(name))} is refused, expected different names of up to "
                    f"{_LONGEST} letters, digits and underscores, the first one no digit"
                )


def report_of(name: str, about: ScenarioParameters) -> str:
    """Name of the scenario with the metrics and figures of this one."""
    if about.report:
        return about.report
    has_its_own = name in offered(REPORTS)
    return _OF_COURSES if about.course.begin and not has_its_own else name


def describe_scenario(name: str) -> str:
    """The one line of a scenario about itself."""
    return stated_by(ParameterFile(configured_file("scenario", name))).about


def stated_by(file: ParameterFile) -> ScenarioParameters:
    """Read what the file of a scenario states about it; ParameterError if it is refused."""
    values = file.values_for(f"{NAMESPACE}/{SCENARIO_NODE}", by_name=True)
    try:
        about = build(ScenarioParameters, values)
        if about.report and about.report not in offered(REPORTS):
            raise unknown_name("report", about.report, sorted(offered(REPORTS)))
        named_metrics(about.metrics)
        for text in about.lesson:
            _refuse_unknown_number(text)
        refuse_curves(about.curves)
        return about
    except ParameterError as error:
        raise ParameterError(f"{file.path}: {error}") from None


def with_metrics(about: ScenarioParameters, further: Sequence[str]) -> ScenarioParameters:
    """Add further metrics; ParameterError if one is refused, or a name is there twice."""
    texts = (*about.metrics, *further)
    named_metrics(texts)
    return replace(about, metrics=texts)


def _refuse_unknown_number(text: str) -> None:
    """ParameterError unless this is NODE.NAME of a number that may change while the node runs."""
    node, _, name = text.partition(".")
    if node not in ROLES:
        raise ParameterError(f"lesson: {unknown_name('node', node, ROLES)}")
    known = changeable_numbers(node)
    if name not in known:
        listed = [f"{node}.{each}" for each in known]
        raise ParameterError(
            f"lesson: {unknown_name(f'number of {node} that changes while it runs', text, listed)}"
        )
