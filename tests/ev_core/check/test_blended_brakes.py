"""Blended brakes keep the contract, whatever their parameters are."""

from __future__ import annotations

import pytest

from ev_core.check.method import check_configuration
from ev_core.lockstep.configuration import configure
from ev_msgs_py.contract.wheels import WHEEL_NAMES

pytestmark = pytest.mark.slow

ALL_DRIVEN = {"vehicle.driven_wheels": list(WHEEL_NAMES)}
CHOICES = {
    "as it is": {},
    "all driven": ALL_DRIVEN,
    "friction alone": {"blending": "friction", **ALL_DRIVEN},
    "without yaw": {"yaw.gain": 0.0, "slip.filter_time": 0.0, "lag": 0.0},
    "firm": {
        "yaw.gain": 100.0,
        "yaw.yielding": 0.01,
        "yaw.deadband": 0.0,
        "slip.target": 0.03,
        "use": 0.0,
    },
    "slow battery": {
        "vehicle.battery.charge_power": 10e3,
        "standing": 5.0,
        "slip.release": 0.0,
        **ALL_DRIVEN,
    },
}


@pytest.mark.sampled
@pytest.mark.parametrize("choice", CHOICES)
def test_contract_is_kept(choice):
    check_configuration(
        configure("asr", {"method": "blended_brakes", **CHOICES[choice]}), steps=300, seeds=[1]
    )
