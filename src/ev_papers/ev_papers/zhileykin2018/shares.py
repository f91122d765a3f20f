"""Shares of the torque that the law asks for, and how often one of them turns around."""

from __future__ import annotations

import numpy as np

from ev_stack.measures.handling import turning_in
from ev_stack.measures.metric import channel
from ev_stack.recording.recording import Recording

# Least way of a share between two turn-arounds [1]; assumed: what moves less is no oscillation.
SWING = 0.005


def _asked(run: Recording, wheel: str) -> np.ndarray:
    return channel(run, f"torque_request.drive.{wheel}")


def front_share(run: Recording) -> np.ndarray:
    """Torque of the front axle over that of the car, h_n, (n,) [1]."""
    front = _asked(run, "front_left") + _asked(run, "front_right")
    return front / (front + _asked(run, "rear_left") + _asked(run, "rear_right"))


def rear_left_share(run: Recording) -> np.ndarray:
    """Torque of the left rear wheel over that of its axle, h_2, (n,) [1]."""
    return _asked(run, "rear_left") / (_asked(run, "rear_left") + _asked(run, "rear_right"))


def rear_right_share(run: Recording) -> np.ndarray:
    """Torque of the right rear wheel over that of its axle, h_4, (n,) [1]."""
    return _asked(run, "rear_right") / (_asked(run, "rear_left") + _asked(run, "rear_right"))


SHARES = {"h_n": front_share, "h_2": rear_left_share, "h_4": rear_right_share}


def reversals(run: Recording, share: str) -> int:
    """Number of reversals of a share from the turn-in on.

    The start is another event: an engine pulls away against its converter, and the law follows.
    """
    return turn_arounds(SHARES[share](run)[turning_in(run) :], SWING)


def turn_arounds(values: np.ndarray, swing: float) -> int:
    """Number of reversals of a series after a way of more than `swing`, in its unit.

    It goes with the series from one turning point to the next: `low` and `high` are the ends of the
    way since the last one, and a step back from an end by more than `swing` turns it around.
    """
    count = 0
    direction = 0  # of the way, 0 until the series has moved
    low = high = values[0]
    for value in values:
        low = min(low, value)
        high = max(high, value)
        if direction >= 0 and value < high - swing:
            count += direction > 0
            direction = -1
            low = value
        elif direction <= 0 and value > low + swing:
            count += direction < 0
            direction = 1
            high = value
    return count
