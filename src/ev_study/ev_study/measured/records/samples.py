"""Which samples of a record are believed: one with a wrong time, or a spike, costs itself and not what is behind it."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from ev_msgs_py.refusal import ParameterError

_LONGEST_SPIKE = 10  # samples in which a signal that has jumped away has to be back, else it has jumped for good
_PAUSE = 86400.0  # [s], longer than any pause in a record: a clock that was not set yet is years behind
_ANOTHER = 100  # samples in a row for which the clock has no room: they are those of another drive


@dataclass(frozen=True)
class Sampled:
    """Values over their times [s], (n,) both."""

    time: np.ndarray
    values: np.ndarray

    def scaled(self, factor: float) -> Sampled:
        """The same in another unit."""
        return replace(self, values=factor * self.values)


def in_order(source: str, columns: Mapping[str, Sampled]) -> tuple[dict[str, Sampled], tuple[str, ...]]:
    """The columns without the samples whose times are not believed, and how many these are.

    ParameterError if they are most of them.
    """
    kept: dict[str, Sampled] = {}
    names_of: dict[str, list[str]] = {}  # by what was passed over: columns of one table or topic share their times
    for name, each in columns.items():
        good = believed(each.time) if len(each.time) else np.zeros(0, bool)
        bad, of = len(good) - int(good.sum()), len(good)
        if of - bad < 2 or 4 * bad > 3 * of:
            raise ParameterError(
                f"{source}: the time of {name} does not increase, or there are less than two instants: "
                f"{bad} of {of} samples are not later than those before"
            )
        kept[name] = replace(each, time=each.time[good], values=each.values[good])
        if bad:
            what = f"{bad} of {of} samples passed over, whose times do not increase"
            names_of.setdefault(what, []).append(name)
    return kept, tuple(f"{', '.join(names)}: {what}" for what, names in names_of.items())


def without_spikes(
    columns: Mapping[str, Sampled], largest_step: Mapping[str, tuple[float, float]]
) -> tuple[dict[str, Sampled], tuple[str, ...]]:
    """The columns with NaN for the samples that jump, and how many these are.

    `largest_step` has by name what is no jump yet: a step of any two samples, and a rate on top of it.
    """
    kept = dict(columns)
    notes = []
    for name, (step, rate) in largest_step.items():
        if name not in columns:
            continue
        each = columns[name]
        spikes = jumps(each.values, step + rate * float(np.median(np.diff(each.time))))
        if spikes.any():
            kept[name] = replace(each, values=np.where(spikes, np.nan, each.values))
            notes.append(f"{name}: {spikes.sum()} of {len(spikes)} samples passed over, which jump as no car does")
    return kept, tuple(notes)


def believed(time: np.ndarray) -> np.ndarray:
    """Where the times [s] of a series (n,) are believed, (n,) bool: most of them that increase, within one stretch.

    Where the clock begins anew, as in a log to which another drive was appended, only one of both is believed.
    """
    found = np.isfinite(time)
    if found.all() and len(time) and (np.diff(time) > 0.0).all() and time[-1] - time[0] < _PAUSE:
        return found
    places = np.flatnonzero(found)
    places = places[_longest_rise(time[places])]
    passed_over, steps = np.diff(places) - 1, np.diff(time[places])
    # Samples with wrong times leave a pause of their own length; those of another drive leave none.
    anew = (passed_over > _ANOTHER) & (passed_over * np.median(steps) > 2.0 * steps) if len(steps) else steps > 0.0
    if anew.any() and 4 * len(places) > len(time):
        at = int(places[np.flatnonzero(anew)[0]]) + 1
        before, behind = believed(time[:at]), believed(time[at:])
        kept = before.sum() >= behind.sum()
        return np.concatenate([before & kept, behind & ~kept])
    stretches = np.split(places, np.flatnonzero(np.diff(time[places]) > _PAUSE) + 1)
    found[:] = False
    found[max(stretches, key=len)] = True
    return found


def _longest_rise(values: np.ndarray) -> list[int]:
    """Places of the longest strictly increasing subsequence, by patience sorting; of equal values the first."""
    ends: list[float] = []  # by length the least value with which a rise of it ends,
    last: list[int] = []  # where that value is,
    before = [-1] * len(values)  # and by place that of the value before it in its rise
    for place, value in enumerate(values.tolist()):
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


def jumps(values: np.ndarray, limit: float) -> np.ndarray:
    """Where a series jumps away, up to where it is back; a jump that does not come back is one instant.

    Near the beginning or the end it is the short side that has jumped.
    """
    jumped = np.zeros(len(values), bool)
    behind = 0
    short = min(_LONGEST_SPIKE, len(values) // 2)
    for edge in np.flatnonzero(np.abs(np.diff(values)) > limit):
        if edge < behind:
            continue
        after = values[edge + 1 : edge + 2 + _LONGEST_SPIKE]
        back = np.flatnonzero(np.abs(after[1:] - values[edge]) < 3.0 * limit)
        if not len(back) and edge < short:  # a sensor that has not begun yet
            jumped[: edge + 1] = True
            continue
        is_end = not len(back) and len(values) - 1 - edge <= short
        behind = len(values) if is_end else edge + 2 + (int(back[0]) if len(back) else 0)
        jumped[edge + 1 : behind] = True
    return jumped
