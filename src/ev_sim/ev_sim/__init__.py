"""The world around the control laws: plant, drives, tyres, roads, steering column, driver."""

_IN_EV_STACK = (
    "BatchResult",
    "ParameterError",
    "Result",
    "SignalError",
    "Simulation",
    "__version__",
    "batch",
    "run",
)


def __getattr__(name: str) -> object:
    """Give names that have moved to ev_stack, with a warning; for the release after 0.1 no more."""
    if name not in _IN_EV_STACK:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    import warnings
    from importlib import import_module

    warnings.warn(
        f"ev_sim.{name} is ev_stack.{name} now: import ev_stack", FutureWarning, stacklevel=2
    )
    return getattr(import_module("ev_stack"), name)
