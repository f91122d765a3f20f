"""Finite: numbers, or a refusal; NaN neither leaves a method nor stays in it. And what has no direction has no sign."""

from __future__ import annotations

import numpy as np

from ev_core.check.inputs import ExtremeInputs
from ev_core.check.stepping import Subject, numbers_in, stepped
from ev_core.methods.part import Part
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import SignalError, shape_of


def not_finite(subject: Subject, seed: int) -> str:
    """What goes wrong with plausible inputs; empty if every step gives finite numbers."""
    part = subject.part()
    for step, here in enumerate(subject.frames(seed)):
        try:
            raw = stepped(part, here)
        except Exception as error:  # whatever a stranger's law raises is a finding
            return f"plausible inputs, step {step}: {_said(error)}"
        if negative := _negative(subject, numbers_in(raw)):
            return f"plausible inputs, step {step}: {negative}"
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


def _negative(subject: Subject, numbers: np.ndarray) -> str:
    """The first number that is negative and must not be, such as a brake torque; empty if there is none."""
    for kind in subject.configuration.method.writes:
        shape = shape_of(kind)
        for channel, value in zip(shape.channels, numbers[frame.PLACES[kind]], strict=True):
            if value < 0.0 and shape.fields[channel.partition(".")[0]].never_negative:
                return f"{kind.__name__}.{channel} is {value}, allowed is never below zero"
    return ""


def _holds_nan(part: Part) -> bool:
    try:
        return part.state is not None and bool(np.isnan(np.asarray(part.state, dtype=float)).any())
    except (TypeError, ValueError):  # no row of numbers, which `check.state` finds
        return False


def _said(error: Exception) -> str:
    return str(error) if isinstance(error, SignalError) else f"{type(error).__name__}: {error}"
