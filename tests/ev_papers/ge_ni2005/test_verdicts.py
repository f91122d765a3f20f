"""The verdicts on Ge & Ni (2005), and what makes them fail."""

from __future__ import annotations

import dataclasses

import pytest
from helpers.judging import verdict_from, verdict_on

from ev_papers.ge_ni2005 import paper
from ev_study.verdicts.need import Need, ScenarioNeed
from ev_study.verdicts.sources import published

# With T* as printed the car speeds up from 5 to 12.7 m/s.
NOT_REPRODUCED = {"ge.claim.constant_u"}


@pytest.mark.parametrize("id", published("ge_ni2005"))
def test_verdict_is_the_expected_one(id: str):
    judgement = verdict_on(id).judgement
    assert (judgement == "not reproduced") == (id in NOT_REPRODUCED)
    assert judgement != "not measured"


@pytest.mark.parametrize(
    ("id", "changed"),
    [
        ("ge.eq.yaw_rate", ("*", "vehicle.tyre.front_cornering_stiffness", 11000.0)),
        ("ge.eq.beta", ("*", "vehicle.tyre.rear_cornering_stiffness", 12500.0)),
        ("ge.eq.v", ("plant", "initial_speed", 5.1)),
        ("ge.eq.radius", ("*", "vehicle.wheelbase", 1.76)),
        ("ge.eq.centripetal", ("plant", "speed", "free")),
        ("ge.eq.loads", ("*", "vehicle.load_transfer", "none")),
        ("ge.eq.slips", ("plant", "initial_drive_torque", (0.0, 0.0, 0.0, 0.0))),
        ("ge.eq.speeds", ("plant", "initial_speed", 5.1)),
        ("ge.fig4b.axis", ("steering_column", "profile.angle", (0.3,))),
        ("ge.fig3e", ("electronic_differential", "target_slip", 0.12)),
        ("ge.fig4c.axis", ("plant", "initial_speed", 6.0)),
        ("ge.claim.beta", ("electronic_differential", "target_slip", 0.06)),
        ("ge.claim.radius", ("electronic_differential", "target_slip", 0.06)),
        ("ge.claim.centripetal", ("electronic_differential", "target_slip", 0.06)),
        ("ge.claim.yaw_rate", ("electronic_differential", "target_slip", 0.06)),
        ("ge.claim.v", ("electronic_differential", "target_slip", 0.06)),
        ("ge.claim.slip_use", ("electronic_differential", "target_slip", 0.088)),
        ("ge.claim.outer_slip_low", ("driver", "pedals.drive_torque", (2800.0,))),
        ("ge.target", ("electronic_differential", "target_slip", 0.12)),
        ("ge.turn_in", ("electronic_differential", "yaw_gain", 0.12)),
        ("ge.parameters", ("*", "vehicle.mass", 2501.0)),
        ("ge.law", ("electronic_differential", "k_outer", 90.0)),
        ("ge.run", ("plant", "initial_speed", 5.1)),
        ("ge.claim.best_force", ("electronic_differential", "target_slip", 0.06)),
        ("ge.claim.speed", ("electronic_differential", "target_slip", 0.06)),
        ("ge.claim.linear_yaw", ("*", "vehicle.tyre.rear_cornering_stiffness", 7000.0)),
        # With increment both wheels of a heavier car stay at the limit, and so at equal torques.
        ("ge.claim.robust", ("electronic_differential", "largest_correction", 0.5)),
        ("ge.claim.yaw_target", ("electronic_differential", "yaw_gain", 0.0)),
    ],
)
@pytest.mark.sampled
def test_another_parameter_is_noticed(id: str, changed):
    assert verdict_on(id, changed).judgement == "not reproduced"


def test_the_layer_removes_the_chatter_of_one_reading_alone():
    assert verdict_on("ge.claim.chatter").judgement == "in part"
    assert verdict_on(
        "ge.claim.chatter", ("electronic_differential", "boundary_layer", False)
    ).judgement == ("not reproduced")


def test_at_the_speed_of_the_source_the_model_of_ackermann_does_not_hold():
    """Wheel speeds turn the car as equal torques do at 1 m/s, and by 30 % more at 5 m/s."""

    def at_5_m_per_s(need: Need) -> Need:
        changed = ("plant", "initial_speed", 5.0)
        return (
            dataclasses.replace(need, values=(*need.values, changed))
            if isinstance(need, ScenarioNeed)
            else need
        )

    assert verdict_from("ge.claim.low_speed", at_5_m_per_s).judgement == "not reproduced"


def test_more_drive_force_is_more_speed_on_the_full_car_alone():
    """A free u and `increment` make the source's car spin; the full one drives off."""
    numbers = verdict_on("ge.claim.speed").metrics
    assert numbers["speed, increment, u free"].value < 0.8
    assert numbers["speed, increment, full car, u free"].value > 1.2


def test_values_that_follow_are_those_of_the_equations():
    """published.csv has seven digits of the printed equations with the printed parameters."""
    turn, speeds, slips = (
        paper.steady_turn(),
        paper.rear_speeds(),
        [paper.slip_of(n) for n in paper.rear_loads()],
    )
    # eq 6 before the car yaws
    change = paper.YAW_GAIN * (0.0 - paper.STEERING * paper.SPEED / paper.WHEELBASE)
    # holds lambda_3* straight ahead [N m]
    target = paper.friction(paper.TARGET) * paper.REAR_LOAD * paper.RADIUS
    follows = {
        "eq.yaw_rate": [turn.yaw_rate],
        "eq.beta": [turn.sideslip],
        "eq.v": [turn.lateral_speed],
        "eq.radius": [turn.radius],
        "eq.centripetal": [turn.centripetal_acceleration],
        "eq.loads": paper.rear_loads(),
        "eq.slips": [*slips, paper.slip_of(paper.REAR_LOAD)],
        "eq.speeds": [
            *speeds,
            *(speed / (1.0 - slip) for speed, slip in zip(speeds, slips, strict=True)),
        ],
        "target": [target],
        "turn_in": [change, paper.TARGET - change],
    }
    for id, values in follows.items():
        written = [check.value for check in published("ge_ni2005")[f"ge.{id}"].checks]
        assert written == pytest.approx(list(values), rel=1e-6), id
