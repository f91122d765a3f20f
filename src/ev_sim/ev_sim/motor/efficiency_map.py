"""An efficiency map as a table of text."""

from __future__ import annotations

import csv
from collections.abc import Iterable

from ev_msgs_py.parameters import ParameterError


def efficiency_map_parameters(lines: Iterable[str]) -> dict[str, tuple[float, ...]]:
    """The motor parameters map_speed, map_torque and map_efficiency from the lines of a CSV table.

    The first row holds the torques [N m] after one cell that is not read, each further row a speed [rad/s] and the
    efficiencies [1]. ParameterError if the table is not rectangular or holds something that is not a number.
    """
    header, *rows = [row for row in csv.reader(lines) if row]
    try:
        torques = tuple(float(cell) for cell in header[1:])
        table = [[float(cell) for cell in row] for row in rows]
    except ValueError as error:
        raise ParameterError(f"efficiency map: {error}") from None
    for row in table:
        if len(row) != len(header):
            raise ParameterError(f"efficiency map: the row of {row[0]:g} rad/s has not {len(header)} cells")
    return {
        "map_speed": tuple(row[0] for row in table),
        "map_torque": torques,
        "map_efficiency": tuple(cell for row in table for cell in row[1:]),
    }
