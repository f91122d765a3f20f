"""A run in fewer samples that still shows how far each channel went."""

from __future__ import annotations

import numpy as np

from ev_sim.running.recording.recording import Recording


def envelope(run: Recording, every: int) -> Recording:
    """Two samples of each 2 `every`: lowest and highest of every channel, in the order in which they came.

    They stand at the first and the middle instant, so no sample moves by more than 2 `every` of them; a gap stays a
    gap. Of the rest at the end, shorter than that, they stand at its first and last instant. A run comes back as it is
    if `every` is 1.
    """
    size = 2 * every
    whole = len(run.time) // size * size
    if every == 1 or not whole:
        return run
    last = sorted({whole, len(run.time) - 1}) if whole < len(run.time) else []
    time = np.concatenate([run.time[:whole:every], run.time[last]])

    def thinned(values: np.ndarray) -> np.ndarray:
        rest = _ends(values[whole:], len(values) - whole)[: len(last)] if last else values[:0]
        return np.concatenate([_ends(values[:whole], size), rest])

    return Recording(time, {name: thinned(values) for name, values in run.channels.items()})


def _ends(values: np.ndarray, size: int) -> np.ndarray:
    bins = values.reshape(-1, size)
    lowest, highest = bins.argmin(axis=1), bins.argmax(axis=1)
    places = np.stack([np.minimum(lowest, highest), np.maximum(lowest, highest)], axis=1)
    return np.take_along_axis(bins, places, axis=1).ravel()
