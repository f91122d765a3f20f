"""The types of what `__init__.py` imports when it is asked for."""

from ev_study.called import StudyResult, compare, sweep

__all__ = ["StudyResult", "compare", "sweep"]
