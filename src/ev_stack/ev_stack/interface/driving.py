"""`ev_stack.run` and `ev_stack.batch`: scenarios by name or path, offline, with changes by name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from os import fspath
from typing import Annotated, Any, Unpack

from ev_msgs_py.arguments import checked
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_stack.batches.batch import BatchResult, Threads
from ev_stack.batches.batch import batch as batch_of
from ev_stack.batches.observer import Reduction
from ev_stack.interface.changes import Changes, Name, overrides
from ev_stack.measures.registry import METRICS
from ev_stack.report.reports import known_metrics
from ev_stack.report.result import Result
from ev_stack.running.beforehand import compile_for
from ev_stack.running.offline import drive_offline
from ev_stack.running.steering_angles import run_with_own_angles, with_own_angles
from ev_stack.scenarios.records import Overrides, Run
from ev_stack.scenarios.scenario import load_scenario


@checked
def run(
    scenario: Name,
    runs: Sequence[str] = (),
    metrics: Sequence[str] = (),
    **changes: Unpack[Changes],
) -> Result:
    """Drive a scenario for its signals, metrics, hash and figures: `ev_stack.run("shchur2019")`.

    `scenario` is a name or the path of a YAML file; of its runs those in `runs` are driven, all if
    it is empty. `metrics` are measured besides those of the scenario (docs/metrics.md). What
    differs from the scenario's file:

    - `method`: {"asr": "pi_slip"}, by node,
    - `set`: {"electronic_differential.gamma": 10.0}, by NODE.PARAMETER, where the node `*` is every
      node; a method that is driven must have it,
    - `seed`: of everything random, `duration`: simulated time of every run, in s or as "1 min",
    - `vehicle`: another car, as a name or the path of a complete file,
    - `params`: paths of ROS parameter files on top of the scenario's,
    - `cycle`: another speed cycle, as a name in config/cycles or the path of a CSV file.

    ParameterError, in one line, if something is refused; SignalError if a number is not finite.

    >>> import ev_stack
    >>> result = ev_stack.run("double_lane_change", metrics=["final_speed"], duration=1.0)
    >>> result.signals["imu.yaw_rate"].shape
    (101,)
    >>> result.metrics["final_speed"].unit
    'm/s'
    """
    # Metrics change nothing about the run, so they are no part of `Changes`.
    changed = replace(overrides(**changes), metrics=tuple(metrics))
    loaded = with_own_angles(load_scenario(fspath(scenario), changed, only=runs))
    # All at once and on all cores, before the first run would compile its own one by one.
    compile_for(loaded.runs, in_nodes=False)
    return Result(loaded, {each.name: drive_offline(each) for each in loaded.runs})


@checked
def batch(
    scenario: Name,
    vary: Mapping[str, Iterable[Any]] | None = None,
    run: str = "",
    signals: Sequence[str] = (),
    every: Annotated[int, "a whole number of periods, at least 1"] = 1,
    metrics: Annotated[
        Mapping[str, Reduction] | Sequence[str] | None,
        "a list of texts, or {NAME: REDUCTION} such as {'end': last('imu.yaw_rate')}",
    ] = None,
    initial_states: Mapping[str, Any] | None = None,
    threads: Threads = None,
    **changes: Unpack[Changes],
) -> BatchResult:
    """Many runs of a scenario in one call, compiled and on all cores.

    `vary` has by ROLE.PARAMETER one value for each run; `run` names which run of the scenario is
    meant if it has several. From `method` on the arguments are those of `run`, the rest is that of
    `ev_stack.batches.batch.batch`.

    >>> import ev_stack
    >>> masses = {"*.vehicle.mass": [1100.0, 1300.0, 1500.0]}
    >>> result = ev_stack.batch("double_lane_change", masses, metrics=["final_speed"], duration=1.0)
    >>> result.metrics["final_speed"].shape
    (3,)
    """
    of = only_run(scenario, run, overrides(**changes))
    if metrics and not isinstance(metrics, Mapping):
        of_report = known_metrics([of])
        for name in metrics:
            if name in of_report and name not in METRICS and "=" not in name:
                raise ParameterError(
                    f"metric {name} is one of the report {of.report}, expected in a batch are those"
                    " of any run (docs/metrics.md) and expressions; ev_stack.run and a sweep"
                    " measure those of reports"
                )
    return batch_of(
        of.configurations, of.duration, vary, initial_states, signals, every, metrics, threads
    )


def only_run(scenario: Name, run: str, changed: Overrides) -> Run:
    """The run of a name, which may be empty if there is one; ParameterError lists them if not."""
    loaded = load_scenario(fspath(scenario), changed, only=(run,) if run else ())
    if len(loaded.runs) > 1:
        raise unknown_name(f"run of {loaded.name}", run, [each.name for each in loaded.runs])
    return run_with_own_angles(loaded.runs[0])
