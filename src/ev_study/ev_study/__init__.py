"""Many runs: studies, verdicts, benchmark and tuning, cars held against measurement, replay, analysis.

From Python: `ev_study.compare` and `ev_study.sweep` (docs/python.md).
"""

__all__ = ["StudyResult", "compare", "sweep"]  # their types are in __init__.pyi


def __getattr__(name: str) -> object:
    """Import names that take long to import when they are first used."""
    if name in __all__:
        from importlib import import_module

        return getattr(import_module("ev_study.called"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    """List all names, imported yet or not."""
    return sorted({*globals(), *__all__})
