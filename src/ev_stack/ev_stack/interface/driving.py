"""`ev_stack.run` and `ev_stack.batch`: scenarios by name or path, offline, with what differs given by name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from os import PathLike, fspath
from pathlib import Path
from typing import Any

from ev_core.parameters.values import number_of
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.batches.batch import BatchResult
from ev_stack.batches.batch import batch as batch_of
from ev_stack.batches.observer import Reduction
from ev_stack.measures.registry import METRICS
from ev_stack.report.reports import known_metrics
from ev_stack.report.result import Result
from ev_stack.running.beforehand import compile_for
from ev_stack.running.offline import drive_offline
from ev_stack.scenarios.scenario import Overrides, Run, load_scenario

Name = str | PathLike[str]  # or a path


def run(
    scenario: Name,
    runs: Sequence[str] = (),
    metrics: Sequence[str] = (),
    *,
    method: Mapping[str, str] | None = None,
    set: Mapping[str, Any] | None = None,
    seed: int | None = None,
    duration: float | str | None = None,
    vehicle: Name | None = None,
    params: Iterable[Name] = (),
    cycle: Name | None = None,
) -> Result:
    """Drive a scenario and give its signals, metrics, hash and figures: `ev_stack.run("shchur2019")`.

    `scenario` is a name or the path of a YAML file; of its runs those in `runs` are driven, all if
    it is empty. `metrics` are measured besides those of the scenario (docs/metrics.md). What
    differs from the scenario's file:

    - `method`: {"asr": "pi_slip"}, by node,
    - `set`: {"electronic_differential.gamma": 10.0}, by NODE.PARAMETER, where the node `*` is every node; a method that
      is driven must have it,
    - `seed`: of everything random, `duration`: simulated time of every run, in s or such as "1 min",
    - `vehicle`: another car, as a name or the path of a complete file,
    - `params`: paths of ROS parameter files on top of the scenario's,
    - `cycle`: another speed cycle, as a name in config/cycles or the path of a CSV file.

    ParameterError, in one line, if something is refused; SignalError if a number is not finite.
    """
    changed = replace(
        overrides(method, set, seed, duration, vehicle, params, cycle), metrics=tuple(metrics)
    )
    loaded = load_scenario(fspath(scenario), changed, only=runs)
    compile_for(loaded.runs, in_nodes=False)
    return Result(loaded, {each.name: drive_offline(each) for each in loaded.runs})


def batch(
    scenario: Name,
    vary: Mapping[str, Iterable[Any]] | None = None,
    run: str = "",
    signals: Sequence[str] = (),
    every: int = 1,
    metrics: Mapping[str, Reduction] | Sequence[str] | None = None,
    initial_states: Mapping[str, Any] | None = None,
    threads: int | None = None,
    *,
    method: Mapping[str, str] | None = None,
    set: Mapping[str, Any] | None = None,
    seed: int | None = None,
    duration: float | str | None = None,
    vehicle: Name | None = None,
    params: Iterable[Name] = (),
    cycle: Name | None = None,
) -> BatchResult:
    """Many runs of a scenario in one call, compiled and on all cores.

    `vary` has by ROLE.PARAMETER one value for each run; `run` names which run of the scenario is
    meant if it has several. From `method` on the arguments are those of `run`, the rest is that of
    `ev_stack.batches.batch.batch`.
    """
    of = only_run(scenario, run, overrides(method, set, seed, duration, vehicle, params, cycle))
    if metrics and not isinstance(metrics, Mapping):
        of_report = known_metrics([of])
        for name in metrics:
            if name in of_report and name not in METRICS and "=" not in name:
                raise ParameterError(
                    f"metric {name} is one of the report {of.report}, expected in a batch are those of any run "
                    "(docs/metrics.md) and expressions; ev_stack.run and a sweep measure those of reports"
                )
    return batch_of(
        of.configurations, of.duration, vary, initial_states, signals, every, metrics, threads
    )


def overrides(
    method: Mapping[str, str] | None = None,
    set: Mapping[str, Any] | None = None,
    seed: int | None = None,
    duration: float | str | None = None,
    vehicle: Name | None = None,
    params: Iterable[Name] = (),
    cycle: Name | None = None,
) -> Overrides:
    """What differs from a scenario's file; ParameterError for a name in `set` without a dot, and for no duration."""
    values: list[tuple[str, str, Any]] = [
        (node, "method", name) for node, name in (method or {}).items()
    ]
    for place, value in (set or {}).items():
        node, _, parameter = place.partition(".")
        if not parameter:
            raise ParameterError(f"set: {quoted(place)} is refused, expected NODE.PARAMETER")
        values.append((node, parameter, value))
    seconds = number_of(duration, "s") if isinstance(duration, str) else duration
    if duration is not None and (isinstance(seconds, bool) or not isinstance(seconds, int | float)):
        raise ParameterError(
            f"duration: {quoted(duration)} is refused, expected a number of seconds or such as '5 s'"
        )
    car, of_cycle = fspath(vehicle) if vehicle else None, None if cycle is None else fspath(cycle)
    return Overrides.of(values, seed, seconds, car, [Path(path) for path in params], of_cycle)


def only_run(scenario: Name, run: str, changed: Overrides) -> Run:
    """One run of a scenario, whose name may be empty if there is one only; ParameterError that lists them if not."""
    loaded = load_scenario(fspath(scenario), changed, only=(run,) if run else ())
    if len(loaded.runs) > 1:
        raise unknown_name(f"run of {loaded.name}", run, [each.name for each in loaded.runs])
    return loaded.runs[0]
