"""The numbers of docs/shchur2019.md, from runs of the scenarios with each drive model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from documentation.closed_form import overshoot, settling_time
from documentation.markdown import code, table
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.roles import MASTER
from ev_papers.shchur2019 import paper
from ev_sim.drives.drive import DRIVE_MODELS
from ev_stack.measures.metric import Metric, Parameters, Runs
from ev_stack.recording.offline import run_offline
from ev_stack.report.reports import report_for
from ev_stack.scenarios.records import Overrides, Scenario
from ev_stack.scenarios.scenario import load_scenario

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCENARIOS = ("shchur2019_steps", "shchur2019")
CONTROL_PERIODS = (0.001, 0.005, 0.01, 0.02)  # [s]
FIGURES = {"shchur2019_steps": "shchur2019_fig1.png", "shchur2019": "shchur2019_fig4.png"}


@dataclass(frozen=True)
class Driven:
    """A scenario that was driven to its end."""

    scenario: Scenario
    runs: Runs

    @property
    def metrics(self) -> dict[str, Metric]:
        """The numbers that it yields."""
        return report_for(self.scenario.name).metrics(
            self.runs, self._vehicle, self._parameters, self.scenario.parameters.course
        )

    @property
    def figures(self) -> dict[str, Figure]:
        """What it draws, by name."""
        return report_for(self.scenario.name).figures(
            self.runs, self._vehicle, self._parameters, self.scenario.parameters.course
        )

    @property
    def _vehicle(self) -> Vehicle:
        return self.scenario.runs[0].configurations[MASTER].common.vehicle

    @property
    def _parameters(self) -> Parameters:
        return {
            role: configuration.values()
            for role, configuration in self.scenario.runs[0].configurations.items()
        }


def drive(scenario: str, values: Sequence[tuple[str, str, object]] = ()) -> Driven:
    """Run a scenario offline with some parameters (node, name, value) changed."""
    loaded = load_scenario(scenario, Overrides(values=values))
    return Driven(
        loaded, {run.name: run_offline(run.configurations, run.duration) for run in loaded.runs}
    )


def drive_all() -> dict[str, dict[str, Driven]]:
    """Every scenario of the paper with every drive model: scenario -> drive model -> run."""
    return {
        scenario: {model: drive(scenario, [(MASTER, "drive", model)]) for model in DRIVE_MODELS}
        for scenario in SCENARIOS
    }


def control_period_table() -> str:
    """Overshoot and settling time of the closed loop of eq 7, continuous and sampled."""
    rows = [
        (
            "eq 7, continuous",
            f"{overshoot(paper.CLOSED_LOOP):.2f}",
            f"{settling_time(paper.CLOSED_LOOP, 0.05):.3f}",
            "",
        )
    ]
    for period in CONTROL_PERIODS:
        metrics = drive("shchur2019_steps", [("*", "control_period", period)]).metrics
        peak, settling = (metrics[f"shchur.fig1a.2.{name}"] for name in ("overshoot", "settling"))
        missed = [each for each in (peak, settling) if each.judgement != "reproduced"]
        verdict = missed[0].judgement if missed else peak.judgement
        rows.append((f"{1e3 * period:g}", f"{peak.value:.2f}", f"{settling.value:.3f}", verdict))
    return table(("control period [ms]", "overshoot [%]", "5 % settling time [s]", "verdict"), rows)


def result_table(driven: Mapping[str, Mapping[str, Driven]]) -> str:
    """Paper and runs side by side; a number outside of its band is bold."""
    rows = []
    for scenario, by_model in driven.items():
        metrics = {model: run.metrics for model, run in by_model.items()}
        for name, first in metrics[DRIVE_MODELS[0]].items():
            cells = [_cell(metrics[model][name]) for model in DRIVE_MODELS]
            reference = first.reference
            printed = "" if reference is None else f"{reference.value:.5g}"
            rows.append((code(scenario), code(name), first.unit, printed, *cells, first.judgement))
    return table(
        (
            "scenario",
            "metric",
            "unit",
            "paper",
            *(f"{model} drives" for model in DRIVE_MODELS),
            "verdict",
        ),
        rows,
    )


def _cell(metric: Metric) -> str:
    if metric.value is None:
        return metric.judgement
    text = f"{metric.value:.5g}"
    return f"**{text}**" if metric.judgement == "not reproduced" else text


def save_images(driven: Mapping[str, Mapping[str, Driven]], folder: Path) -> None:
    """The figures of the runs with ideal drives, under the names that the pages use."""
    from documentation.images import save_small

    for scenario, file in FIGURES.items():
        figures = driven[scenario][DRIVE_MODELS[0]].figures
        save_small({Path(file).stem: next(iter(figures.values()))}, folder)
