"""The world around the control laws; from Python `run`, `Simulation` and `batch` (docs/python.md)."""

from importlib import import_module
from typing import Any

__all__ = ["Simulation", "batch", "run"]

_MODULES = {
    "Simulation": "ev_sim.interface.simulation",
    "batch": "ev_sim.interface.driving",
    "run": "ev_sim.interface.driving",
}


def __getattr__(name: str) -> Any:
    """What takes long to import is imported when it is asked for."""
    if name in _MODULES:
        return getattr(import_module(_MODULES[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
