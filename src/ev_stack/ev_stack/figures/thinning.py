"""Thinning of curves to the pixels of a line: lowest and highest, bands where they chatter.

How it works: a curve of many samples is cut into bins of some pixels. Where it crosses the values
of a bin several times, a line would be solid ink: `chatter` finds these bins, which are drawn as a
band with the mean. The rest is a line, of which `thinned` keeps the ends and the extremes of each
pixel, so that it looks the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

PIXELS = 10  # of a bin
SWINGS = 3  # across the values of a bin, from which on a line would fill it with ink
SMALL = 0.08  # share of the range of all values below which a bin is a line all the same


@dataclass(frozen=True, slots=True, eq=False)
class Chatter:
    """Bins of a curve: instants (bins + 1,), and lowest, highest and mean values (bins,).

    NaN where a line will do.

    `line`: the samples (n,) without those that stand in bins, NaN in their place.
    """

    edges: np.ndarray
    lowest: np.ndarray
    highest: np.ndarray
    mean: np.ndarray
    line: np.ndarray


def chatter(time: np.ndarray, values: np.ndarray, columns: int) -> Chatter | None:
    """Bins of values (n,) over time (n,) that chatter at `columns` pixels; None if none do."""
    count = max(columns // PIXELS, 1)
    size = len(values) // count
    if size <= SWINGS:
        return None
    whole = len(values) // size * size
    bins = values[:whole].reshape(-1, size)
    lowest, highest = bins.min(axis=1), bins.max(axis=1)
    spread = highest - lowest
    finite = values[np.isfinite(values)]
    # A line that crosses a bin once has a way of its spread; one that chatters has many times that.
    way = np.abs(np.diff(bins, axis=1)).sum(axis=1)
    dense = (way > SWINGS * spread) & (spread > SMALL * (np.ptp(finite) if len(finite) else 0.0))
    for apart in (1, 2):  # one or two bins in between are no line either
        between = dense[: -apart - 1] & dense[apart + 1 :]
        for n in range(1, apart + 1):
            dense[n : len(dense) - apart - 1 + n] |= between
    if not dense.any():
        return None
    # Samples behind the last whole bin stay a line.
    in_bins = np.zeros(len(values), bool)
    in_bins[:whole] = np.repeat(dense, size)
    in_bins[1:] &= in_bins[:-1]  # the line goes on until the band begins
    edges = np.append(time[:whole:size], time[whole - 1])
    of_bins = (np.where(dense, each, np.nan) for each in (lowest, highest, bins.mean(axis=1)))
    return Chatter(edges, *of_bins, np.where(in_bins, np.nan, values))


def thinned(time: np.ndarray, values: np.ndarray, columns: int) -> tuple[np.ndarray, np.ndarray]:
    """Samples that draw the same line at `columns` pixels: both ends, and extremes of each pixel.

    NaN counts as lowest and highest, so a gap stays a gap. Short series come back as they are.
    """
    size = len(values) // columns
    if size <= 4:
        return time, values
    whole = len(values) // size * size
    first = np.arange(0, whole, size)
    bins = values[:whole].reshape(-1, size)
    lowest, highest = first + bins.argmin(axis=1), first + bins.argmax(axis=1)
    # The rest behind the last whole bin is shorter than one bin: keep all of it.
    kept = np.unique(
        np.concatenate(([0], lowest, highest, np.arange(whole, len(values)), [len(values) - 1]))
    )
    return time[kept], values[kept]
