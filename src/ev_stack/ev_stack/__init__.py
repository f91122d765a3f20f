"""Runs from Python and from the shell: `run`, `Simulation` and `batch` (docs/python.md)."""

_MODULES = {
    "BatchResult": "ev_stack.batches.batch",
    "ParameterError": "ev_msgs_py.refusal",
    "Result": "ev_stack.report.result",
    "SignalError": "ev_msgs_py.contract.fields",
    "Simulation": "ev_stack.interface.simulation",
    "batch": "ev_stack.interface.driving",
    "run": "ev_stack.interface.driving",
}

__all__ = [*_MODULES]  # their types are in __init__.pyi


def __getattr__(name: str) -> object:
    """Import names that take long to import when they are first used."""
    if name == "__version__":
        from importlib.metadata import version

        return version(__name__)
    if name in _MODULES:
        from importlib import import_module

        return getattr(import_module(_MODULES[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """List all names, imported yet or not."""
    return sorted({*globals(), *_MODULES, "__version__"})
