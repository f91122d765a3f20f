"""Laws that hold a slip pull away on slippery hills that the grip of their wheels carries the car up."""

from __future__ import annotations

import pytest
from launches import launch

SLIP_LAWS = ("feedback_linearisation", "fuzzy", "modified_lambda", "pi_slip", "slip_window")
SNOW = ("packed_snow_1",)


def climbed(law: str, grade: float, sign: float = 1.0, torque: float = 3000.0) -> float:
    """Distance [m] uphill 6 s after the start, forwards or with the car the other way round."""
    hill = ("plant", "road.grade", (sign * grade,))
    return sign * float(launch(law, SNOW, sign * torque, 1.0, 6.0, more=(hill,))["pose.x"][-1])


@pytest.mark.parametrize("grade", [0.10, 0.12])
def test_the_grip_suffices(grade):
    """With 1600 N m the car climbs these hills without any traction control; at full throttle it stands."""
    assert climbed("off", grade, torque=1600.0) > 2.0
    assert climbed("off", grade) < 0.0


@pytest.mark.parametrize("law", SLIP_LAWS)
def test_every_slip_law_starts_on_a_snowy_hill(law):
    """4.5 m and more on 10 %, 1.5 m and more on 12 %, where at 0.1 m/s of sliding tread four of them stood still."""
    assert climbed(law, 0.10) > 4.0
    assert climbed(law, 0.12) > 1.2


@pytest.mark.parametrize("law", SLIP_LAWS)
def test_they_start_backwards_as_well(law):
    """With front drive the hill then loads the driven wheels, so that they have more grip than forwards."""
    assert climbed(law, 0.10, -1.0) > 4.0


@pytest.mark.parametrize("law", SLIP_LAWS)
def test_flat_snow_costs_nothing(law):
    """At most 0.5 % of the distance with a target that is whole at rest."""
    group = "at_rest" if law == "slip_window" else "regulator.at_rest"
    whole = launch(law, SNOW, 3000.0, 1.0, 6.0, more=(("asr", group, 1.0),))["pose.x"][-1]
    assert climbed(law, 0.0) > 0.995 * whole
