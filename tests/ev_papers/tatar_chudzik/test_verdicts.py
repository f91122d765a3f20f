"""The verdicts on Tatar & Chudzik, and what makes them fail."""

from __future__ import annotations

import pytest
from helpers.judging import verdict_on

from ev_study.verdicts.sources import published

# It rises in the axes of the car; and so does the sum of the magnitudes.
NOT_REPRODUCED = {"tatar.fig14.FR", "tatar.aim"}
SIGNS = [
    id
    for id in published("tatar_chudzik")
    if id.startswith(("tatar.fig12.", "tatar.fig13.", "tatar.fig14."))
]
NOT_CLAIMED = {"tatar.fig12.FR"}


@pytest.mark.parametrize("id", published("tatar_chudzik"))
def test_verdict_is_the_expected_one(id: str):
    judgement = verdict_on(id).judgement
    assert (judgement == "not reproduced") == (id in NOT_REPRODUCED)
    assert judgement != "not measured"


@pytest.mark.parametrize("id", [id for id in SIGNS if id not in NOT_REPRODUCED | NOT_CLAIMED])
def test_a_correction_without_gain_changes_nothing_beyond_the_margin(id: str):
    assert verdict_on(id, ("electronic_differential", "gain", 0.0)).judgement in (
        "not reproduced",
        "not measured",
    )


@pytest.mark.parametrize(
    ("id", "changed"),
    [
        ("tatar.t1", ("*", "vehicle.yaw_inertia", 1737.0)),
        ("tatar.run", ("steering_column", "profile.time", (14.0, 14.2))),
    ],
)
def test_another_input_is_noticed(id: str, changed):
    assert verdict_on(id, changed).judgement == "not reproduced"


@pytest.mark.parametrize("layout", ["front", "rear", "all"])
def test_influence_on_the_path_is_that_of_the_torque_moved(layout: str):
    """200 N m with 50 % move as much as 100 N m with 100 %: twice and four times the default."""
    numbers = verdict_on("tatar.trajectory").metrics

    def change(name: str) -> float:
        return numbers[name].value - 1.0

    least = change(layout)
    assert change(f"{layout}, 200 N m") == pytest.approx(2.0 * least, rel=0.1)
    assert change(f"{layout}, 200 N m, gain 100 %") == pytest.approx(4.0 * least, rel=0.1)


def test_below_7_m_per_s_the_magnitude_rises():
    """The lateral force of the front left wheel, one of two parallel ones, points outwards."""
    for fig in (12, 13, 14):
        metrics = verdict_on(f"tatar.fig{fig}.FL").metrics
        corrected, equal = (
            metrics[f"at 6 m/s, 70 N m, {of}"].value for of in ("corrected", "equal")
        )
        assert corrected < 1.05 * equal < 0.0


def test_another_wheelbase_is_noticed():
    changed = (("*", "vehicle.wheelbase", 4.2), ("*", "vehicle.centre_of_mass_to_rear_axle", 2.0))
    assert verdict_on("tatar.radius", *changed).judgement == "not reproduced"
