"""What a test bench shows of its energies."""

from __future__ import annotations

from ev_msgs_py.contract.bench_signals import BenchEnergy
from ev_sim.report.samples import channel
from ev_sim.running.recording.recording import Recording

_GONE = ("resistor", "machines", "loads", "shafts", "stored")


def energies(run: Recording) -> dict[str, float]:
    """What each account of the bench holds at the end [J]; NotMeasured without a bench."""
    return {name: float(channel(run, f"bench.energy.{name}")[-1]) for name in BenchEnergy._fields}


def imbalance(run: Recording) -> float:
    """What is missing in battery + mains = resistor + heat + stored, over what was given [1]."""
    of = energies(run)
    given = of["battery"] + of["mains"]
    return (given - sum(of[name] for name in _GONE)) / max(abs(given), 1.0)
