"""Runs of scenarios without ROS: the same objects, the same order, the same numbers, in one process."""

from __future__ import annotations

import time
from pathlib import Path

from ev_sim.recording.files_of_run import BAG, PARAMETERS, SIGNALS
from ev_sim.recording.offline import load_compiled, run_offline
from ev_sim.recording.outcome import Outcome, Progress
from ev_sim.recording.recording import save
from ev_sim.running.node_parameters import node_parameters, recorded_topics, write_parameter_file
from ev_sim.scenarios.scenario import Run


def drive_offline(run: Run, progress: Progress = lambda time: None) -> Outcome:
    """Drive one run of a scenario; raises what `run_offline` does. To compile does not count as driving."""
    load_compiled(run.configurations)
    start = time.monotonic()
    notes: list[str] = []
    recording = run_offline(
        run.configurations, run.duration, progress, lambda role, text: notes.append(f"{run.namespace}/{role}: {text}")
    )
    return Outcome(recording, time.monotonic() - start, notes=tuple(notes))


def run_offline_into(run: Run, directory: Path, bag: bool, progress: Progress) -> Outcome:
    """Drive one run and leave in `directory` what its nodes would: parameters, signals, and a bag if it is wanted."""
    write_parameter_file(directory / PARAMETERS, run, node_parameters(run, directory, bag))
    outcome = drive_offline(run, progress)
    save(outcome.recording, directory / SIGNALS)
    if bag:
        from ev_sim.recording.run_recorder import write_bag  # a run without a bag needs no ROS

        topics = recorded_topics(run)
        names = [f"{run.namespace}/{topic.name}" for topic in topics]
        write_bag(outcome.recording, topics, names, run.period, directory / BAG)
    return outcome
