"""Checks of state and numbers.

A method is pure, finite, with a complete declared state and the same bits compiled. The same inputs
give the same outputs, also stopped, saved and loaded. A step gives numbers, or is refused; NaN
neither leaves a method nor stays in it, and a quantity without direction is never negative. A law
stepped twice with the same signals, compiled and in plain Python, gives every number with the same
bits. Each check returns its finding in words, empty if there is none.
"""

import copy
import random
from collections import Counter
from typing import Any

import numpy as np

from ev_core.check.stepping import (
    ExtremeInputs,
    MakesInputs,
    RandomInputs,
    Subject,
    difference,
    outputs,
    stepped,
)
from ev_core.compiled.part import CompiledPart, NeedsPython
from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.parts import hand_over
from ev_core.methods.law_error import LawError
from ev_core.methods.method_record import create
from ev_core.methods.part import Part, PythonPart
from ev_core.parameters.declaration import Entry, entries
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import SignalError, shape_of


def impurity(subject: Subject, seed: int) -> str:
    """Difference between two objects with the same inputs.

    One runs alone. The other takes turns with a third one, which is made later and reads other
    inputs: a number that objects share, in the class, the module or a random generator of the
    process, shows there.
    """
    frames, others = subject.frames(seed), subject.frames(seed + 1)
    alone = outputs(subject.part(), frames)
    again = outputs(subject.part(), frames)
    found = difference(subject, alone, again)
    if found:
        return f"the same inputs give other outputs the second time, {found}"
    part, other = subject.part(), subject.part()
    taking_turns = []
    for here, elsewhere in zip(frames, others, strict=True):
        stepped(other, elsewhere)
        taking_turns.append(stepped(part, here))
    found = difference(subject, alone, np.array(taking_turns))
    return f"another object of the method disturbs it, {found}" if found else ""


def lost_state(subject: Subject, seed: int) -> str:
    """Difference of a run after it was stopped, saved and loaded."""
    frames = subject.frames(seed)
    stop = random.Random(seed).randrange(1, len(frames))
    steady, stopped = subject.part(), subject.part()
    outputs(steady, frames[:stop])
    outputs(stopped, frames[:stop])
    saved = copy.deepcopy(stopped.state)
    fresh = subject.part()
    # Further steps of the one that was saved must not change the saved state.
    outputs(stopped, frames[stop:])
    fresh.state = saved
    found = difference(subject, outputs(steady, frames[stop:]), outputs(fresh, frames[stop:]))
    if not found:
        return ""
    return (
        f"the state does not hold all that lasts: loaded after {stop} steps it goes on otherwise, "
        f"{found}"
    )


def lost_by_live_change(subject: Subject, seed: int) -> str:
    """Difference of a run after its parameters were set to the values that they have."""
    before = subject.configuration
    own = {e.name: e.default for e in entries(before.parameters) if not e.spec.read_only}
    changed = before.changed(own)
    if changed != before:
        return "parameters that are set to their own values are other ones"
    frames = subject.frames(seed)
    stop = len(frames) // 2
    steady, part = subject.part(), subject.part()
    outputs(steady, frames[:stop])
    outputs(part, frames[:stop])
    made = Subject(changed, subject.compiled, subject.steps).part()
    hand_over(part, made)
    found = difference(subject, outputs(steady, frames[stop:]), outputs(made, frames[stop:]))
    if not found:
        return ""
    return f"parameters set to their own values after {stop} steps change the run, {found}"


def unnamed_state(subject: Subject) -> str:
    """Numbers of a law's state that share a name, or a state that is no row of numbers."""
    law, state = subject.configuration.method.law, subject.part().state
    if law is not None:
        twice = sorted(name for name, count in Counter(law.names()).items() if count > 1)
        return f"several numbers of the state are called {', '.join(twice)}" if twice else ""
    if state is None:
        return ""
    try:
        [float(number) for number in state]
    except (TypeError, ValueError):
        return f"the state is {type(state).__name__}, it has to be None or a row of numbers"
    return ""


def not_finite(subject: Subject, seed: int) -> str:
    """The first step with plausible inputs that gives no finite numbers."""
    try:
        part = subject.part()
    except LawError as error:
        return f"it cannot be made: {error}"
    for step, here in enumerate(subject.frames(seed)):
        try:
            raw = stepped(part, here)
        except Exception as error:  # of any kind: it is a finding
            return f"plausible inputs, step {step}: {_one_line(error)}"
        if negative := _negative(subject, raw):
            return f"plausible inputs, step {step}: {negative}"
    try:
        part.notes()
    except LawError as error:
        return f"notes behind {subject.steps} steps: {error}"
    return "plausible inputs leave NaN in the state" if _holds_nan(part) else ""


def resized_by_live_change(subject: Subject) -> str:
    """A parameter that may change in a run, and changes the length of the state."""
    configuration = subject.configuration
    size = np.size(subject.part().state)
    for entry in entries(configuration.parameters):
        # What is read only cannot change in a run, so it may set the length of the state.
        for value in () if entry.spec.read_only else _other_values(entry):
            try:
                changed = configuration.changed({entry.name: value})
                other = Subject(changed, subject.compiled, subject.steps).part()
            except LawError as error:
                return f"with {entry.name} = {value}: {error}"
            except ValueError:  # a value that does not go with the others
                continue
            if (found := np.size(other.state)) != size:
                lengths = f"{entry.name} = {entry.default} has {size} numbers, {value} has {found}"
                return f"the state with {lengths}: what sets its length is to be declared read_only"
    return ""


def _other_values(entry: Entry) -> tuple[Any, ...]:
    """The ends of the range of a number, or all choices of a text."""
    if entry.is_array or entry.type is bool:
        return ()
    if entry.spec.choices:
        return entry.spec.choices
    ends = (entry.spec.low, entry.spec.high)
    return tuple(entry.type(end) for end in ends if end is not None)


def not_refused(subject: Subject, seed: int) -> str:
    """The first step with absurd inputs that is neither finite nor refused.

    Inputs go up to the largest floats. A refusal ends a run, so the next step is that of a new
    object, which has not seen them.
    """
    extreme = Subject(subject.configuration, subject.compiled, subject.steps, ExtremeInputs)
    part = subject.part()
    for step, here in enumerate(extreme.frames(seed)):
        try:
            stepped(part, here)
        except ValueError as error:
            if isinstance(error, LawError) and not isinstance(error.__cause__, ValueError):
                return f"absurd inputs, step {step}: {error}; a refusal is a ValueError"
            part = subject.part()
        except Exception as error:  # as above
            return f"absurd inputs, step {step}: {_one_line(error)}; a refusal is a ValueError"
    if _holds_nan(part):
        return "absurd inputs leave NaN in the state, though none was refused"
    return ""


def _negative(subject: Subject, numbers: np.ndarray) -> str:
    """The first number that is negative and must not be, such as a brake torque.

    Empty if there is none.
    """
    for kind in subject.configuration.method.writes:
        shape = shape_of(kind)
        for channel, value in zip(shape.channels, numbers[frame.PLACES[kind]], strict=True):
            if value < 0.0 and shape.fields[channel.partition(".")[0]].never_negative:
                return f"{kind.__name__}.{channel} is {value}, expected 0 or more"
    return ""


def _holds_nan(part: Part) -> bool:
    try:
        return part.state is not None and bool(np.isnan(np.asarray(part.state, dtype=float)).any())
    except (TypeError, ValueError):  # no row of numbers, which `check.state` finds
        return False


def _one_line(error: Exception) -> str:
    # Errors of our own are whole sentences, those of Python need the name of their kind.
    if isinstance(error, SignalError | LawError):
        return str(error)
    return f"{type(error).__name__}: {error}"


def differing_bits(
    configuration: Configuration, steps: int, seed: int, inputs: MakesInputs = RandomInputs
) -> str:
    """First difference between the compiled and the interpreted form of a configured law."""
    method, common = configuration.method, configuration.common
    settings = (configuration.parameters, common.vehicle, common.control_period)
    try:
        compiled = CompiledPart(method, *settings)
    except NeedsPython:  # it prints, and so it runs in plain Python alone
        return ""
    plain = PythonPart(method, create(method, *settings))
    # Compiled, a law without a state has one number in its memory.
    count = len(plain.state)
    subject = Subject(configuration, True, steps, inputs)
    found: list[np.ndarray] = []
    for part in (compiled, plain):
        rows: list[np.ndarray] = []
        for here in subject.frames(seed):
            output = stepped(part, here)
            rows.append(np.append(output, part.state[:count]))
        found.append(np.array(rows))
    return difference(subject, *found)
