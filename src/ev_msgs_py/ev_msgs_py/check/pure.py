"""Pure: the same inputs give the same outputs, whatever else runs in the process."""

from __future__ import annotations

from ev_msgs_py.check.stepping import Subject, difference, said, stepped


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
