"""The scenario of Ge & Ni (2005): closed form, printed equations, both cars, boundary layer."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers.printed_ge_ni2005 import equal_torques
from helpers.source_runs import driven, metrics_of, value

from ev_papers.ge_ni2005 import paper
from ev_papers.ge_ni2005.source import ORDERINGS, READINGS
from ev_sim.understeer import understeer_gradient
from ev_stack.measures import motion

QUANTITIES = ("yaw_rate", "sideslip", "lateral_speed", "radius", "centripetal_acceleration")


@pytest.mark.parametrize("rear", [0.0, -paper.STEERING / 2])
def test_steady_turn_solves_eqs_1_to_3(rear):
    """The equations as a linear system in v and w at rest, without the closed form's algebra.

    To 1e-12.
    """
    front, back, u = paper.FRONT_STIFFNESS, paper.REAR_STIFFNESS, paper.SPEED
    couple = paper.FRONT_ARM * front - paper.REAR_ARM * back
    square = paper.FRONT_ARM**2 * front + paper.REAR_ARM**2 * back
    pushed = (back + 2 * paper.TORQUE / paper.RADIUS) * rear  # side force of the turned rear wheels
    lateral, yaw_rate = np.linalg.solve(
        [[(front + back) / u, couple / u + paper.MASS * u], [couple / u, square / u]],
        (
            front * paper.STEERING + pushed,
            paper.FRONT_ARM * front * paper.STEERING - paper.REAR_ARM * pushed,
        ),
    )
    turn = paper.steady_turn(rear)
    assert turn.yaw_rate == pytest.approx(yaw_rate, rel=1e-12)
    assert turn.lateral_speed == pytest.approx(lateral, rel=1e-12)
    assert turn.sideslip == pytest.approx(math.atan(lateral / u), rel=1e-12)
    assert turn.radius == pytest.approx(math.hypot(u, lateral) / yaw_rate, rel=1e-12)


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize(
    ("run", "rear"), [("equal_torque", 0.0), ("equal_torque_rear_steered", -paper.STEERING / 2)]
)
def test_equal_torque_turns_as_the_closed_form_of_this_car_says(quantity, run, rear):
    """0.5 %; measured are 0.06 % without and 0.3 % with rear steering.

    Angles that are not quite small.
    """
    closed = getattr(paper.steady_turn(rear), quantity)
    assert value("ge_ni2005", f"{quantity}_{run}") == pytest.approx(closed, rel=0.005)


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_full_car_turns_nearly_alike_with_u_held(quantity):
    closed = getattr(paper.steady_turn(), quantity)
    assert value("ge_ni2005", f"{quantity}_equal_torque_full_car") == pytest.approx(
        closed, rel=0.005
    )


@pytest.mark.parametrize(
    ("run", "free", "rear", "tolerance"),
    [
        ("equal_torque", False, 0.0, 0.002),
        ("equal_torque_rear_steered", False, -paper.STEERING / 2, 0.003),
        # loads by tyre forces across the car, not across the path
        ("equal_torque_free_speed", True, 0.0, 0.01),
    ],
)
def test_the_sources_car_moves_as_the_printed_equations_say(run, free, rear, tolerance):
    """Speed and yaw rate from 0.1 to 3 s beside scipy's solution.

    What is left is 2 % of J_w in the front wheels.
    """
    printed, channels = equal_torques(free, rear), driven("ge_ni2005").runs[run].channels
    for time in (0.1, 0.2, 0.5, 1.0, 2.0, 3.0):
        u, _, yaw_rate, *_ = printed(time)
        n = round(time / 0.001)
        assert channels["twist.longitudinal"][n] == pytest.approx(u, rel=1e-3), time
        assert channels["twist.yaw_rate"][n] == pytest.approx(yaw_rate, rel=tolerance), time


def test_understeer_gradient_is_that_of_the_printed_stiffnesses():
    """K = m (b/C_f - a/C_r)/L = 0.002249, also with C that do not follow the load."""
    vehicle = driven("ge_ni2005").scenario.runs[0].configurations["plant"].common.vehicle
    assert vehicle.tyre.lateral_curve == "constant_stiffness"
    assert understeer_gradient(vehicle) == pytest.approx(0.002249, rel=1e-3)


def test_turn_begins_in_the_equilibrium_of_straight_running():
    """Slip 0.0868 at both wheels, which holds T* = 1200 N m; nothing turns yet."""
    channels = driven("ge_ni2005").runs["rate"].channels
    for side in ("left", "right"):
        slip = channels[f"tire_forces.slip_ratio.rear_{side}"]
        assert slip[0] == pytest.approx(paper.slip_of(paper.REAR_LOAD), rel=1e-6)
        assert channels[f"tire_forces.longitudinal_force.rear_{side}"][0] == pytest.approx(
            paper.TORQUE / paper.RADIUS
        )
    assert channels["twist.lateral"][0] == channels["twist.yaw_rate"][0] == 0.0


def test_radius_comes_into_the_axis_of_fig_4b_after_a_quarter_of_a_second():
    """A step of the wheels begins at an infinite radius.

    70 m are passed at 0.27 s, by eqs 1 and 2 alone at 0.25 s.
    """
    run = driven("ge_ni2005").runs["equal_torque"]
    radius = motion.radius_of_path(run)
    assert run.time[np.flatnonzero((radius > 70.0) | (radius < 0.0))[-1]] == pytest.approx(
        0.268, abs=0.005
    )


def failing(case: str) -> set[str]:
    """The orderings that do not hold in a case, by id and reading."""
    metrics = metrics_of("ge_ni2005")
    names = [
        f"{id}.{reading}{side}{case}"
        for id in ORDERINGS
        for reading in READINGS
        for side in (("_left", "_right") if id == "ge.claim.slip_use" else ("",))
    ]
    judged = {name: metrics[name] for name in names if name in metrics}
    assert all(metric.value is not None for metric in judged.values())
    return {
        name.removesuffix(case)
        for name, metric in judged.items()
        if metric.judgement != "reproduced"
    }


def test_every_ordering_holds_with_u_held_on_both_cars():
    assert failing("") == failing("_full_car") == set()


def test_with_u_free_the_orderings_are_those_of_the_car():
    """The source's car spins with `increment` and loses speed.

    The full car drives off on a wide path.
    """
    spun = {
        "ge.claim.slip_use.increment_left",
        "ge.claim.slip_use.increment_right",
    }
    assert failing("_free_speed") == spun
    assert value("ge_ni2005", "sideslip_increment_free_speed") < -0.5
    turned = {
        f"ge.claim.{name}.increment" for name in ("beta", "radius", "centripetal", "yaw_rate")
    }
    assert failing("_full_car_free_speed") == turned


def test_printed_target_slip_is_reached_by_increment_alone():
    """0.19 needs 1640 N m.

    `rate` gets to 1350 and 1500 N m in 3 s, `offset` ends at 1250 and 1300.
    """
    most = {
        reading: max(
            driven("ge_ni2005").runs[reading].channels[f"tire_forces.slip_ratio.rear_{side}"].max()
            for side in ("left", "right")
        )
        for reading in READINGS
    }
    assert most["increment"] > paper.TARGET > 1.5 * max(most["rate"], most["offset"])


def test_boundary_layer_takes_the_chatter_away_where_its_control_is_continuous():
    for name, least in (
        ("rate_lower_target", 50.0),
        ("offset_lower_target", 1e4),
        ("increment", 1e3),
    ):
        assert value("ge_ni2005", f"chatter_{name}_switched") > least
    metrics = metrics_of("ge_ni2005")
    assert metrics["ge.claim.chatter.rate_lower_target"].judgement == "reproduced"
    assert metrics["ge.claim.chatter.offset_lower_target"].judgement == "reproduced"
    assert "target slip CHANGED" in metrics["ge.claim.chatter.rate_lower_target"].verdict
    assert metrics["ge.claim.chatter.increment"].judgement == "not reproduced"
