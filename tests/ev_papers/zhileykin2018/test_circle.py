"""Distance of a path from a circle."""

import numpy as np
import pytest

from ev_papers.zhileykin2018.paths import deviation_from_circle
from ev_stack.measures.metric import NotMeasured
from ev_stack.recording.recording import Recording

TIME = np.linspace(0.0, 5.0, 501)


def path(x: np.ndarray, y: np.ndarray) -> Recording:
    return Recording(TIME, {"pose.x": x, "pose.y": y})


def test_an_arc_is_a_circle():
    """1e-9: rounding of a radius of 40 m."""
    assert (
        deviation_from_circle(path(3 + 40 * np.sin(0.1 * TIME), 40 * np.cos(0.1 * TIME)), 0.0)
        < 1e-9
    )


def test_what_lies_before_the_beginning_does_not_count():
    turned = np.maximum(TIME - 2.0, 0.0)
    x, y = 40 * np.sin(0.1 * turned) + np.minimum(TIME - 2.0, 0.0) * 4, 40 * np.cos(0.1 * turned)
    assert deviation_from_circle(path(x, y), 2.0) < 1e-9
    assert deviation_from_circle(path(x, y), 0.0) > 0.01  # a straight line and an arc


def test_a_radius_that_swings_deviates_by_its_amplitude():
    """Full circles of 40 m with a wave of 0.5 m, six to the turn.

    2 %: the fit takes little of it.
    """
    angle = 2 * np.pi * TIME / 5.0
    radius = 40 + 0.5 * np.sin(6 * angle)
    assert deviation_from_circle(
        path(radius * np.cos(angle), radius * np.sin(angle)), 0.0
    ) == pytest.approx(0.5, rel=0.02)


def test_standing_still_is_no_circle():
    with pytest.raises(NotMeasured, match="does not move"):
        deviation_from_circle(path(0 * TIME, 0 * TIME), 0.0)
