"""When the friction in use is that of the road, and what is believed of the road else."""

from __future__ import annotations

import pytest
from helpers.traction import PERIOD, numbers_of

from ev_control.estimation.friction_estimate import FrictionLearningParameters, learnt_friction

P = numbers_of(FrictionLearningParameters())


@pytest.mark.parametrize(("used", "learnt"), [(0.4, 0.4), (-0.2, 0.0), (3.0, 1.2)])
def test_a_wheel_that_slips_shows_the_road(used, learnt):
    """Within what a road may have: nothing to 1.2."""
    assert learnt_friction(P, 0.9, used, True, PERIOD) == learnt


def test_a_wheel_that_grips_leaves_a_value_that_rises():
    """0.3 1/s, whatever is in use: after a second 0.3 more, and no more than 1.2."""
    friction = 0.2
    for _ in range(200):
        friction = learnt_friction(P, friction, 0.1, False, PERIOD)
    assert friction == pytest.approx(0.5, rel=1e-12)
    for _ in range(1000):
        friction = learnt_friction(P, friction, 0.1, False, PERIOD)
    assert friction == 1.2
