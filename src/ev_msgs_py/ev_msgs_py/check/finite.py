"""Finite: numbers, or a refusal; NaN neither leaves a method nor stays in it."""

from __future__ import annotations

import numpy as np

from ev_msgs_py.check.inputs import ExtremeInputs
from ev_msgs_py.check.stepping import Subject, stepped
from ev_msgs_py.contract.shape import SignalError
from ev_msgs_py.lockstep.part import Part


def not_finite(subject: Subject, seed: int) -> str:
    """What goes wrong with plausible inputs; empty if every step gives finite numbers."""
    part = subject.part()
    for step, here in enumerate(subject.frames(seed)):
        try:
            stepped(part, here)
        except Exception as error:  # whatever a stranger's law raises is a finding
            return f"plausible inputs, step {step}: {_said(error)}"
    return "plausible inputs leave NaN in the state" if _holds_nan(part) else ""


def not_refused(subject: Subject, seed: int) -> str:
    """What goes wrong with absurd inputs, up to the largest floats; empty if each step is finite or refused.

    What is refused ends a run, so the next step is that of a new object, which has not seen them.
    """
    extreme = Subject(subject.configuration, subject.compiled, subject.steps, ExtremeInputs)
    part = subject.part()
    for step, here in enumerate(extreme.frames(seed)):
        try:
            stepped(part, here)
        except ValueError:
            part = subject.part()
        except Exception as error:  # as above
            return f"absurd inputs, step {step}: {_said(error)}; a refusal is a ValueError"
    return "absurd inputs leave NaN in the state, though none was refused" if _holds_nan(part) else ""


def _holds_nan(part: Part) -> bool:
    try:
        return part.state is not None and bool(np.isnan(np.asarray(part.state, dtype=float)).any())
    except (TypeError, ValueError):  # no row of numbers, which `check.state` finds
        return False


def _said(error: Exception) -> str:
    return str(error) if isinstance(error, SignalError) else f"{type(error).__name__}: {error}"
