"""The verdicts on Shchur (2019), and what makes them fail."""

from __future__ import annotations

import pytest
from judging import verdict_on

from ev_sim.verdicts.sources import published

EXPECTED = {"reproduced", "follows from the inputs", "not judgeable", "no verdict"}


@pytest.mark.parametrize("id", published("shchur2019"))
def test_everything_that_can_be_judged_is_reproduced(id: str):
    assert verdict_on(id).judgement in EXPECTED


@pytest.mark.parametrize(
    ("id", "changed"),
    [
        ("shchur.fig1a.1.steady", ("steering_column", "stiffness", 66.0)),
        ("shchur.fig1a.1.overshoot", ("steering_column", "inertia", 3.2)),
        ("shchur.fig1a.1.settling", ("steering_column", "damping", 8.5)),
        ("shchur.fig1a.2.steady", ("electronic_differential", "k_ck", 0.06)),
        ("shchur.fig1a.2.overshoot", ("electronic_differential", "b_ck", 0.05)),
        ("shchur.fig1a.2.settling", ("*", "control_period", 0.02)),
        ("shchur.fig1a.equal_ends", ("electronic_differential", "gamma", 4.0)),
        ("shchur.fig1a.damped", ("electronic_differential", "b_ck", 0.02)),
        ("shchur.fig1b.start", ("electronic_differential", "gamma", 4.9)),
        ("shchur.fig1b.minimum", ("electronic_differential", "b_ck", 0.055)),
        ("shchur.fig1b.end", ("electronic_differential", "k_ck", 0.053)),
        ("shchur.hold30.manual", ("steering_column", "stiffness", 66.0)),
        ("shchur.hold30.assisted", ("electronic_differential", "gamma", 4.9)),
        ("shchur.hold30.dm", ("electronic_differential", "k_ck", 0.06)),
        ("shchur.fig4.V1", ("driver", "speed_profile.speed", (0.0, 4.0, 4.0, 8.3333, 8.3333))),
        ("shchur.fig4.V2", ("driver", "speed_profile.speed", (0.0, 4.1667, 4.1667, 8.0, 8.0))),
        ("shchur.fig4.M.plateau", ("*", "vehicle.rolling_resistance", 0.016)),
        ("shchur.fig4.M.acceleration", ("*", "vehicle.mass", 1600.0)),
        ("shchur.fig4.delta.left", ("driver", "steering.wanted_angle.angle", (0.0, 0.5, 0.0, -0.5, 0.0))),
        ("shchur.fig4.delta.right", ("driver", "steering.wanted_angle.angle", (0.0, 0.5, 0.0, -0.5, 0.0))),
        ("shchur.fig4.dM.left", ("electronic_differential", "gamma", 6.0)),
        ("shchur.fig4.dM.right", ("electronic_differential", "gamma", 6.0)),
        ("shchur.fig4.references", ("electronic_differential", "b_ck", 0.063)),
        ("shchur.fig4.wheel_speeds", ("*", "vehicle.wheel_radius", 0.3)),
        ("shchur.fig4.dV", ("*", "vehicle.front_track", 1.5)),
        ("shchur.angles30", ("*", "vehicle.wheelbase", 2.5)),
    ],
)
def test_another_parameter_is_noticed(id: str, changed):
    assert verdict_on(id, changed).judgement == "not reproduced"
