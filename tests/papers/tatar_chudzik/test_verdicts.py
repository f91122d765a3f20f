"""The verdicts on Tatar & Chudzik, and what makes them fail."""

from __future__ import annotations

import pytest
from judging import verdict_on

from ev_sim.verdicts.sources import published

# It rises in the axes of the car; and so does the sum of the magnitudes.
NOT_REPRODUCED = {"tatar.fig14.FR", "tatar.aim"}
SIGNS = [id for id in published("tatar_chudzik") if id.startswith(("tatar.fig12.", "tatar.fig13.", "tatar.fig14."))]
NOT_CLAIMED = {"tatar.fig12.FR"}


@pytest.mark.parametrize("id", published("tatar_chudzik"))
def test_verdict_is_the_expected_one(id: str):
    judgement = verdict_on(id).judgement
    assert (judgement == "not reproduced") == (id in NOT_REPRODUCED)
    assert judgement != "not measured"


@pytest.mark.parametrize("id", [id for id in SIGNS if id not in NOT_REPRODUCED | NOT_CLAIMED])
def test_a_correction_without_gain_changes_nothing_beyond_the_margin(id: str):
    assert verdict_on(id, ("electronic_differential", "gain", 0.0)).judgement in ("not reproduced", "not measured")


def test_another_wheelbase_is_noticed():
    changed = (("*", "vehicle.wheelbase", 4.2), ("*", "vehicle.centre_of_mass_to_rear_axle", 2.0))
    assert verdict_on("tatar.radius", *changed).judgement == "not reproduced"
