"""Kinds of faults, each a function that fills in a trial, with the ways of running that it is for and its share."""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

from campaign.kinds import files, foreign, machine, parameters, signals, wire
from campaign.trial import WAYS, Trial

NODES, DDS, ALL = ("processes",), ("processes", "in one process"), tuple(WAYS)
_LIVE = ("processes", "in one process", "real time")
_CHILDREN = ("processes", "real time")


@dataclass(frozen=True)
class Kind:
    """A name, who fills a trial in, in which ways of running, and how often among all."""

    name: str
    fill_in: Callable[[Trial], None]
    ways: tuple[str, ...]
    share: int


KINDS = (
    Kind("kill", signals.kill, ALL, 6),
    Kind("terminate", signals.terminate, ALL, 5),
    Kind("interrupt", signals.interrupt, ALL, 5),
    Kind("stop and continue", signals.stop_and_continue, ALL, 3),
    Kind("stop for ever", signals.stop_for_ever, _CHILDREN, 2),
    Kind("messages lost", wire.loss, NODES, 1),
    Kind("messages late", wire.delay, NODES, 1),
    Kind("messages in another order", wire.reorder, NODES, 1),
    Kind("messages twice", wire.duplicate, NODES, 1),
    Kind("messages spoilt", wire.spoilt, NODES, 2),
    Kind("node falls silent", wire.mute, NODES, 1),
    Kind("modelled faults", wire.modelled, (*DDS, "offline"), 1),
    Kind("stranger", foreign.stranger, _LIVE, 4),
    Kind("bad parameter", parameters.at_start, (*DDS, "offline", "offline"), 3),
    Kind("bad live parameter", parameters.live, DDS, 2),
    Kind("bad file", files.spoilt, (*DDS, "offline", "offline", "offline"), 4),
    Kind("two runs, one folder", machine.rival, ALL, 1),
    Kind("cores busy", machine.busy, ALL, 1),
    Kind("disk full", machine.full_disk, ALL, 2),
    Kind("file size limit", machine.file_size, ALL, 1),
    Kind("no shared memory", machine.no_shared_memory, DDS, 1),
    Kind("few file descriptors", machine.few_descriptors, ALL, 2),
    Kind("another monotonic clock", machine.other_clock, _LIVE, 1),
    Kind("wall clock jumps", machine.wall_clock, ALL, 1),
)


def kind_of(seed: int) -> Kind:
    """Kinds take turns by their shares, so that some dozens of seeds in a row meet nearly all."""
    turns = _turns()
    return turns[seed % len(turns)]


def turn_of(seed: int) -> int:
    """How many lower seeds, from 0 on, have the same kind: by it a kind takes its variants in turn."""
    rounds, place = divmod(seed, len(_turns()))
    kind = kind_of(seed)
    return rounds * kind.share + _turns()[:place].count(kind)


@cache
def _turns() -> tuple[Kind, ...]:
    turns = [kind for kind in KINDS for _ in range(kind.share)]
    random.Random(0).shuffle(turns)
    return tuple(turns)
