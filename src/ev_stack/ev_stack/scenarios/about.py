"""What a scenario states about itself, in its section /**/scenario, and the files that it names."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ev_core.lockstep.configuration import changeable_numbers
from ev_core.methods.offered import offered
from ev_core.parameters.data_file import files_in_config, refuse_outside
from ev_core.parameters.declaration import entries, group, setting
from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.files import with_files
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_nodes.master.real_time import LONGEST
from ev_stack.measures.course import Course
from ev_stack.measures.own_metrics import named_metrics
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.slow_ramp import SlowRampParameters

# of entry points: the name of a scenario, and the module of its report
REPORTS = "ev_stack.reports"
VEHICLE = "vehicle"


def is_path(name: str) -> bool:
    """Whether a file is meant, and no name: a name has neither folder nor suffix."""
    return os.sep in name or name.endswith((".yaml", ".yml"))


def configured_file(kind: str, name: str) -> Path:
    """The file of a scenario or a vehicle in the config folders, or by its path any other that may be named.

    ParameterError that lists the known ones for an unknown name.
    """
    if is_path(name):
        refuse_outside(name, Path(name))
        return Path(name)
    known = files_in_config(f"{kind}s")
    if name not in known:
        raise unknown_name(kind, name, known)
    return known[name]


def vehicle_file(name: str) -> ParameterFile:
    """The vehicle of a name or a path.

    ParameterError that lists what is missing if the file does not state everything in which cars
    differ: it would be filled up from another car; and for whatever else it states, which the
    scenario would overrule in silence.
    """
    file = ParameterFile(configured_file(VEHICLE, name))
    if others := sorted(each for each in file.names() if not each.startswith(f"{VEHICLE}.")):
        what = f"parameter {quoted(others[0])} is no vehicle's, expected those of {VEHICLE}; others stand in a scenario"
        raise ParameterError(f"{file.path}: {what}")
    stated = file.values_for("/ev/plant")
    own = [entry.name for entry in entries(Vehicle, f"{VEHICLE}.") if entry.spec.own]
    if missing := [each for each in own if each not in stated]:
        raise ParameterError(
            f"{file.path}: a vehicle says everything about itself, missing: {', '.join(missing)}"
        )
    return file


def vehicle_of(name: str) -> Vehicle:
    """The vehicle itself, its files read; ParameterError, in one line, if there is none or it is refused."""
    values = vehicle_file(name).values_for("/ev/plant")
    own = {key: value for key, value in values.items() if key.startswith(f"{VEHICLE}.")}
    return with_files(build(Vehicle, own, f"{VEHICLE}."))


NAMESPACE = "/ev"  # of all nodes; of one run among several /ev/RUN
SCENARIO_NODE = "scenario"
_LONGEST = 100  # characters of the name of a run
_RUN = re.compile(rf"[A-Za-z_][A-Za-z0-9_]{{0,{_LONGEST - 1}}}")  # a token of a namespace


@dataclass(frozen=True, slots=True)
class ScenarioParameters:
    """What a scenario states about itself, in its section /**/scenario.

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
        about="scenario whose metrics and figures it gets; empty for its own, and with a course for that of courses",
    )
    metrics: tuple[str, ...] = setting(
        (),
        about="metrics besides those of its report: names of docs/metrics.md, or NAME [UNIT] = EXPRESSION",
    )
    course: Course = group(Course)
    lesson: tuple[str, ...] = setting(
        (), about="numbers, as NODE.NAME, that the live page has beside its plots"
    )

    def __post_init__(self) -> None:
        """Names of runs are those of folders and of namespaces, and ParameterError if they cannot be."""
        for name in self.runs:
            if not _RUN.fullmatch(name) or self.runs.count(name) > 1:
                raise ParameterError(
                    f"runs: {quoted(str(name))} is refused, expected different names of up to {_LONGEST} letters, "
                    "digits and underscores, the first one no digit"
                )


_OF_COURSES = "double_lane_change"  # measures and draws any course


def report_of(name: str, about: ScenarioParameters) -> str:
    """Whose metrics and figures a scenario of this name gets."""
    has_its_own = bool(about.report) or name in offered(REPORTS) or not about.course.begin
    return (about.report or name) if has_its_own else _OF_COURSES


def describe_scenario(name: str) -> str:
    """The one line of a scenario about itself."""
    return said_by(ParameterFile(configured_file("scenario", name))).about


def said_by(file: ParameterFile) -> ScenarioParameters:
    """What the file of a scenario states; ParameterError if it is refused."""
    try:
        about = build(
            ScenarioParameters, file.values_for(f"{NAMESPACE}/{SCENARIO_NODE}", by_name=True)
        )
        if about.report and about.report not in offered(REPORTS):
            raise unknown_name("report", about.report, sorted(offered(REPORTS)))
        named_metrics(about.metrics)
        for text in about.lesson:
            _refuse_unknown_number(text)
        return about
    except ParameterError as error:
        raise ParameterError(f"{file.path}: {error}") from None


def with_metrics(about: ScenarioParameters, further: Sequence[str]) -> ScenarioParameters:
    """What a scenario states, with further metrics; ParameterError if one is refused, or a name is there twice."""
    texts = (*about.metrics, *further)
    named_metrics(texts)
    return replace(about, metrics=texts)


def _refuse_unknown_number(text: str) -> None:
    """ParameterError unless this is NODE.NAME of a number that a method of the node may change while it runs."""
    node, _, name = text.partition(".")
    if node not in ROLES:
        raise ParameterError(f"lesson: {unknown_name('node', node, ROLES)}")
    if name not in (known := changeable_numbers(node)):
        listed = [f"{node}.{each}" for each in known]
        raise ParameterError(
            f"lesson: {unknown_name(f'number of {node} that changes while it runs', text, listed)}"
        )
