"""Look-ups along the road."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import inlined


@inlined
def segment_at(start: tuple[float, ...], distance: float, previous: int) -> int:
    """Index of the segment that holds a distance [m], looked for from the previous one on; `start` [m] rises."""
    index = previous
    while index + 1 < len(start) and distance >= start[index + 1]:
        index += 1
    while index > 0 and distance < start[index]:
        index -= 1
    return index


@inlined
def interpolate(
    distances: tuple[float, ...], values: tuple[float, ...], distance: float, previous: int
) -> tuple[float, int]:
    """Linear interpolation between points, constant outside, and the index of the point before."""
    index = segment_at(distances, distance, previous)
    if index + 1 >= len(distances) or distance <= distances[index]:
        return values[index], index
    share = (distance - distances[index]) / (distances[index + 1] - distances[index])
    return values[index] + share * (values[index + 1] - values[index]), index
