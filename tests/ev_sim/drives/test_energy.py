"""Balances of the electrical energy of a drive."""

import numpy as np
import pytest
from drives.bench import (
    BUS_VOLTAGE,
    CONTROLS,
    RESISTANCE,
    advance_drive,
    drive_with,
    magnetic_energy,
    name_of,
    run,
)
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_sim.drives.drive import DRIVE_MODELS


@pytest.mark.parametrize("changes", CONTROLS, ids=name_of)
@settings(max_examples=20)
@given(torque=st.floats(-400, 400), speed=st.floats(-150, 150), bus_voltage=st.floats(100, 600))
def test_without_resistance_electrical_energy_is_mechanical_work_and_magnetic_energy(
    changes, torque, speed, bus_voltage
):
    """The midpoint rule keeps it to rounding, lost current control and diodes included."""
    state, parameters = drive_with({**changes, "motor.resistance": 0.0})
    electrical, mechanical, turnover = 0.0, 0.0, 1.0
    for _ in range(20):
        advance_drive(state, parameters, torque, speed, bus_voltage, 1e-3)
        electrical += state["electrical_power"] * 1e-3
        mechanical += state["mean_torque"] * speed * 1e-3
        turnover += abs(state["mean_torque"] * speed * 1e-3)
    stored = magnetic_energy(changes["drive"], state)
    assert electrical == pytest.approx(mechanical + stored, abs=1e-9 * (turnover + stored))


@pytest.mark.parametrize("changes", CONTROLS, ids=name_of)
@pytest.mark.parametrize(
    ("torque", "speed"), [(80.0, 40.0), (-80.0, 40.0), (80.0, 0.0), (12.0, -95.0)]
)
def test_what_is_left_of_the_electrical_energy_is_copper_loss(changes, torque, speed):
    """R sum(i^2) from samples every 10 us.

    1 %: the currents between two samples are taken as straight lines.
    """
    state, parameters = drive_with(changes)
    electrical = mechanical = copper = 0.0
    before = 0.0, 0.0, 0.0
    for _ in range(5000):
        advance_drive(state, parameters, torque, speed, BUS_VOLTAGE, 1e-5)
        electrical += state["electrical_power"] * 1e-5
        mechanical += state["mean_torque"] * speed * 1e-5
        if changes["drive"] == "averaged":
            after = state["current"], -state["current"], 0.0
        else:
            after = (
                state["high_current"],
                state["off_current"],
                -state["high_current"] - state["off_current"],
            )
            if not np.isclose(after, before, atol=1.0).all():
                before = after  # a commutation gives the same currents other names
        copper += (
            RESISTANCE * sum(((a + b) / 2) ** 2 for a, b in zip(before, after, strict=True)) * 1e-5
        )
        before = after
    assert electrical - mechanical - magnetic_energy(changes["drive"], state) == pytest.approx(
        copper, rel=0.01
    )


@pytest.mark.parametrize("drive", DRIVE_MODELS)
def test_braking_feeds_the_bus(drive):
    """-40 N m at 40 rad/s.

    1600 W of mechanical power less 2 R i^2 = 30 W, 2 % for the commutations.
    """
    result = run({"drive": drive}, -40.0, 40.0, duration=0.2, settled=0.1)
    loss = 0.0 if drive == "ideal" else 2 * RESISTANCE * 10.0**2
    assert np.mean(result.electrical_power) == pytest.approx(-1600.0 + loss, rel=0.02)
