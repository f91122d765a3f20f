"""Report on the urban cycle on the test bench: that of the cycle, and channels and energies of the bench."""

from __future__ import annotations

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.figures.figure import Figure
from ev_sim.report.figures.test_bench import bench_channels
from ev_sim.report.metric import Metric, metric
from ev_sim.report.quantities import can_bus, motion, test_bench
from ev_sim.report.samples import Parameters, Runs
from ev_sim.report.scenarios import urban_mixed
from ev_sim.running.recording.recording import Recording


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Those of the cycle with eq 2.38 from measured values, and the accounts of the bench."""
    return {
        **urban_mixed.metrics(runs, vehicle, parameters),
        **motion.of_each_run(runs, _metrics),
    }


def _metrics(run: Recording) -> dict[str, Metric]:
    names = ("battery", "mains", "resistor", "machines", "loads", "shafts")
    return {
        **{f"bench_{name}": metric(lambda name=name: test_bench.energies(run)[name], "J") for name in names},
        "bench_imbalance": metric(lambda: test_bench.imbalance(run), "1"),
        **can_bus.metrics(run),
    }


def figures(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Figure]:
    """Those of the cycle; torques, speeds, temperatures and energies of the bench."""
    run = next(iter(runs.values()))
    driver = parameters.get("driver", {})
    return {**urban_mixed.figures(runs, vehicle, parameters), "bench": bench_channels(run, vehicle, driver)}
