"""Drive the runs of a scenario, write what they leave behind, print the metrics."""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

from ev_core.methods.offered import offered, offered_module
from ev_msgs_py.refusal import LINE, quoted, shown
from ev_stack.command_line.options import overrides, own_nodes, printing, processors
from ev_stack.measures.own_metrics import listed
from ev_stack.recording.outcome import Outcome, RunFailed, progress_bar
from ev_stack.report.result import Result
from ev_stack.report.tables import in_words, print_metrics
from ev_stack.running.beforehand import compile_for
from ev_stack.running.buses import buses
from ev_stack.running.output_folder import folder_of, output_folder
from ev_stack.running.steering_angles import with_own_angles
from ev_stack.scenarios.records import Run
from ev_stack.scenarios.scenario import load_scenario

# of entry points: `program`, the module that moves laws onto other processors
PROCESSORS = "ev_stack.processors"
_MIDDLEWARE = "RMW_IMPLEMENTATION"
# bytes; where there are fewer, LTTng of ROS 2 ends the process by SIGBUS
_SHARED_MEMORY, _ROOM = "/dev/shm", 65536


def drive_scenario(given: argparse.Namespace) -> None:
    """Drive all runs of a scenario and report.

    Raises what `ev_stack.commands.run_scenario.main` catches.
    """
    prints, own = printing(given), own_nodes(given)
    changed = replace(overrides(given), metrics=listed(given.metrics))
    scenario = load_scenario(given.scenario, changed, given.run)
    # Before anything is driven, slow ramps included.
    _refuse_without_ros(given)
    scenario = with_own_angles(scenario)
    on_processors = []
    if given.processor:
        if "program" not in offered(PROCESSORS):
            raise RunFailed("--processor needs the package ev_doors, which is not installed here")
        programs = offered_module(PROCESSORS, "--processor", "program")
        moved = [programs.with_processors(run, processors(given)) for run in scenario.runs]
        scenario = replace(scenario, runs=tuple(run for run, _ in moved))
        on_processors = [each for _, made in moved for each in made]
    way = "offline" if given.offline else "in-process" if given.in_process else "processes"
    commands = {role: " ".join(words) for role, words in own.items()}
    mode = f"{way}, realtime" if given.realtime else way
    # Before the folder is made and before nodes start, which would each compile on their own.
    compile_for(scenario.runs, not given.offline, own)
    with output_folder(given.out, scenario.name) as folder:
        outcomes = {}
        for run in scenario.runs:
            outcomes[run.name] = _drive(run, folder_of(run, scenario.runs, folder), given, own)
        result = Result(scenario, outcomes, mode, commands, given.command)
        summary, figures = result.summary(), {} if given.no_report else result.figures()
        content = result.write_report(folder, figures, not given.no_report)
        prints.save(result.sheets, folder)
    print_metrics(summary.metrics)
    for note in summary.notes:
        print(f"note: {shown(note, LINE)}")
    for reason in summary.not_reproducible:
        print(f"not reproducible: {reason}")
    for timing in summary.timing.values():
        print(in_words(timing))
    for each in on_processors:
        print(each.report)
    print(f"signal hash {content['signal_hash']}")
    print(
        f"{summary.simulated_time:g} s in {summary.wall_time:.2f} s,"
        f" {content['real_time_factor']:.1f} x real time"
    )
    page = "" if given.no_report else "report.html, figures, "
    print(f"{page}signals and summary: {folder}")


def _refuse_without_ros(given: argparse.Namespace) -> None:
    """RunFailed, before anything is made, if ROS 2 is needed and not installed or cannot start."""
    if not given.offline:
        if find_spec("rclpy") is None:
            raise RunFailed(
                "nodes need ROS 2 (rclpy), which is not installed here: --offline --no-record needs"
                " none"
            )
        middleware = os.environ.get(_MIDDLEWARE, "")
        if middleware not in ("", "rmw_fastrtps_cpp") and not _can_be_loaded():
            raise RunFailed(
                f"{_MIDDLEWARE}={quoted(middleware)} is refused, expected one that is installed, or"
                " none"
            )
        if os.access(_SHARED_MEMORY, os.W_OK) and shutil.disk_usage(_SHARED_MEMORY).free < _ROOM:
            raise RunFailed(
                f"{_SHARED_MEMORY} is full: the libraries of ROS 2 need {_ROOM} bytes there"
            )
    if not given.no_record and None in (find_spec("rosbags"), find_spec("sensor_msgs")):
        raise RunFailed(
            "a bag needs rosbags and the messages of ROS 2, which are not installed here: add"
            " --no-record"
        )


def _can_be_loaded() -> bool:
    """Return True if ROS 2 starts.

    Without its middleware it ends the process that tries, in words of C.
    """
    words = [
        sys.executable,
        "-c",
        "import rclpy; rclpy.utilities.get_rmw_implementation_identifier()",
    ]
    return subprocess.run(words, capture_output=True).returncode == 0


def _drive(
    run: Run, directory: Path, given: argparse.Namespace, own: Mapping[str, Sequence[str]]
) -> Outcome:
    # Opened before the run: a log that cannot be written is refused before anything is driven.
    logs = [bus.frame_log(run, directory) for bus in buses()]
    outcome = _driven(run, directory, given, own)
    notes = [log.write(outcome.recording) for log in logs if log is not None]
    return replace(outcome, notes=(*outcome.notes, *filter(None, notes)))


def _driven(
    run: Run, directory: Path, given: argparse.Namespace, own: Mapping[str, Sequence[str]]
) -> Outcome:
    with progress_bar(run.name, run.duration) as progress:
        if given.offline:
            from ev_stack.running.offline import run_offline_into

            return run_offline_into(run, directory, not given.no_record, progress)
        from ev_stack.running.processes import run_in_process, run_in_processes

        if given.in_process:
            return run_in_process(run, directory, not given.no_record, progress)
        return run_in_processes(run, directory, not given.no_record, progress, own)
