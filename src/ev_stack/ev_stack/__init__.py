"""What a user starts; from Python `run`, `Simulation` and `batch` (docs/python.md)."""

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
    """What takes long to import is imported when it is asked for."""
    if name == "__version__":
        from importlib.metadata import version

        return version(__name__)
    if name in _MODULES:
        from importlib import import_module

        return getattr(import_module(_MODULES[name]), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """What is there, whether it has been imported yet or not."""
    return sorted({*globals(), *_MODULES, "__version__"})
