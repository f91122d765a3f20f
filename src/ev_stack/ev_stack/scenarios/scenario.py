"""A scenario by its name or path, resolved in one pass to one configured graph per run.

How it works: `load_scenario` goes from files to values with their origin to configurations, and
simulates nothing.

1. Files: those of vehicle and scenario, then the further ones of a command, each read once. Which
   of several values counts follows from this order alone; the command line comes last.
2. Values: what each of these places gives to each node of a run (`sources`).
3. Configurations: first the methods, because one may require another; then the driver, because laps
   of his course may set start and duration; then all other nodes.
4. What does nothing is refused where a command gives it and noted where a file does (`unused`).

A run with the steering angles of another car only states that it needs a slow ramp
(`Run.slow_ramp`): `ev_stack.running.steering_angles` drives it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from ev_core.lockstep.configuration import Configuration, chosen_method
from ev_core.lockstep.graph import check_graph
from ev_core.methods.former_names import note_on, with_present_name
from ev_core.methods.hooks import SAME
from ev_core.parameters.section import matches
from ev_msgs_py.contract.roles import MASTER, ROLES
from ev_msgs_py.refusal import ParameterError, quoted, shown, unknown_name
from ev_nodes.master.real_time import LONGEST, MasterParameters
from ev_stack.scenarios.about import (
    NAMESPACE,
    SCENARIO_NODE,
    ScenarioParameters,
    report_of,
    stated_by,
    with_metrics,
)
from ev_stack.scenarios.files import OF_VEHICLE, VEHICLE, configured_file, vehicle_file
from ev_stack.scenarios.lap_start import lap_start
from ev_stack.scenarios.notes import Remark, notes_on
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.records import Overrides, Run, Scenario
from ev_stack.scenarios.slow_ramp import COLUMN, ROBOT, SCALE, car_of
from ev_stack.scenarios.sources import Sources
from ev_stack.scenarios.unused import (
    refuse_unfollowed_speed,
    refuse_unused_values,
    unused_in_files,
)

_DRIVER = "driver"
_FURTHER = 2  # the first place behind the files of vehicle and scenario

Values = dict[str, dict[str, Any]]  # by role and dotted name


def load_scenario(
    name: str, overrides: Overrides | None = None, only: Sequence[str] = ()
) -> Scenario:
    """Resolve the scenario of a name or a path; of its runs only those that are named, if any is.

    ParameterError, in one line, for unknown scenarios, runs, vehicles, nodes, methods and
    parameters, and for values that are refused.
    """
    overrides = overrides or Overrides()
    own = ParameterFile(configured_file("scenario", name))
    name = shown(own.path.stem)
    about = with_metrics(stated_by(own), overrides.metrics)
    # A scenario without named runs has one, with the scenario's own name.
    namespaces = {run: f"{NAMESPACE}/{run}" for run in about.runs} or {name: NAMESPACE}
    notes = []
    used = own
    if overrides.vehicle:
        used, left_out = _without_its_car(own, namespaces)
        if left_out:
            names = ", ".join(left_out)
            notes.append(Remark(f"left out for another vehicle: {names} of {own.path}"))
    vehicle = vehicle_file(overrides.vehicle or about.vehicle)
    files = [vehicle, used, *map(ParameterFile, overrides.files)]
    for file in files:
        _refuse_unknown_sections(file, namespaces, is_scenario=file is used)
    _refuse_unknown_nodes(overrides)
    duration = _duration(about, overrides)
    for run_name in only:
        if run_name not in namespaces:
            raise unknown_name(f"run of {name}", run_name, namespaces)

    runs, sources = [], []
    report = report_of(name, about)
    for run_name, namespace in namespaces.items():
        if only and run_name not in only:
            continue
        given = Sources(namespace, files, overrides)
        run = _configured_run(run_name, given, duration, about)
        run = replace(run, report=report, metrics=about.metrics, course=about.course)
        # Without any of them the car is the scenario's own, and resolving it again would be waste.
        may_be_another_car = overrides.vehicle or overrides.files or overrides.all_values
        if may_be_another_car and _needs_ramp(run, given, about, own):
            run = replace(run, slow_ramp=about.slow_ramp)
        runs.append(run)
        sources.append(given)

    refuse_unused_values(overrides.values, runs)
    refuse_unfollowed_speed(overrides.all_values, runs)
    # With only some runs, what the others use would seem to be unused.
    if not only:
        switched = {node for node, key, _ in overrides.values if key == "method"}
        notes += unused_in_files(runs, sources, switched)
    notes += notes_on(runs, overrides.values)
    notes += _former_names(sources)
    return Scenario(name, about, tuple(runs), own.path, tuple(notes), overrides.vehicle or "")


def _former_names(sources: Sequence[Sources]) -> list[Remark]:
    """A note for each method that is chosen by a former name."""
    notes = {note_on(role, each.values(role)) for each in sources for role in ROLES}
    return sorted(map(Remark, notes - {""}))


def _without_its_car(
    own: ParameterFile, namespaces: Mapping[str, str]
) -> tuple[ParameterFile, list[str]]:
    """The file of a scenario without its changes to the car of all runs, and their names."""
    of_all, left_out = [], set[str]()
    for pattern, section in own.sections.items():
        if all(_means_one(pattern, [space], ROLES) for space in namespaces.values()):
            of_all.append(pattern)
            left_out |= {name for name in section if name.startswith(OF_VEHICLE)}
    return own.without(OF_VEHICLE, of_all), sorted(left_out)


def _means_one(pattern: str, namespaces: Sequence[str], nodes: Sequence[str]) -> bool:
    """True if a section means one of some nodes at least."""
    return any(matches(pattern, f"{space}/{node}") for space in namespaces for node in nodes)


def _refuse_unknown_sections(
    file: ParameterFile, namespaces: Mapping[str, str], is_scenario: bool
) -> None:
    """The section of the scenario is in its own file only; the recorder has none at all."""
    nodes = (*ROLES, SCENARIO_NODE) if is_scenario else (*ROLES,)
    for pattern in file.sections:
        if not _means_one(pattern, (*namespaces.values(), NAMESPACE), nodes):
            raise ParameterError(
                f"{file.path}: section {quoted(pattern)} means no node; known: {', '.join(nodes)}"
            )


def _refuse_unknown_nodes(overrides: Overrides) -> None:
    for node, key, _ in overrides.values:
        if node != "*" and node not in ROLES:
            hint = f"; the car is that of all nodes: '*.{node}.{key}'" if node == VEHICLE else ""
            raise ParameterError(f"{unknown_name('node', node, ROLES)}{hint}")


def _duration(about: ScenarioParameters, overrides: Overrides) -> float:
    """The simulated time of every run; 0 if both leave it to the laps of a course."""
    duration = about.duration if overrides.duration is None else overrides.duration
    by_the_course = duration == about.duration == 0.0
    if not (0 < duration <= LONGEST or by_the_course):
        raise ParameterError(
            f"duration: {duration!r} is refused, expected more than 0 and at most {LONGEST:.0f} s"
        )
    return duration


def _needs_ramp(run: Run, given: Sources, about: ScenarioParameters, own: ParameterFile) -> bool:
    """True if the steering angles of a run are those of another car than it has."""
    ramp = about.slow_ramp
    if not ramp.lateral_acceleration or run.name == ramp.run:
        return False
    has_angles = run.configurations[COLUMN].method.name == ROBOT
    # A scale that the user gives counts as it is.
    is_scaled_by_user = given.place(COLUMN, SCALE) >= _FURTHER
    if is_scaled_by_user or not has_angles:
        return False
    # The run as the file alone has it, to compare the cars.
    of_the_file = Sources(run.namespace, [vehicle_file(about.vehicle), own], Overrides())
    as_it_is = _configured_run(run.name, of_the_file, about.duration, about)
    return car_of(run.configurations) != car_of(as_it_is.configurations)


def _configured_run(name: str, given: Sources, duration: float, about: ScenarioParameters) -> Run:
    """The graph of one run; its duration may be 0 if a course has one."""
    values = {role: with_present_name(role, given.values(role)) for role in ROLES}
    _state_times(values[MASTER], duration, about)
    _choose_methods(values)
    played = [role for role in ROLES if _is_played(role, values)]
    configurations: dict[str, Configuration] = {}
    # The driver first: laps of his course set where the car starts and how long the run is.
    for role in sorted(played, key=_DRIVER.__ne__):
        extra = MasterParameters if role == MASTER else None
        configurations[role] = given.configured(role, values[role], extra)
        start = lap_start(configurations[role]) if role == _DRIVER else None
        if start is not None:
            duration = duration or start.duration
            # What files and command line give for the start goes before what the course would.
            values[MASTER] = {**start.values, **values[MASTER], "duration": duration}
            values[MASTER]["manoeuvre_end"] = about.duration or start.duration
    # Back in the order of the roles, which everything that lists nodes follows.
    configurations = {role: configurations[role] for role in played}
    check_graph(configurations)
    period = configurations[MASTER].common.control_period
    if duration < period:
        raise ParameterError(
            f"duration: {duration!r} is refused, expected at least one control period, {period:g} s"
        )
    return Run(name, given.namespace, configurations, duration)


def _state_times(values: dict[str, Any], duration: float, about: ScenarioParameters) -> None:
    """Add to the values of the master what the scenario states of all its runs."""
    stated = {"duration": duration, "manoeuvre_end": about.duration, "lesson": about.lesson}
    for key in stated:
        if key in values:
            option = ", or --duration" if key == "duration" else ""
            raise ParameterError(
                f"{MASTER}.{key} is refused, expected in the section /**/{SCENARIO_NODE}{option}"
            )
    values |= stated


def _choose_methods(values: Values) -> None:
    """Add what the chosen methods require of other nodes; what is given stays."""
    for role in values:
        if not _is_played(role, values):
            continue
        try:
            method = chosen_method(role, values[role])
        except ParameterError as error:
            raise ParameterError(f"{role}: {error}") from None
        required = dict(method.requires)
        if values[role].get("mode") == "realtime":
            required = {**method.in_real_time, **required}
        for what, needed in required.items():
            other, _, parameter = what.partition(".")
            # The other node has to have the value that this one has, if it has any.
            if needed == SAME:
                needed = values[role].get(parameter)
            if needed is not None:
                values[other].setdefault(parameter or "method", needed)


def _is_played(role: str, values: Values) -> bool:
    """True if a parameter chooses the method of a role, or another method requires it."""
    return "method" in values[role] or not ROLES[role].optional
