"""Digest of what a search depends on beside our sources and the points that it asks for."""

from __future__ import annotations

import hashlib

import numpy as np

from ev_study.measured.replays.open_loop import OpenLoop
from ev_study.studies.digests import text_of_method


def search_key(replay: OpenLoop, *choices: object) -> str:
    """A digest of record, windows, car and what was chosen for a search."""
    roles = {
        role: (each.method.name, text_of_method(each.method), each.values())
        for role, each in replay.configurations.items()
    }
    record = replay.record
    # repr of a float has all its digits, so two texts are equal for equal bits only.
    given = (roles, replay.is_imposed, replay.cut_off, record.noise, record.spacing, choices)
    content = hashlib.sha256(repr(given).encode())
    # Arrays go in as bytes: the text of a long one is abridged.
    for values in (
        np.array(replay.windows.size),
        replay.windows.first,
        record.valid,
        # The order of the channels in a mapping changes nothing that is computed.
        *(values for _, values in sorted(record.channels.items())),
    ):
        content.update(np.ascontiguousarray(values).tobytes())
    return content.hexdigest()
