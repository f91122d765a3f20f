"""What a command and the nodes of its runs leave in their folders, by name."""

from __future__ import annotations

import glob
from collections.abc import Iterable
from typing import TYPE_CHECKING

from ev_msgs_py.contract.roles import RECORDER

if TYPE_CHECKING:
    from ev_sim.running.scenarios.scenario import Run

BAG = "bag"
SIGNALS = "signals.npz"
PARAMETERS = "parameters.yaml"
LOG = "log"
SUMMARY, PAGE = OF_ALL_RUNS = ("summary.json", "report.html")

# A bag has two files while it grows (`durable_bag`), and keeps its name before a reset.
_OF_A_BAG = ("metadata.yaml", "metadata.yaml.tmp", f"{BAG}.mcap", f"{BAG}_[01].mcap", f"{BAG}.mcap.spare")
RECORDED = (SIGNALS, *(f"{BAG}/{name}" for name in _OF_A_BAG))
_BEFORE_RESET = tuple(f"{BAG}_before_reset_[0-9]*/{name}" for name in _OF_A_BAG)


def files_of_run(run: Run) -> Iterable[str]:
    """Patterns of all files that can be there when a run has ended, however it has."""
    yield from (PARAMETERS, *RECORDED, *_BEFORE_RESET)
    yield from (f"{LOG}/{glob.escape(name)}.log" for name in (*run.configurations, RECORDER))
    gateway = run.configurations.get("inverter_gateway")
    if gateway and gateway.parameters.bus.log:
        yield glob.escape(gateway.parameters.bus.log)
