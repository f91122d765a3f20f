"""Drive the runs of a scenario, write what they leave behind, print the metrics."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.parameters.values import unknown_name
from ev_sim.commands.command_line import overrides, own_nodes
from ev_sim.report.metric_table import print_metrics
from ev_sim.report.real_time import in_words
from ev_sim.report.reports import report_for
from ev_sim.report.samples import Parameters
from ev_sim.report.summary import Summary, write_summary
from ev_sim.run.node_parameters import node_parameters, recorded_topics, write_parameter_file
from ev_sim.run.outcome import Outcome, Progress
from ev_sim.run.output_folder import OutputFolder
from ev_sim.run.progress_bar import progress_bar
from ev_sim.run.recording.recording import save
from ev_sim.run.scenarios.differences import differences
from ev_sim.run.scenarios.scenario import Run, Scenario, load_scenario, scenario_names
from ev_sim.study.study import STUDIES


def drive_scenario(given: argparse.Namespace) -> None:
    """Drive all runs of a scenario and report; raises what `ev_sim.commands.run_scenario.main` catches."""
    if given.scenario not in scenario_names():
        raise unknown_name("scenario or study", given.scenario, [*scenario_names(), *STUDIES])
    scenario = load_scenario(given.scenario, overrides(given))
    folder = OutputFolder(given.out or Path("results") / scenario.name, scenario.runs)
    outcomes = {run.name: _drive(run, folder.of(run), given) for run in scenario.runs}
    summary = _summary(scenario, outcomes, given)
    from ev_sim.report.figures.drawing import save_figures

    figures = report_for(scenario.name).figures(summary.runs, summary.vehicle, _parameters_by_role(scenario))
    if summary.timing:
        from ev_sim.report.figures.timing import timing_sheet

        figures = {**figures, "timing": timing_sheet(summary.timing)}
    save_figures(figures, folder.directory)
    content = summary.as_json()
    write_summary(folder.directory / "summary.json", content)
    if not given.no_report:
        from ev_sim.report.page.images import images_of
        from ev_sim.report.page.writing import NAME, Page, Signals, write_page

        signals = Signals("", summary.runs, summary.vehicle)
        shown = Page(scenario.name, {"": content}, (signals,), images_of(figures, folder.directory))
        write_page(shown, folder.directory / NAME)
    print_metrics(summary.metrics)
    for note in summary.notes:
        print(f"note: {note}")
    for reason in summary.not_reproducible:
        print(f"not reproducible: {reason}")
    for timing in summary.timing.values():
        print(in_words(timing))
    print(f"signal hash {content['signal_hash']}")
    print(f"{summary.simulated_time:g} s in {summary.wall_time:.2f} s, {content['real_time_factor']:.1f} x real time")
    page = "" if given.no_report else "report.html, "
    print(f"{page}figures, signals and summary: {folder.directory}")


def _drive(run: Run, directory: Path, given: argparse.Namespace) -> Outcome:
    with progress_bar(run.name, run.duration) as progress:
        if given.offline:
            return _drive_offline(run, directory, not given.no_record, progress)
        if given.in_process:
            from ev_sim.run.in_process import run_in_process

            return run_in_process(run, directory, not given.no_record, progress)
        from ev_sim.run.processes import run_in_processes

        return run_in_processes(run, directory, not given.no_record, progress, own_nodes(given))


def _drive_offline(run: Run, directory: Path, bag: bool, progress: Progress) -> Outcome:
    from ev_sim.run.offline import load_compiled, run_offline

    write_parameter_file(directory / "parameters.yaml", run, node_parameters(run, directory, bag))
    load_compiled(run.configurations)  # before the clock starts
    start = time.monotonic()
    notes: list[str] = []
    recording = run_offline(
        run.configurations, run.duration, progress, lambda role, text: notes.append(f"{run.namespace}/{role}: {text}")
    )
    wall_time = time.monotonic() - start
    save(recording, directory / "signals.npz")
    if bag:
        from ev_sim.run.recording.run_recorder import write_bag

        topics = recorded_topics(run)
        names = [f"{run.namespace}/{topic.name}" for topic in topics]
        write_bag(recording, topics, names, run.period, directory / "bag")
    return Outcome(recording, wall_time, notes=tuple(notes))


def _parameters_by_role(scenario: Scenario) -> Parameters:
    return {role: configuration.values() for role, configuration in scenario.runs[0].configurations.items()}


def _summary(scenario: Scenario, outcomes: dict[str, Outcome], given: argparse.Namespace) -> Summary:
    runs = {name: outcome.recording for name, outcome in outcomes.items()}
    nodes = {
        role if len(scenario.runs) == 1 else f"{run.name}/{role}": configuration
        for run in scenario.runs
        for role, configuration in run.configurations.items()
    }
    first = scenario.runs[0].configurations
    vehicle = first[MASTER].common.vehicle
    way = "offline" if given.offline else "in-process" if given.in_process else "processes"
    return Summary(
        scenario=scenario.name,
        mode=f"{way}, realtime" if given.realtime else way,
        seed=first[MASTER].common.seed,
        methods={node: configuration.method.name for node, configuration in nodes.items()},
        own_nodes={role: " ".join(words) for role, words in own_nodes(given).items()},
        parameters={node: configuration.values() for node, configuration in nodes.items()},
        vehicle=vehicle,
        runs=runs,
        metrics=report_for(scenario.name).metrics(runs, vehicle, _parameters_by_role(scenario)),
        wall_time=sum(outcome.wall_time for outcome in outcomes.values()),
        not_reproducible=tuple(reason for outcome in outcomes.values() for reason in outcome.not_reproducible),
        timing={name: outcome.timing for name, outcome in outcomes.items() if outcome.timing},
        notes=tuple(note for outcome in outcomes.values() for note in outcome.notes),
        about=scenario.parameters.about,
        command=given.command,
        differs=differences(scenario, load_scenario(given.scenario)),
    )
