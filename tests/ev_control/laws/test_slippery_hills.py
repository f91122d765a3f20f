"""Laws that hold a slip pull away on slippery hills within the grip of their wheels."""

from __future__ import annotations

import pytest
from helpers.launches import launch
from helpers.traction import in_regulator

SLIP_LAWS = (
    "expected_signal",
    "feedback_linearisation",
    "fuzzy",
    "least_squares",
    "modified_lambda",
    "pi_slip",
    "slip_window",
)
SNOW = ("packed_snow_1",)


def climbed(law: str, grade: float, sign: float = 1.0, torque: float = 3000.0) -> float:
    """Distance [m] uphill 6 s after the start, forwards or with the car the other way round."""
    hill = ("plant", "road.grade", (sign * grade,))
    return sign * float(launch(law, SNOW, sign * torque, 1.0, 6.0, more=(hill,))["pose.x"][-1])


@pytest.mark.parametrize("grade", [0.10, 0.12])
def test_the_grip_suffices(grade):
    """The car climbs these hills with 1600 N m without any traction control.

    At full throttle it stands.
    """
    assert climbed("off", grade, torque=1600.0) > 2.0
    assert climbed("off", grade) < 0.0


@pytest.mark.parametrize("law", SLIP_LAWS)
def test_every_slip_law_starts_on_a_snowy_hill(law):
    """4.5 m and more on 10 %, 1.5 m and more on 12 %, with 0.1 m/s of sliding tread."""
    assert climbed(law, 0.10) > 4.0
    assert climbed(law, 0.12) > 1.2


@pytest.mark.parametrize("law", SLIP_LAWS)
def test_they_start_backwards_as_well(law):
    """The hill then loads the driven front wheels, so that they have more grip than forwards."""
    assert climbed(law, 0.10, -1.0) > 4.0


def climbed_from_the_brake(
    law: str, pressed: float, released: float = 1.0, sign: float = 1.0
) -> float:
    """Distance [m] up 10 % in 7 s: pressed [N m] onto the brake, released from 0.9 s on.

    3000 N m from 1.5 s on.
    """
    pedals = {
        "time": (0.0, 0.5, 0.9, released, 1.5),
        "drive_torque": (0.0, 0.0, sign * pressed, sign * pressed, sign * 3000.0),
        "brake_torque": (3000.0, 3000.0, 3000.0, 0.0, 0.0),
    }
    hill = ("plant", "road.grade", (sign * 0.10,))
    more = (hill, *(("driver", f"pedals.{name}", of) for name, of in pedals.items()))
    return sign * float(launch(law, SNOW, 3000.0, 1.0, 7.0, more=more)["pose.x"][-1])


@pytest.mark.parametrize("law", SLIP_LAWS)
def test_they_start_from_the_brake(law):
    """Torque for the slope, brake released, then the pedal, as in `hill_start`: 6.8 m or more."""
    assert climbed_from_the_brake(law, 1500.0) > 6.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("released", [1.0, 1.2])
@pytest.mark.parametrize("law", SLIP_LAWS)
def test_they_start_from_the_brake_with_more_than_the_grip(law, released, sign):
    """Laws limit as soon as a wheel turns under its brake; 5.3 m and more."""
    assert climbed_from_the_brake(law, 3000.0, released, sign) > 4.5


@pytest.mark.parametrize(
    ("law", "grade"), [("acceleration_ratio", 0.12), ("maximum_transmissible_torque", 0.10)]
)
def test_laws_that_know_accelerations_alone_stand(law, grade):
    """A tread that slides evenly on a car that stands accelerates no more than the car.

    To them it grips.

    The friction of sliding, two thirds of that at the peak, does not carry the car up. On 5 % it
    does.
    """
    assert abs(climbed(law, grade)) < 0.2
    assert climbed(law, 0.05) > 2.0


@pytest.mark.parametrize("law", SLIP_LAWS)
def test_flat_snow_costs_nothing(law):
    """Less than 0.5 % of the distance with a target that is whole at rest.

    `expected_signal` 3.5 %.
    """
    group = in_regulator(law, "at_rest")
    whole = launch(law, SNOW, 3000.0, 1.0, 6.0, more=(("asr", group, 1.0),))["pose.x"][-1]
    assert climbed(law, 0.0) > (0.96 if law == "expected_signal" else 0.995) * whole
