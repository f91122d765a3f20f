"""A scenario: ordinary ROS parameter files, resolved to one configured graph per run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ev_core.lockstep.configuration import Configuration, chosen_method, configure, refuse_unused
from ev_core.lockstep.graph import check_graph
from ev_core.methods.law_error import LawError
from ev_core.parameters.data_file import files_in_config
from ev_core.parameters.section import matches
from ev_msgs_py.contract.roles import MASTER, ROLES
from ev_msgs_py.refusal import ParameterError, quoted, shown, unknown_name
from ev_nodes.master.real_time import LONGEST, MasterParameters
from ev_sim.profiles.profile import cycle_values
from ev_stack.measures.course import NO_COURSE, Course
from ev_stack.scenarios.about import (
    NAMESPACE,
    SCENARIO_NODE,
    VEHICLE,
    ScenarioParameters,
    configured_file,
    report_of,
    said_by,
    vehicle_file,
    with_metrics,
)
from ev_stack.scenarios.lap_start import lap_start
from ev_stack.scenarios.notes import notes_on
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.slow_ramp import COLUMN, SCALE, on_its_own_car

_DRIVER = "driver"


@dataclass(frozen=True)
class Run:
    """One configured graph, the namespace of its nodes, and by which report, metrics and course it is measured."""

    name: str
    namespace: str
    configurations: Mapping[str, Configuration]
    duration: float
    report: str = ""
    metrics: tuple[str, ...] = ()
    course: Course = NO_COURSE

    @property
    def period(self) -> int:
        """The control period in nanoseconds."""
        return self.configurations[MASTER].period

    @property
    def realtime(self) -> bool:
        """Whether the wall clock drives the graph."""
        return self.configurations[MASTER].common.mode == "realtime"


@dataclass(frozen=True)
class Overrides:
    """What the command line changes beyond the scenario's own files; later entries go before earlier ones.

    `values`: (node, dotted parameter name, value). Node `*` means every role. A method that is
    driven must have each of them; those that are `prepared`, which come before, may be for other
    methods, like those of files. `vehicle` is another car than that of the scenario, as a name or a
    path; what the scenario itself changes about the car of all runs is left out then, what it
    changes about that of some runs stays. `metrics` are measured besides its own.
    """

    files: Sequence[Path] = ()
    values: Sequence[tuple[str, str, Any]] = ()
    duration: float | None = None
    vehicle: str | None = None
    prepared: Sequence[tuple[str, str, Any]] = ()
    metrics: Sequence[str] = ()

    @classmethod
    def of(
        cls,
        values: Sequence[tuple[str, str, Any]],
        seed: int | None,
        duration: float | None,
        vehicle: str | None,
        files: Sequence[Path],
        cycle: str | None,
    ) -> Overrides:
        """Those with a seed of everything random and a speed cycle, whose duration counts where none is given."""
        prepared, length = cycle_values(cycle) if cycle is not None else ([], None)
        seeds = [] if seed is None else [("*", "seed", seed)]
        return cls(
            files, [*values, *seeds], length if duration is None else duration, vehicle, prepared
        )

    @property
    def all_values(self) -> tuple[tuple[str, str, Any], ...]:
        """What is prepared, and the values that go before it."""
        return (*self.prepared, *self.values)


@dataclass(frozen=True)
class Scenario:
    """A name, its own parameters, its runs, its file, and notes on what of that does not hold."""

    name: str
    parameters: ScenarioParameters
    runs: tuple[Run, ...]
    file: Path
    notes: tuple[str, ...] = ()


def scenario_names() -> list[str]:
    """Names of all scenarios in the config folders."""
    return sorted(files_in_config("scenarios"))


def load_scenario(
    name: str, overrides: Overrides | None = None, only: Sequence[str] = ()
) -> Scenario:
    """The scenario of a name or a path, with everything resolved; of its runs only those that are named, if any is.

    Raises ParameterError, in one line, for unknown scenarios, runs, vehicles, nodes, methods and
    parameters, and for values that are refused.
    """
    overrides = overrides or Overrides()
    own = ParameterFile(configured_file("scenario", name))
    name = shown(own.path.stem)
    about = with_metrics(said_by(own), overrides.metrics)
    namespaces = {run: f"{NAMESPACE}/{run}" for run in about.runs} or {name: NAMESPACE}
    of_all = [pattern for pattern in own.sections if _means_all(pattern, namespaces.values())]
    car = own.without(f"{VEHICLE}.", of_all) if overrides.vehicle else own
    files = [
        vehicle_file(overrides.vehicle or about.vehicle),
        car,
        *map(ParameterFile, overrides.files),
    ]
    for file in files:
        _refuse_unknown_nodes(
            file, namespaces.values(), (*ROLES, SCENARIO_NODE) if file is car else tuple(ROLES)
        )
    _refuse_unknown_overrides(overrides)
    duration = about.duration if overrides.duration is None else overrides.duration
    by_the_course = duration == about.duration == 0.0
    if not 0 < duration <= LONGEST and not by_the_course:
        raise ParameterError(
            f"duration: {duration!r} is refused, expected more than 0 and at most {LONGEST:.0f} s"
        )
    for run in only:
        if run not in namespaces:
            raise unknown_name(f"run of {name}", run, namespaces)
    runs, notes, angles = [], [], dict[str, float]()
    left_out = sorted(
        {
            key
            for pattern in of_all
            for key in own.sections[pattern]
            if key.startswith(f"{VEHICLE}.")
        }
    )
    if left_out and overrides.vehicle:
        notes.append(f"left out for another vehicle: {', '.join(left_out)} of {own.path}")
    for run_name, namespace in namespaces.items():
        if only and run_name not in only:
            continue
        run = _run(run_name, _Sources(namespace, files, overrides), duration, about)
        may_differ = any((overrides.vehicle, overrides.files, overrides.all_values))
        given = _Sources(namespace, [*map(ParameterFile, overrides.files)], overrides)
        is_scaled = may_differ and SCALE in given.values(COLUMN)
        if about.slow_ramp.lateral_acceleration and may_differ and not is_scaled:
            of_file = _Sources(namespace, [vehicle_file(about.vehicle), own], Overrides())
            as_it_is = _run(run_name, of_file, about.duration, about)
            run, note = on_its_own_car(run, as_it_is, about.slow_ramp, angles)
            notes += [note] if note else []
        runs.append(
            replace(run, report=report_of(name, about), metrics=about.metrics, course=about.course)
        )
    refuse_unused_values(overrides.values, runs)
    _refuse_unfollowed_speed(overrides.all_values, runs)
    notes += notes_on(files, runs, overrides, whole=not only)
    return Scenario(name, about, tuple(runs), own.path, tuple(notes))


def _means_all(pattern: str, namespaces: Iterable[str]) -> bool:
    """Whether a section means some node of every run."""
    return all(any(matches(pattern, f"{space}/{role}") for role in ROLES) for space in namespaces)


def _refuse_unknown_nodes(
    file: ParameterFile, namespaces: Sequence[str], nodes: Sequence[str]
) -> None:
    """The parameters of a scenario stand in its own file only, and the runner sets those of the recorder."""
    for pattern in file.sections:
        if not any(
            matches(pattern, f"{space}/{node}")
            for space in (*namespaces, NAMESPACE)
            for node in nodes
        ):
            raise ParameterError(
                f"{file.path}: section {quoted(pattern)} means no node; known: {', '.join(nodes)}"
            )


def _refuse_unknown_overrides(overrides: Overrides) -> None:
    for node, key, _ in overrides.values:
        if node != "*" and node not in ROLES:
            hint = f"; the car is that of all nodes: '*.{node}.{key}'" if node == VEHICLE else ""
            raise ParameterError(f"{unknown_name('node', node, ROLES)}{hint}")


def refuse_unused_values(values: Iterable[tuple[str, str, Any]], runs: Sequence[Run]) -> None:
    """ParameterError for (node, parameter, value) that nothing in these runs takes: it would silently do nothing."""
    for node, key, _ in values:
        played = [
            c for run in runs for role, c in run.configurations.items() if node in ("*", role)
        ]
        if not played:
            raise ParameterError(
                f"{node}.{key} is refused: no node plays {node}, allowed with --method {node}=NAME"
            )
        if not any(key not in each.unused for each in played):
            try:
                refuse_unused(key, [each for each in played if each.role == played[0].role])
            except ParameterError as error:
                raise ParameterError(f"{node}: {error}", key) from None


def _refuse_unfollowed_speed(changed: Iterable[tuple[str, str, Any]], runs: Sequence[Run]) -> None:
    """ParameterError for a speed over time, or a cycle, where no driver ever follows one."""
    names = [
        key
        for node, key, _ in changed
        if node in ("*", "driver") and key.startswith("speed_profile.")
    ]
    drivers = [run.configurations["driver"] for run in runs]
    if names and not any("speed_profile.time" in driver.values() for driver in drivers):
        raise ParameterError(
            f"driver.{names[0]} is refused: driver method {drivers[0].method.name} follows no speed over time"
        )
    if names and not any(map(_follows_a_speed, runs)):
        raise ParameterError(
            f"driver.{names[0]} is refused: the driver goes by the pedals from the start on, "
            "allowed with driver.pedals.begin=false"
        )


def _follows_a_speed(run: Run) -> bool:
    values = run.configurations["driver"].values()
    pressed = (
        values.get("pedals.begin", False)
        and values["pedals.begin_time"] == values["pedals.begin_speed"] == 0.0
    )
    return not pressed or run.configurations[MASTER].values().get("speed") == "imposed"


@dataclass(frozen=True)
class _Sources:
    """What gives values to the nodes of one run: files, later ones before earlier ones, and the command line."""

    namespace: str
    files: Sequence[ParameterFile]
    overrides: Overrides

    def of(self, role: str) -> list[tuple[str, dict[str, Any]]]:
        """Where values come from, in words, and the values; nothing for the command line, which the user sees."""
        given = [
            (f" ({file.path})", file.values_for(f"{self.namespace}/{role}")) for file in self.files
        ]
        return [
            *given,
            (
                "",
                {
                    key: value
                    for node, key, value in self.overrides.all_values
                    if node in ("*", role)
                },
            ),
        ]

    def values(self, role: str) -> dict[str, Any]:
        """Those that count."""
        return {name: value for _, values in self.of(role) for name, value in values.items()}

    def origin(self, role: str, name: str) -> str:
        """Where the value was given that counts."""
        return next((origin for origin, values in reversed(self.of(role)) if name in values), "")

    def refuse_before_a_file(self, configuration: Configuration) -> None:
        """ParameterError for what is set after or beside the name of a file that has it: it would do nothing."""
        places = self.of(configuration.role)
        last = {name: place for place, (_, values) in enumerate(places) for name in values}
        for file in (name for name in configuration.from_files if name.endswith("file")):
            for name in configuration.from_files:
                is_told = name in last and (
                    last[name] > last.get(file, -1) or last[name] == len(self.files)
                )
                if is_told and name != file and name.startswith(file.removesuffix("file")):
                    raise ParameterError(
                        f"parameter {name} is refused: {file} says it, allowed with {file} ''", name
                    )


def _run(name: str, sources: _Sources, duration: float, about: ScenarioParameters) -> Run:
    values = {role: sources.values(role) for role in ROLES}
    stated = {"duration": duration, "manoeuvre_end": about.duration, "lesson": about.lesson}
    if given := [key for key in stated if key in values[MASTER]]:
        where = f"allowed in the section /**/{SCENARIO_NODE}{', or --duration' * (given[0] == 'duration')}"
        raise ParameterError(f"{MASTER}.{given[0]} is refused, {where}")
    values[MASTER] |= stated
    configurations: dict[str, Configuration] = {}
    for role in values:
        if not _is_played(role, values):
            continue
        try:
            method = chosen_method(role, values[role])
            for other, needed in method.requires.items():
                if other in values:
                    values[other].setdefault("method", needed)
            if values[role].get("mode") == "realtime":
                for other, value in method.in_real_time.items():
                    node, _, parameter = other.partition(".")
                    values[node].setdefault(parameter, value)
        except ParameterError as error:
            raise ParameterError(f"{role}: {error}") from None
    played = [role for role in values if _is_played(role, values)]
    # the driver first: his course has the start and the duration
    for role in sorted(played, key=_DRIVER.__ne__):
        try:
            configurations[role] = configure(
                role, values[role], MasterParameters if role == MASTER else None
            )
            sources.refuse_before_a_file(configurations[role])
        except LawError:  # its line names the role, and its cause is kept
            raise
        except ParameterError as error:
            raise ParameterError(
                f"{role}: {error}{sources.origin(role, error.parameter)}"
            ) from None
        if role == _DRIVER and (start := lap_start(configurations[role])) is not None:
            duration = duration or start.duration
            values[MASTER] = {**start.values, **values[MASTER], "duration": duration}
            values[MASTER]["manoeuvre_end"] = about.duration or start.duration
    configurations = {role: configurations[role] for role in played}
    check_graph(configurations)
    period = configurations[MASTER].common.control_period
    if duration < period:
        raise ParameterError(
            f"duration: {duration!r} is refused, expected at least one control period, {period:g} s"
        )
    return Run(name, sources.namespace, configurations, duration)


def _is_played(role: str, values: Mapping[str, Mapping[str, Any]]) -> bool:
    """Optional roles are played where a parameter chooses their method, or another method requires it."""
    return "method" in values[role] or not ROLES[role].optional
