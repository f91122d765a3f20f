"""The studies `compare` and `sweep` from Python, with what their commands drive.

How it works: the arguments become the words of the command line, which a study reads. So both have
one meaning, one hash and one store of rows: what a command has driven is not driven again here.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from os import fspath
from typing import TYPE_CHECKING, Any, Unpack

from ev_core.parameters.values import plain
from ev_msgs_py.arguments import checked
from ev_msgs_py.refusal import Named, ParameterError
from ev_stack.command_line.options import command_of
from ev_stack.figures.overlays import as_one
from ev_stack.figures.sheets import WIDE, Figure, drawn
from ev_stack.interface.changes import Changes, Name
from ev_stack.measures.metric import Metric
from ev_stack.recording.data_frame import data_frame
from ev_stack.report.tables import Table, html_of
from ev_study.studies.run_study import SummedUp, drive_study, hash_of
from ev_study.studies.study import Results

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True, repr=False)
class StudyResult:
    """Rows of a study, one for each of its runs, and what it makes of them.

    `rows` has the result of each run by its name: its metrics, hash and notes, or in `refused` why
    it could not be driven. `command` is the line that does the same and writes a folder. A notebook
    shows table and figures.
    """

    rows: Results
    found: SummedUp
    command: str

    @property
    def table(self) -> Table:
        """The table of the study, with the units in its columns."""
        assert self.found.table is not None
        return self.found.table

    @property
    def metrics(self) -> Mapping[str, Metric]:
        """Numbers of all runs together, by name."""
        return Named("metric", self.found.metrics)

    @property
    def hash(self) -> str:
        """That of all signals of all runs, as the command prints it."""
        return hash_of(self.rows.values())

    def data_frame(self) -> DataFrame:
        """The table as one of pandas, with units in the names of its columns."""
        columns = zip(*self.table.rows, strict=True)
        return data_frame(dict(zip(self.table.columns, columns, strict=True)), {})

    @checked
    def figures(self, width: float = WIDE) -> dict[str, Figure]:
        """New figures [inch wide] of matplotlib by name."""
        return drawn(self.found.sheets, width)

    @checked
    def plot(self, panels: Sequence[str] = (), width: float = WIDE) -> Figure:
        """Draw the figures as one, all laws over each other; a notebook shows it.

        `panels` are patterns of NAME, PANEL or NAME.PANEL, such as yaw_rate. ParameterError for one
        that fits none, and for a sweep without a figure.
        """
        if not self.found.sheets:
            raise ParameterError(
                "this study has no figure, expected a sweep of one or two parameters over numbers"
            )
        return as_one(self.found.sheets, panels).figure(width)

    def __repr__(self) -> str:
        refused = [f"{row.name}: {row.refused}" for row in self.rows.values() if row.refused]
        return "\n".join(filter(None, (self.found.text, *refused)))

    def _repr_html_(self) -> str:
        return html_of(f"{self!r}\nsignal hash {self.hash}", self.figures())


@checked
def compare(
    scenario: Name = "double_lane_change",
    methods: Sequence[Name] = (),
    run: str = "",
    metrics: Sequence[str] = (),
    workers: int | None = None,
    **changes: Unpack[Changes],
) -> StudyResult:
    """Drive electronic differentials on one car in a scenario, and set them side by side.

    `methods` are names or law files, my_law.py or my_law.py:NAME; all that are registered without
    any. `run` names one of several runs of the scenario. `metrics` are the columns of the table
    (docs/metrics.md). There are as many worker processes as cores without `workers`. What differs
    from the scenario's file is given as to `ev_stack.run`.

    ParameterError, in one line, if something is refused.

    >>> from ev_study import compare
    >>> laws = compare("shchur2019", ["equal_torque", "power_steering"], duration=0.2)
    >>> list(laws.rows)
    ['equal_torque', 'power_steering']
    >>> [axes.get_title(loc="left") for axes in laws.plot(panels=["speed", "yaw_rate"]).axes]
    ['Yaw rate', 'Speed']
    """
    words = [f"--scenario={fspath(scenario)}"]
    if methods:
        words.append(f"--methods={','.join(map(fspath, methods))}")
    return _result("compare", [*words, *_words(run, metrics, workers, changes)])


@checked
def sweep(
    scenario: Name = "double_lane_change",
    vary: Mapping[str, Iterable[Any]] | None = None,
    seeds: int = 1,
    run: str = "",
    metrics: Sequence[str] = (),
    workers: int | None = None,
    **changes: Unpack[Changes],
) -> StudyResult:
    """Drive a scenario with every value of `vary` beside every other, and with several seeds.

    `vary` has values by NODE.PARAMETER; of NODE.method they are names or law files. The seeds are 0
    to `seeds` - 1. `metrics` are the columns of the table, those of the scenario's report without
    any. The other arguments are those of `compare`.

    ParameterError, in one line, if something is refused.

    >>> from ev_study import sweep
    >>> speeds = {"plant.initial_speed": [2.0, 4.0]}
    >>> found = sweep("shchur2019", speeds, metrics=["final_speed"], duration=0.2)
    >>> found.table.columns
    ['plant.initial_speed', 'final_speed [m/s]']
    >>> len(found.table.rows)
    2
    """
    words = [f"--seeds={seeds}"]
    for place, values in (vary or {}).items():
        # With a comma behind each: a single text with colons would be the ends of a span.
        texts = "".join(f"{_as_yaml(value)}, " for value in values)
        words.append(f"--vary={place}={texts}")
    words += _words(run, metrics, workers, changes)
    # Behind all options, where a name that begins with a dash is none.
    return _result("sweep", [*words, "--", fspath(scenario)])


def _result(name: str, words: Sequence[str]) -> StudyResult:
    rows, found = drive_study(name, words)
    return StudyResult(rows, found, command_of([name, *words]))


def _words(run: str, metrics: Sequence[str], workers: int | None, changes: Changes) -> list[str]:
    """The options of both studies, as a command line has them."""
    words = []
    for node, method in (changes.get("method") or {}).items():
        words.append(f"--method={node}={fspath(method)}")
    for place, value in (changes.get("set") or {}).items():
        words.append(f"--set={place}={_as_yaml(value)}")
    words += [f"--params={fspath(path)}" for path in changes.get("params") or ()]
    alone = {"run": run or None, "metrics": ",".join(metrics) or None, "workers": workers}
    alone |= {name: changes.get(name) for name in ("seed", "duration", "vehicle", "cycle")}
    return words + [f"--{name}={value}" for name, value in alone.items() if value is not None]


def _as_yaml(value: Any) -> str:
    """A value as a parameter file has it: JSON is YAML."""
    return json.dumps(plain(value), default=str, ensure_ascii=False)
