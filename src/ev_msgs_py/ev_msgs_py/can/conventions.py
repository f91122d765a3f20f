"""What both ends of the bus mean by the numbers in frames, and by ages."""

from __future__ import annotations

from math import pi

RPM = pi / 30.0  # rad/s
NO_MODE, TORQUE_MODE, SPEED_MODE = range(3)  # of a set-point
LONG_AGO = 1e9  # s; an age of what has never been
