"""The frame: all signals of one instant in one row of float64, laid out once from the declared signals.

The first number is the time. Then come the signals in the order in which their roles stand in `roles.ROLES`, field by
field, wheel by wheel: the order that messages and recordings have as well.
"""

from __future__ import annotations

from itertools import accumulate

from ev_msgs_py.roles import RECORDED
from ev_msgs_py.shape import shape_of
from ev_msgs_py.topics import TOPICS

TIME = 0  # place of the time [s]

_ENDS = tuple(accumulate((shape_of(signal).size for signal in RECORDED), initial=1))

# Where the numbers of a signal stand in the frame.
PLACES = {signal: slice(begin, end) for signal, begin, end in zip(RECORDED, _ENDS, _ENDS[1:], strict=False)}
SIZE = _ENDS[-1]


def channels() -> dict[str, int]:
    """The place of every recorded channel, such as wheel_states.velocity.front_left, in the frame."""
    return {
        name: place
        for signal, where in PLACES.items()
        for name, place in zip(TOPICS[signal].channels, range(where.start, where.stop), strict=True)
    }
