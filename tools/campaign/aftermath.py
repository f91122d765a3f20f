"""What a run leaves behind: no process, no memory, and what it has recorded can be read."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from rosbags.highlevel import AnyReader

from campaign.under_way import UnderWay
from ev_stack.recording.recording import load

_GONE_WITHIN = 2.0  # s after its end until nothing of a run is there any more


def left_behind(run: UnderWay, before: set[str]) -> Iterator[str]:
    """What should not be there, one line each; `before` is what was in shared memory when the run began."""
    deadline = time.monotonic() + _GONE_WITHIN
    while (there := run.processes()) and time.monotonic() < deadline:
        time.sleep(0.05)
    if there:
        yield f"processes are left: {', '.join(there.values())}"
    if memory := shared_memory() - before - _mapped():
        yield f"shared memory is left: {', '.join(sorted(memory))}"
    out = run.trial.out
    if out.exists():
        yield from _unreadable(out)


def shared_memory() -> set[str]:
    """Names of what Fast DDS has in /dev/shm."""
    return {name for name in os.listdir("/dev/shm") if "fast" in name}


def _mapped() -> set[str]:
    """Names of shared memory that a process uses."""
    names: set[str] = set()
    for place in Path("/proc").glob("[0-9]*/maps"):
        try:
            names.update(re.findall(r"/dev/shm/(\S+)", place.read_text()))
        except OSError:
            continue
    return names


def _unreadable(out: Path) -> Iterator[str]:
    for bag in sorted(out.glob("**/metadata.yaml")):
        try:
            with AnyReader([bag.parent]) as reader:
                read, said = sum(1 for _ in reader.messages()), reader.message_count
            if read != said:
                yield f"{bag.parent.name}: {read} of {said} messages can be read"
        except Exception as error:
            yield f"{bag.parent.name} cannot be read: {error!r}"
    for path in sorted(out.glob("**/signals.npz")):
        try:
            recording = load(path)
        except Exception as error:
            yield f"{path.name} cannot be read: {error!r}"
            continue
        if not all(np.isfinite(values).all() for values in recording.channels.values()):
            yield f"{path.name} holds numbers that are not finite"
