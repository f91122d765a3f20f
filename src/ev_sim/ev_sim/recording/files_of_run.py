"""What a command and the nodes of its runs leave in their folders, by name."""

from __future__ import annotations

BAG = "bag"
SIGNALS = "signals.npz"
PARAMETERS = "parameters.yaml"
LOG = "log"
SUMMARY, PAGE = OF_ALL_RUNS = ("summary.json", "report.html")

# A bag has two files while it grows (`durable_bag`), and keeps its name before a reset.
_OF_A_BAG = ("metadata.yaml", "metadata.yaml.tmp", f"{BAG}.mcap", f"{BAG}_[01].mcap", f"{BAG}.mcap.spare")
RECORDED = (SIGNALS, *(f"{BAG}/{name}" for name in _OF_A_BAG))
_BEFORE_RESET = tuple(f"{BAG}_before_reset_[0-9]*/{name}" for name in _OF_A_BAG)
