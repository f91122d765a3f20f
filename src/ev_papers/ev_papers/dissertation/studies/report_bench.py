"""Report on the urban cycle on the test bench, with channels and energies of the bench."""

from __future__ import annotations

from ev_core.vehicle.description import Vehicle
from ev_papers.dissertation.figures.urban_sheets import bench_channels
from ev_papers.dissertation.measures import motors_and_cells
from ev_papers.dissertation.studies import report
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.metric import Metric, Parameters, Runs, metric
from ev_stack.measures.named import DrivenRun
from ev_stack.measures.registry import metrics_of_others
from ev_stack.recording.recording import Recording


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Metrics of the cycle with eq 2.38 from measured values, and the accounts of the bench."""
    return {
        **report.metrics(runs, vehicle, parameters),
        **motion.of_each_run(runs, lambda run: _metrics(run, vehicle)),
    }


def _metrics(run: Recording, vehicle: Vehicle) -> dict[str, Metric]:
    found = {}
    for name in ("battery", "mains", "resistor", "machines", "loads", "shafts"):
        found[f"bench_{name}"] = metric(
            lambda name=name: motors_and_cells.energies(run)[name], "J", f"energy of the {name}"
        )
    found["bench_imbalance"] = metric(
        lambda: motors_and_cells.imbalance(run), "1", "what the accounts do not close by"
    )
    return found | metrics_of_others(DrivenRun(run, vehicle))


def figures(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Sheet]:
    """Figures of the cycle; torques, speeds, temperatures and energies of the bench."""
    run = next(iter(runs.values()))
    driver = parameters.get("driver", {})
    return {
        **report.figures(runs, vehicle, parameters),
        "bench": bench_channels(run, vehicle, driver),
    }
