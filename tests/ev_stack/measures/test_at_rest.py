"""Angles of a car at rest: rounding errors give its velocity any direction."""

from __future__ import annotations

import numpy as np

from ev_stack.figures.panels import motion_panels
from ev_stack.manoeuvres import sine_with_dwell
from ev_stack.measures import motion
from ev_stack.recording.recording import Recording
from ev_study.studies import compare
from ev_study.studies.study import Case, drive_case

STOPPED = {
    "twist.longitudinal": np.array([10.0, 10.0, 1e-17, -1e-17, 10.0]),
    "twist.lateral": np.array([0.1, -0.1, 1e-17, 1e-17, 0.1]),
}
RUN = Recording(np.arange(5) * 0.01, STOPPED)


def test_a_sideslip_angle_is_shown_where_the_car_moves():
    """A block from -180 to 180 deg would hide what there is to be seen."""
    (panel,) = motion_panels({"run": RUN}, "sideslip_angle")
    (curve,) = panel.curves
    assert np.isnan(curve.values).tolist() == [False, False, True, True, False]
    assert np.nanmax(np.abs(curve.values)) < 1.0
    assert np.nanmax(np.abs(motion.sideslip_in_motion(RUN, continuous=True))) < 0.02


def test_a_peak_is_that_of_the_moving_car():
    found = sine_with_dwell.metrics({"times_1_5": RUN})["times_1_5_peak_sideslip_angle"]
    assert found.value == np.arctan2(0.1, 10.0)


def test_a_comparison_of_runs_that_begin_at_rest_leaves_a_gap():
    driven = drive_case(Case("launch", "shchur2019", duration=0.1), compare.measure)
    assert not driven.refused and np.isnan(driven.measured["sideslip"][0])
