"""Result of driving a scenario, to look at from Python and to write into a folder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ev_core.parameters.data_file import TIME, files_in_config
from ev_msgs_py.arguments import checked
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import Named, ParameterError, quoted
from ev_nodes.master.real_time import MasterParameters
from ev_stack.figures.other_axes import timing_sheet
from ev_stack.figures.overlays import as_one, overlaid
from ev_stack.figures.panels import MOTION, motion_panels, signal_panels
from ev_stack.figures.saving import Format, Print, save_figures
from ev_stack.figures.sheets import COLUMN, WIDE, Figure, Sheet, Sheets, drawn, panel_name
from ev_stack.figures.strokes import PART
from ev_stack.measures.metric import Metric, Runs
from ev_stack.recording.data_frame import data_frame
from ev_stack.recording.offline import true_motion
from ev_stack.recording.outcome import Outcome
from ev_stack.recording.recording import (
    PAGE,
    SIGNALS,
    SUMMARY,
    Recording,
    combined_hash,
    save,
    signal_hash,
)
from ev_stack.report.reports import figures_of_runs, metrics_of_runs
from ev_stack.report.summary import COMMAND_LINE, Difference, Summary, differences, write_summary
from ev_stack.report.tables import html_of, metric_table, short_lines
from ev_stack.running.output_folder import folder_of, output_folder
from ev_stack.scenarios.names import names_of
from ev_stack.scenarios.records import Scenario
from ev_stack.scenarios.scenario import load_scenario

if TYPE_CHECKING:
    from pandas import DataFrame

_TIMES = {each.name for each in fields(MasterParameters)} - {"duration"}
# the sources have no seeds
_HOW_IT_IS_RUN = {"mode", "seed", "scheduling_priority", "lock_memory", *_TIMES}


@dataclass(frozen=True, repr=False)
class Result:
    """The runs of a scenario that were driven, and how: offline, in-process, processes or realtime.

    `own_nodes`: role -> command of a user's node that took its place. `command` is the line that
    does the same again. A notebook shows its metrics and figures.
    """

    scenario: Scenario
    outcomes: Mapping[str, Outcome]
    mode: str = "offline"
    own_nodes: Mapping[str, str] = field(default_factory=dict)
    command: str = ""

    @property
    def runs(self) -> Runs:
        """The signals of each run by its name."""
        runs = {name: outcome.recording for name, outcome in self.outcomes.items()}
        return Named("run", runs)

    @cached_property
    def truth(self) -> Runs:
        """True motion of each run by its name; metrics and figures rest on it."""
        known = {run.name: run.configurations for run in self.scenario.runs}
        return {name: true_motion(run, known[name]) for name, run in self.runs.items()}

    @property
    def time(self) -> np.ndarray:
        """The instants of the only run [s], (n,); ParameterError if there are several."""
        return self._only.time

    @property
    def signals(self) -> Mapping[str, np.ndarray]:
        """Samples of the only run by channel, such as imu.yaw_rate, (n,).

        Raises ParameterError if there are several runs.
        """
        return Named("channel", self._only.channels)

    @property
    def hash(self) -> str:
        """That of all signals of all runs: the same wherever and however they are driven."""
        return combined_hash({name: signal_hash(run) for name, run in self.runs.items()})

    @property
    def _only(self) -> Recording:
        if len(self.outcomes) > 1:
            raise ParameterError(
                f"{self.scenario.name} has several runs: runs[NAME] of {', '.join(self.outcomes)}"
            )
        return next(iter(self.runs.values()))

    @cached_property
    def metrics(self) -> Mapping[str, Metric]:
        """Numbers with units, and verdicts where something was published, by name."""
        found = metrics_of_runs(self.truth, self.scenario.runs)
        changed = dict.fromkeys(self._other_than_the_source)
        why = (
            f"{', '.join(changed)} differ{'s' * (len(changed) == 1)} from the source's"
            if changed
            else ""
        )
        judged = {n: replace(each, unjudged=each.unjudged or why) for n, each in found.items()}
        return Named("metric", judged)

    @property
    def _other_than_the_source(self) -> list[str]:
        """Parameters that differ from those with which the scenario reproduces its source.

        The speed at which it is run does not count.
        """
        # The file of the scenario that has the report, which may be another than the driven one.
        source = files_in_config("scenarios").get(self._report)
        # A file of one's own may have the report of a source and other numbers.
        own_file = (
            [f"scenario {self.scenario.file}"]
            if source and not source.samefile(self.scenario.file)
            else []
        )
        changed = [
            d for d in self.differs if d.by == COMMAND_LINE and d.parameter not in _HOW_IT_IS_RUN
        ]
        return [
            *own_file,
            *(f"{d.node}.{d.parameter}" for d in changed),
            *(f"node {role}" for role in self.own_nodes),
        ]

    @property
    def _report(self) -> str:
        return self.scenario.parameters.report or self.scenario.name

    @cached_property
    def differs(self) -> Sequence[Difference]:
        """Parameters that differ from the scenario's file, or from the defaults."""
        runs = [run.name for run in self.scenario.runs]
        # Resolved once more without the command line; nothing is driven.
        return differences(self.scenario, load_scenario(str(self.scenario.file), only=runs))

    @cached_property
    def sheets(self) -> dict[str, Sheet]:
        """Figures as data, by name."""
        timing = {"timing": timing_sheet(self._timing)} if self._timing else {}
        return {**figures_of_runs(self.truth, self.scenario.runs), **timing}

    @checked
    def figures(self, width: float = WIDE) -> dict[str, Figure]:
        """New figures [inch wide] of matplotlib by name."""
        return drawn(self.sheets, width)

    @checked
    def plot(
        self,
        *others: Result,
        signals: Sequence[str] = (),
        panels: Sequence[str] = (),
        names: Sequence[str] = (),
        width: float = WIDE,
    ) -> Figure:
        """Draw the figures of the report as one, or what is chosen; `others` lie over it.

        `signals` are channels such as imu.yaw_rate; `panels` are patterns as those of `save`, or
        yaw_rate, lateral_acceleration, sideslip_angle, speed, steering_wheel_angle and
        road_wheel_angle of any run. `names` are those of the results in the legend, without them
        what differs between the results. A notebook shows the figure, which is one of matplotlib.

        ParameterError for a panel or a channel that there is not.

        >>> import ev_stack
        >>> slow = ev_stack.run("shchur2019", duration=0.1)
        >>> fast = ev_stack.run("shchur2019", set={"plant.initial_speed": 2.0}, duration=0.1)
        >>> figure = slow.plot(fast, panels=["speed", "yaw_rate"])
        >>> [axes.get_title(loc="left") for axes in figure.axes]
        ['Speed', 'Yaw rate']
        """
        results = (self, *others)
        called = names or names_of([each.scenario.runs[0].configurations for each in results])
        if len(called) != len(results) or len(set(called)) != len(called):
            raise ParameterError(
                f"names: {quoted(names)} is refused, expected {len(results)} different names"
            )
        of_all = dict(zip(called, results, strict=True))
        shown = []
        if panels or not signals:
            sheets = {name: each._offered(not panels) for name, each in of_all.items()}
            shown += as_one(overlaid(sheets) if others else sheets[called[0]], panels).panels
        runs = {}
        for name, each in of_all.items():
            for of, recording in each.runs.items():
                several = f"{name}{PART}{of}" if others else of
                runs[several if len(each.runs) > 1 else name] = recording
        shown += signal_panels(runs, signals)
        return Sheet(shown).figure(width)

    def _offered(self, only_report: bool) -> Sheets:
        """Figures of the report, and quantities of the motion that are none of its panels."""
        if only_report:
            return self.sheets
        there = {panel_name(panel) for sheet in self.sheets.values() for panel in sheet.panels}
        further = motion_panels(self.truth, *(name for name in MOTION if name not in there))
        return {**self.sheets, "motion": Sheet(further)}

    @property
    def _timing(self) -> dict[str, Mapping[str, Any]]:
        return {name: outcome.timing for name, outcome in self.outcomes.items() if outcome.timing}

    @checked
    def data_frame(self, run: str = "") -> DataFrame:
        """Signals of a run over time [s] as a table of pandas.

        The name may be left out of a single run.

        `attrs["units"]` has the unit of each column and of the index by name.
        """
        recording = self.runs[run] if run else self._only
        known = frame.units()
        units = {TIME: "s", **{name: known[name] for name in recording.channels}}
        return data_frame({TIME: recording.time, **recording.channels}, units, TIME)

    def summary(self) -> Summary:
        """The content of summary.json."""
        runs = self.scenario.runs
        nodes = {
            role if len(runs) == 1 else f"{run.name}/{role}": configuration
            for run in runs
            for role, configuration in run.configurations.items()
        }
        common = runs[0].configurations[MASTER].common
        outcomes = self.outcomes.values()
        return Summary(
            scenario=self.scenario.name,
            mode=self.mode,
            seed=common.seed,
            methods={node: configuration.method.name for node, configuration in nodes.items()},
            own_nodes=self.own_nodes,
            parameters={node: configuration.values() for node, configuration in nodes.items()},
            vehicle=common.vehicle,
            runs=self.runs,
            metrics=self.metrics,
            wall_time=sum(outcome.wall_time for outcome in outcomes),
            not_reproducible=tuple(
                reason for outcome in outcomes for reason in outcome.not_reproducible
            ),
            notes=(*self.scenario.notes, *(note for outcome in outcomes for note in outcome.notes)),
            timing=self._timing,
            about=self.scenario.parameters.about,
            command=self.command,
            differs=self.differs,
            # The folders of a path are those of one machine.
            car=Path(self.scenario.vehicle).name,
            curves=self.scenario.parameters.curves,
        )

    @checked
    def save(
        self,
        directory: Path | str | None = None,
        formats: Sequence[Format] = (),
        width: float = COLUMN,
        panels: Sequence[str] = (),
    ) -> Path:
        """Write report.html, summary.json, figures and signals.npz; return the folder.

        It is a new one, results/NAME/TIME, or `directory`, which must be new or empty:
        ParameterError otherwise. Signals of several runs are in folders of their names. `formats`:
        pdf or svg, for figures that are also wanted for print, then `width` [inch], and `panels` by
        patterns of NAME, PANEL or NAME.PANEL.
        """
        # Before the folder is made: a figure that fails leaves none behind.
        figures, runs = self.figures(), self.scenario.runs
        prints = Print(tuple(formats), width, tuple(panels)).drawn(self.sheets)
        given = None if directory is None else Path(directory)
        with output_folder(given, self.scenario.name) as folder:
            for run in runs:
                save(self.runs[run.name], folder_of(run, runs, folder) / SIGNALS)
            self.write_report(folder, figures)
            save_figures(prints, folder, formats)
        return folder

    @checked
    def write_report(
        self, folder: Path, figures: Mapping[str, Figure], page: bool = True
    ) -> dict[str, Any]:
        """Write figures, report.html if it is wanted, and summary.json.

        Return the content of the last.
        """
        summary = self.summary()
        # The page takes the figures from their files.
        save_figures(figures, folder)
        content = summary.as_json()
        write_summary(folder / SUMMARY, content)
        if page:
            from ev_stack.report.page.writing import Page, Signals, images_of, write_page

            signals = Signals("", self.runs, summary.vehicle, curves=summary.curves)
            shown = Page(self.scenario.name, {"": content}, (signals,), images_of(figures, folder))
            write_page(shown, folder / PAGE)
        return content

    def __repr__(self) -> str:
        head = f"Result of {self.scenario.name}, {self.mode}, signal hash {self.hash[:12]}"
        return "\n  ".join([head, *short_lines(self.metrics)])

    def _repr_html_(self) -> str:
        text = f"{metric_table(self.metrics)}\nsignal hash {self.hash}"
        return html_of(text, self.figures())
