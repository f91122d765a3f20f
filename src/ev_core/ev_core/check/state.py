"""Pure, and with a complete declared state: the same inputs give the same outputs, also stopped, saved and loaded."""

from __future__ import annotations

import copy
import random
from collections import Counter
from typing import Any

from ev_core.check.stepping import Subject, difference, said, stepped
from ev_core.lockstep.parts import hand_over
from ev_core.parameters.declaration import entries


def impurity(subject: Subject, seed: int) -> str:
    """What two objects do differently with the same inputs; empty if nothing.

    One runs alone. The other takes turns with a third one, which is made later and reads something else: what objects
    share, in the class, the module or a random generator of the process, shows there.
    """
    frames, others = subject.frames(seed), subject.frames(seed + 1)
    alone = said(subject.part(), frames)
    again = said(subject.part(), frames)
    found = difference(subject, alone, again)
    if found:
        return f"the same inputs give other outputs the second time, {found}"
    part, other = subject.part(), subject.part()
    taking_turns = []
    for here, elsewhere in zip(frames, others, strict=True):
        stepped(other, elsewhere)
        taking_turns.append(stepped(part, here))
    found = difference(subject, alone, taking_turns)
    return f"another object of the method disturbs it, {found}" if found else ""


def lost_state(subject: Subject, seed: int) -> str:
    """What a run does differently after it was stopped, saved and loaded; empty if nothing."""
    frames = subject.frames(seed)
    stop = random.Random(seed).randrange(1, len(frames))
    steady, stopped = subject.part(), subject.part()
    said(steady, frames[:stop])
    said(stopped, frames[:stop])
    saved, fresh = copy.deepcopy(stopped.state), subject.part()
    said(stopped, frames[stop:])  # whatever it does now is nothing to what was saved
    fresh.state = saved
    found = difference(subject, said(steady, frames[stop:]), said(fresh, frames[stop:]))
    return (
        f"the state does not hold all that lasts: loaded after {stop} steps it goes on otherwise, {found}"
        if found
        else ""
    )


def lost_by_live_change(subject: Subject, seed: int) -> str:
    """What a run does differently after its parameters were set to the values that they have; empty if nothing."""
    before = subject.configuration
    own = {e.name: e.default for e in entries(before.parameters) if not e.spec.read_only}
    changed = before.changed(own)
    if changed != before:
        return "parameters that are set to their own values are other ones"
    frames = subject.frames(seed)
    stop = len(frames) // 2
    steady, part = subject.part(), subject.part()
    said(steady, frames[:stop])
    said(part, frames[:stop])
    made = Subject(changed, subject.compiled, subject.steps).part()
    hand_over(part, made)
    found = difference(subject, said(steady, frames[stop:]), said(made, frames[stop:]))
    return f"parameters set to their own values after {stop} steps change the run, {found}" if found else ""


def unnamed_state(subject: Subject) -> str:
    """Which numbers of a law's state have no name of their own; empty if all have one."""
    law, state = subject.configuration.method.law, subject.part().state
    if law is None:
        return _not_numbers(state)
    twice = sorted(name for name, count in Counter(law.names()).items() if count > 1)
    return f"several numbers of the state are called {', '.join(twice)}" if twice else ""


def _not_numbers(state: Any) -> str:
    if state is None:
        return ""
    try:
        [float(number) for number in state]
    except (TypeError, ValueError):
        return f"the state is {type(state).__name__}, it has to be None or a row of numbers"
    return ""
