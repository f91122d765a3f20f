"""The world around the control laws; from Python `run`, `Simulation` and `batch` (docs/python.md)."""

from importlib import import_module
from typing import Any

from ev_sim import batch, run

__all__ = ["Simulation", "batch", "run"]


def __getattr__(name: str) -> Any:
    """What takes long to import is imported when it is asked for."""
    if name == "Simulation":
        return import_module("ev_sim.interface.simulation").Simulation
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
