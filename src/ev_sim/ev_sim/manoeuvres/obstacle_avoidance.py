"""Report on the obstacle avoidance of ISO 3888-2: that of the double lane change, on the other course."""

from __future__ import annotations

from functools import partial

from ev_sim.manoeuvres.double_lane_change import figures_on, metrics_on
from ev_sim.measures.lane_change_course import OBSTACLE_AVOIDANCE

metrics, figures = partial(metrics_on, OBSTACLE_AVOIDANCE), partial(figures_on, OBSTACLE_AVOIDANCE)
