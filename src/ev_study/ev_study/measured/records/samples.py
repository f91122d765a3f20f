"""Believed samples of a record: a wrong time or a spike costs itself and nothing behind it.

How it works: times come first. `believed` keeps the longest series of increasing times, so one
wrong reading of the clock costs that sample and not all behind it. Then values: `jumps` looks for
steps that no car makes and for the way back. What comes back was a spike and is passed over; what
does not is a new level, behind which windows of a replay restart (a `Cut`).
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ev_msgs_py.refusal import ParameterError

# samples in which a signal that has jumped away has to be back, else it has jumped for good
_LONGEST_SPIKE = 10
# [s], longer than any pause in a record: a clock that was not set yet is years behind
_PAUSE = 86400.0
# places that a note names, and jumps among which that back is looked for
_NAMED, _MOST_JUMPS = 5, 50
_TOGETHER = 20  # samples, more than a buffer hands on at once
_ANOTHER = 100  # samples in a row for which the clock has no room: they are those of another drive


@dataclass(frozen=True)
class Sampled:
    """Values over their times [s], (n,) both."""

    time: np.ndarray
    values: np.ndarray

    def scaled(self, factor: float) -> Sampled:
        """The same in another unit."""
        return replace(self, values=factor * self.values)


# times [s] of two samples that do not belong together: a record goes on behind the second
Cut = tuple[float, float]


def in_order(
    source: str, columns: Mapping[str, Sampled]
) -> tuple[dict[str, Sampled], tuple[str, ...], list[Cut]]:
    """Drop samples with times that are not believed.

    Count them and find set-back clocks. ParameterError if they are most of the samples.
    """
    kept: dict[str, Sampled] = {}
    cuts: dict[Cut, None] = {}  # each once
    # by what was passed over: columns of one table or topic share their times
    names_of: dict[str, list[str]] = {}
    for name, each in columns.items():
        good = believed(each.time) if len(each.time) else np.zeros(0, bool)
        bad, of = len(good) - int(good.sum()), len(good)
        # More than three quarters passed over: what is left would be chance, such as a column that
        # is no time.
        if of - bad < 2 or 4 * bad > 3 * of:
            raise ParameterError(
                f"{source}: the time of {name} does not increase, or there are less than two"
                f" instants: {bad} of {of} samples are not later than those before"
            )
        kept[name] = replace(each, time=each.time[good], values=each.values[good])
        if bad:
            back = _steps_back(each.time, good)
            # Columns of one table report the same cut.
            cuts |= dict.fromkeys(back)
            what = (
                f"{bad} of {of} samples passed over: their times do not"
                f" increase{_where_cut('steps back', back)}"
            )
            names_of.setdefault(what, []).append(name)
    return kept, tuple(f"{', '.join(names)}: {what}" for what, names in names_of.items()), [*cuts]


def _steps_back(time: np.ndarray, good: np.ndarray) -> list[Cut]:
    """Find where samples in a row have no room in the believed clock: it was set back there."""
    places = np.flatnonzero(good)
    # Between two believed samples: how many were passed over, and the time that they had.
    passed_over, steps = np.diff(places) - 1, np.diff(time[places])
    # At the usual rate they would need twice that time.
    without_room = np.flatnonzero(passed_over * np.median(steps) > 2.0 * steps)
    found = []
    for before, behind in zip(places[without_room], places[without_room + 1], strict=True):
        # equal times are those of messages that were taken together
        if np.ptp(time[before + 1 : behind]) > 0.0:
            found.append((float(time[before]), float(time[behind])))
    return found


def _where_cut(what: str, cuts: Sequence[Cut]) -> str:
    """Text of a note on the places at which a record is cut; empty if there are none."""
    if not cuts:
        return ""
    times = ", ".join(f"{behind:.2f}" for _, behind in cuts[:_NAMED]) + (
        " ..." if len(cuts) > _NAMED else ""
    )
    return f"; it {what} at {times} s, where windows restart"


def without_spikes(
    columns: Mapping[str, Sampled], largest_step: Mapping[str, tuple[float, float]]
) -> tuple[dict[str, Sampled], tuple[str, ...], list[Cut]]:
    """The columns with NaN for the samples that jump, how many these are, and where one jumps for good.

    `largest_step` has by name what is no jump yet: a step of any two samples, and a rate on top of
    it.
    """
    kept = dict(columns)
    notes = []
    cuts: list[Cut] = []
    for name, (step, rate) in largest_step.items():
        if name not in columns:
            continue
        each = columns[name]
        places = np.flatnonzero(
            np.isfinite(each.values)
        )  # a sensor that fails often has cells without a number as well
        time, values = each.time[places], each.values[places]
        # A sensor with one number has no step.
        if len(places) < 2:
            continue
        steps = np.diff(time)
        # A gap gives the car time to change, so the limit grows with it; two samples that came at
        # once have at least the usual time.
        jumped, for_good = jumps(values, step + rate * np.maximum(steps, np.median(steps)))
        if jumped.any():
            of_column = [(float(time[place]), float(time[place + 1])) for place in for_good]
            spikes = places[jumped]
            kept[name] = replace(each, values=each.values.copy())
            kept[name].values[spikes] = np.nan
            what = (
                f"{len(spikes)} of {len(each.values)} samples passed over, which jump as no car"
                " does"
            )
            notes.append(f"{name}: {what}{_where_cut('jumps for good', of_column)}")
            cuts += of_column
    return kept, tuple(notes), cuts


class Spacing(NamedTuple):
    """Distance of the samples of a series, and the largest one without a gap [s]."""

    interval: float
    largest: float
    is_in_bursts: bool = False


def spacing_of(time: np.ndarray) -> Spacing:
    """The median for both; of samples in bursts the mean, and what lies between two bursts.

    A buffer hands such samples on together, and each gets the time at which it came.
    """
    steps = np.diff(time)
    step = float(np.median(steps))
    # The mean distance over more samples than a burst has. If it is far above the median, most
    # samples follow the one before at once.
    over_several = (time[_TOGETHER:] - time[:-_TOGETHER]) / _TOGETHER
    if not len(over_several) or np.median(over_several) <= 2.0 * step:
        return Spacing(step, step)
    # Of 20 samples at most one is the first of a burst.
    between = float(np.quantile(steps, 1.0 - 1.0 / _TOGETHER))
    return Spacing(float(np.mean(steps[steps <= 1.5 * between])), between, True)


def cut(instants: np.ndarray, cuts: Sequence[Cut]) -> np.ndarray:
    """Mark the instants [s] between the samples of a cut, at least one for each, (n,) bool."""
    found = np.zeros(len(instants), bool)
    for before, behind in cuts:
        first, last = np.searchsorted(instants, (before + 1e-9, behind + 1e-9), side="right")
        # A cut between two instants marks the one behind it: the mask would else not show it.
        found[first : max(last, first + 1)] = True
    return found


def believed(time: np.ndarray) -> np.ndarray:
    """Mark believed times [s] of a series (n,), bool: most that increase, within one stretch.

    Where the clock restarts, as in a log to which another drive was appended, only one of both is
    believed.
    """
    found = np.isfinite(time)
    # The usual record needs no sorting.
    if found.all() and len(time) and (np.diff(time) > 0.0).all() and time[-1] - time[0] < _PAUSE:
        return found
    places = np.flatnonzero(found)
    places = places[_longest_rise(time[places])]
    passed_over, steps = np.diff(places) - 1, np.diff(time[places])
    # Samples with wrong times leave a pause of their own length; those of another drive leave none.
    restarts = (
        (passed_over > _ANOTHER) & (passed_over * np.median(steps) > 2.0 * steps)
        if len(steps)
        else steps > 0.0
    )
    # Each side is judged by itself: the rise across both would mix the drives.
    if restarts.any() and 4 * len(places) > len(time):
        at = int(places[np.flatnonzero(restarts)[0]]) + 1
        before, behind = believed(time[:at]), believed(time[at:])
        kept = before.sum() >= behind.sum()
        return np.concatenate([before & kept, behind & ~kept])
    # A clock that was set during the record jumps by years: the longer side is the record.
    stretches = np.split(places, np.flatnonzero(np.diff(time[places]) > _PAUSE) + 1)
    found[:] = False
    found[max(stretches, key=len)] = True
    return found


def _longest_rise(values: np.ndarray) -> list[int]:
    """Places of the longest strictly increasing subsequence, by patience sorting.

    Of equal values the first.
    """
    ends: list[float] = []  # by length the least value with which a rise of it ends,
    last: list[int] = []  # where that value is,
    before = [-1] * len(values)  # and by place that of the value before it in its rise
    for place, value in enumerate(values.tolist()):
        # The longest rise that this value can end is one longer than that of a smaller end.
        length = bisect_left(ends, value)
        if length == len(ends):
            ends.append(value)
            last.append(place)
        elif ends[length] == value:
            continue
        else:
            ends[length] = value
            last[length] = place
        before[place] = last[length - 1] if length else -1
    rise = []
    place = last[-1] if last else -1
    while place >= 0:
        rise.append(place)
        place = before[place]
    return rise[::-1]


def jumps(
    values: np.ndarray, limit: float | np.ndarray, sure: float = 1.0
) -> tuple[np.ndarray, list[int]]:
    """Mark where a series jumps away, up to where it is back, (n,) bool.

    List lasting jumps. A lasting jump is given by the place before it. `limit` is the largest step,
    of all or (n - 1,). What is back within `_LONGEST_SPIKE` may be back in any way, later on,
    within half of the samples, only by a jump; then both are larger than `sure` limits. Near the
    beginning or the end it is the short side that has jumped. Of a jump for good one instant is
    marked.
    """
    sizes = np.abs(np.diff(values))
    limits = np.broadcast_to(limit, sizes.shape)
    edges, is_sure = np.flatnonzero(sizes > limits), sizes > sure * limits
    jumped, for_good = np.zeros(len(values), bool), []
    behind = 0
    short = min(_LONGEST_SPIKE, len(values) // 2)
    for number, edge in enumerate(edges.tolist()):
        # Within a jump that was marked already.
        if edge < behind:
            continue
        # a car that drives on meanwhile is back somewhere else
        most = max(limits[edge], 0.5 * sizes[edge])
        # The sample behind the edge is the one that has jumped: the next one is the first that may
        # be back.
        near = np.abs(values[edge + 2 : edge + 2 + _LONGEST_SPIKE] - values[edge]) < min(
            3.0 * limits[edge], most
        )
        # A jump later on that ends where this one began is the way back, such as of a sensor that
        # showed zero for a second.
        later = edges[number + 1 : number + 1 + _MOST_JUMPS]
        later = later[is_sure[later] & is_sure[edge] & (later - edge <= len(values) // 2)]
        later = later[np.abs(values[later + 1] - values[edge]) < most]
        if near.any():
            behind = edge + 2 + int(near.argmax())
        elif edge < short:  # a sensor that has not begun yet
            jumped[: edge + 1] = True
            continue
        elif len(later):
            behind = int(later[0]) + 1
        # The record ends before it is back.
        elif len(values) - 1 - edge <= short:
            behind = len(values)
        else:
            behind = edge + 2
            for_good.append(edge)
        jumped[edge + 1 : behind] = True
    return jumped, for_good
