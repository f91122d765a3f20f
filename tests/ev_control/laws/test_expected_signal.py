"""Traction control by stored friction diagrams (dissertation, section 1.4)."""

from __future__ import annotations

import dataclasses
import math

import pytest
from helpers.traction import CAR, PERIOD, Control, numbers_of, spinning_at

from ev_control.estimation.friction_estimate import (
    FrictionDiagramParameters,
    expected_friction,
    friction_at_peak,
    peak_slip,
)
from ev_msgs_py.contract.wheels import Wheels
from ev_sim.surfaces import SURFACES

DIAGRAM = numbers_of(FrictionDiagramParameters())


def test_diagram_has_its_peak_where_the_curves_of_the_source_have_theirs():
    """Burckhardt's peaks (table 2.3) on snow and wet asphalt within 0.01, as the parameter says."""
    for name in ("packed_snow_1", "packed_snow_2", "wet_asphalt_1"):
        of = SURFACES[name]
        largest, star = of.peak_friction, math.log(of.c1 * of.c2 / of.c3) / of.c2
        assert peak_slip(DIAGRAM, largest) == pytest.approx(star, abs=0.01)
        at_peak = expected_friction(DIAGRAM, largest, peak_slip(DIAGRAM, largest), 0.0)
        assert at_peak == pytest.approx(largest, rel=1e-12)


def test_side_slip_takes_from_the_longitudinal_friction_by_the_slip_vector():
    """Whatever the slips: phi_x^2 + phi_y^2 is the diagram at the resultant slip.

    At the peak, beside six tenths of its slip across, eight tenths of the friction are left along.
    """
    for slip, lateral in ((0.03, 0.04), (0.2, 0.1), (0.05, 0.0)):
        along, across = (
            expected_friction(DIAGRAM, 0.4, *pair) for pair in ((slip, lateral), (lateral, slip))
        )
        alone = expected_friction(DIAGRAM, 0.4, math.hypot(slip, lateral), 0.0)
        assert math.hypot(along, across) == pytest.approx(alone, rel=1e-12)
    star = peak_slip(DIAGRAM, 0.4)
    at_peak = expected_friction(DIAGRAM, 0.4, 0.8 * star, 0.6 * star)
    assert (
        friction_at_peak(DIAGRAM, 0.4, 0.6 * star)
        == pytest.approx(at_peak, rel=1e-12)
        == pytest.approx(0.32)
    )
    assert friction_at_peak(DIAGRAM, 0.4, 2.0 * star) == 0.0


@pytest.mark.parametrize("friction", [0.2, 0.8])
def test_road_is_found_before_the_wheel_slips(friction):
    """A wheel that shows the diagram of a road at half its peak slip.

    The estimate finds the road within 1 %, 0.5 s.
    """
    slip = 0.5 * peak_slip(DIAGRAM, friction)
    law = Control("expected_signal")
    load = CAR.mass * 9.81 * CAR.centre_of_mass_to_rear_axle / CAR.wheelbase / 2.0
    torque = expected_friction(DIAGRAM, friction, slip, 0.0) * load * CAR.wheel_radius
    still = dataclasses.replace(
        spinning_at(10.0 / (1.0 - slip), 10.0), torque=Wheels.front(torque, torque), a_x=0.0
    )
    for _ in range(round(0.5 / PERIOD)):
        law.step(still)
    assert law.of_wheel()["friction"] == pytest.approx(friction, rel=0.01)
