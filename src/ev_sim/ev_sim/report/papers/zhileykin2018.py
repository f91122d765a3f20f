"""What Zhileykin & Eranosyan (2018) print, and the thresholds that their words need.

M. M. Zhileykin, A. V. Eranosyan, "Improvement of four-wheel drive vehicle controllability with a connected front axle
through the redistribution of torque" (in Russian), Bauman University, 2018. Printed values are written down here once
more instead of being taken from the run, so that a run with other parameters is judged against the paper all the same.
"""

from __future__ import annotations

import math

MASS = 2400.0  # [kg]
FULL_SLIP_FRICTION = 0.35  # mu_s, "ice with snow" [1]
INITIAL_SPEED = 25.0 / 3.6  # [m/s]
LARGEST_FRONT_SHARE = 0.5  # [1]
STEERING = (2.0, 3.0)  # the third second, in which the steering wheel is turned [s]

LIMIT = math.radians(15.0)  # sideslip angle beyond which the rear axle has slid out [rad]; assumed, the source has none
SWING = 0.005  # [1], least way of a share between two turn-arounds; assumed: what moves less is no oscillation
CALM = 1  # turn-arounds of one share that entering the bend explains
