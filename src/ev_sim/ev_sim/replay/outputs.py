"""What a replay prints and leaves behind."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from ev_core.parameters.declaration import flatten
from ev_msgs_py.contract.roles import ROLES
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError
from ev_sim.figures.saving import FORMATS, figure_files, save_figures
from ev_sim.recording.outcome import Outcome
from ev_sim.recording.recording import (
    LOG,
    OF_ALL_RUNS,
    PAGE,
    PARAMETERS,
    SIGNALS,
    SUMMARY,
    Recording,
    atomic_file,
    save,
)
from ev_sim.replay.comparing import (
    Difference,
    in_words,
    latencies_in_words,
    latency_of,
    latency_sheet,
    table_files,
    table_of,
)
from ev_sim.replay.graph import Replay
from ev_sim.report.summary import Summary, write_summary
from ev_sim.report.tables import TABLES
from ev_sim.running.offline import write_parameter_file
from ev_sim.running.output_folder import OutputFolder
from ev_sim.scenarios.scenario import Run

_RECORDED, _REPLAYED, _LATENCY = "recorded", "replayed", "latency"


def replay_folder(replay: Replay, out: Path) -> OutputFolder:
    """Where a replay writes; ParameterError if the folder cannot be had, or would replace what is replayed."""
    source = replay.recorded.source.resolve()
    runs = [Run(name, replay.recorded.namespace, {}, replay.duration) for name in (_RECORDED, _REPLAYED)]
    if any(source.is_relative_to((out / run.name).resolve()) for run in runs):
        raise ParameterError(f"--out {out}: the run that is replayed is there, allowed is another folder")
    logs = [f"{_REPLAYED}/{LOG}/{role}.log" for role in ROLES]
    return OutputFolder(out, "replay", [*OF_ALL_RUNS, *TABLES, *figure_files([_LATENCY], FORMATS), *logs], runs)


def prepared(replay: Replay, folder: OutputFolder) -> Run:
    """The graph that replays; the recorded signals that it plays back are in the folder then."""
    recorded = folder.directory / _RECORDED
    _write_told(recorded / PARAMETERS, replay)
    save(replay.recorded.recording, recorded / SIGNALS)
    return replay.run(recorded / SIGNALS)


def _write_told(path: Path, replay: Replay) -> None:
    """What is known of the nodes of the recorded run, so that it can be replayed once more from there."""
    given = replay.recorded.parameters
    if given is not None:
        with atomic_file(path) as file:
            file.write(given.path.read_bytes())
        return
    common = flatten(replay.configuration.common)
    nodes = {"**": {name: value for name, value in common.items() if value != ()}}
    write_parameter_file(path, Run(_RECORDED, replay.recorded.namespace, {}, replay.duration), nodes)


@dataclass(frozen=True)
class Replayed:
    """A replay that was driven; `command` are the words of the node that took part, `line` repeats it all."""

    replay: Replay
    run: Run
    outcome: Outcome
    differences: Sequence[Difference]
    command: Sequence[str]
    line: str

    @property
    def _who(self) -> str:
        return " ".join(self.command) or self.replay.configuration.method.name

    @cached_property
    def _latency(self) -> dict[str, Any]:
        return latency_of(self.replay.recorded)

    @property
    def _notes(self) -> tuple[str, ...]:
        answers = {topic.name for topic in map(TOPICS.__getitem__, self.replay.answers)}
        left_out = [TOPICS[signal].name for signal in self.replay.configuration.method.writes]
        left_out = [name for name in left_out if name not in answers]
        more = (f"not in the bag, so not compared: {', '.join(left_out)}",) if left_out else ()
        return (*self.replay.recorded.notes, *more, *self.outcome.notes)

    def lines(self) -> list[str]:
        """What the terminal shows."""
        table = table_of(self.differences)
        answers = [TOPICS[signal].name for signal in self.replay.answers]
        return [
            *([table] if table else []),
            *(f"note: {note}" for note in self._notes),
            *(latencies_in_words(self._latency, answers) if self._latency else []),
            f"{self.replay.role} {self._who}: {in_words(self.differences)}",
            f"{self.run.duration:g} s in {self.outcome.wall_time:.2f} s",
        ]

    def write(self, folder: OutputFolder, page: bool, formats: Sequence[str]) -> str:
        """Write all of it; the answer names the page if there is one."""
        runs = {_RECORDED: self._recorded(), _REPLAYED: self.outcome.recording}
        table_files(self.differences, folder.directory)
        content = self._content(runs)
        figures = {_LATENCY: latency_sheet(self._latency)} if self._latency else {}
        save_figures(figures, folder.directory, formats)
        write_summary(folder.directory / SUMMARY, content)
        if not page:
            return ""
        from ev_sim.report.page.writing import Page, Signals, images_of, write_page

        signals = Signals("", runs, self.replay.configuration.common.vehicle)
        text = "\n".join(line for line in (in_words(self.differences), table_of(self.differences)) if line)
        title = f"{self.replay.role} {self._who}, replayed"
        images = images_of(figures, folder.directory)
        write_page(Page(title, {"": content}, (signals,), images, text), folder.directory / PAGE)
        return f"{PAGE}, "

    def _recorded(self) -> Recording:
        """As much of the recorded run as was replayed."""
        recording, count = self.replay.recorded.recording, len(self.outcome.recording.time)
        return Recording(recording.time[:count], {name: row[:count] for name, row in recording.channels.items()})

    def _content(self, runs: dict[str, Recording]) -> dict[str, Any]:
        role, configuration = self.replay.role, self.replay.configuration
        summary = Summary(
            scenario=f"replay of {self.replay.recorded.source}",
            mode="replay, processes" if self.command else "replay, offline",
            seed=configuration.common.seed,
            methods={role: configuration.method.name},
            own_nodes={role: " ".join(self.command)} if self.command else {},
            parameters={role: configuration.values()},
            vehicle=configuration.common.vehicle,
            runs=runs,
            metrics={},
            wall_time=self.outcome.wall_time,
            not_reproducible=self.outcome.not_reproducible,
            notes=self._notes,
            about=f"{role} {self._who} on recorded inputs; all others say what was recorded",
            command=self.line,
            timing={_RECORDED: self._latency} if self._latency else {},
        ).as_json()
        del summary["differs"]  # from a scenario's file, which there is none of
        return {**summary, "differences": [asdict(each) for each in self.differences]}
