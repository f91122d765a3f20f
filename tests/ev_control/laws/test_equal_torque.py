"""The same torque on every driven wheel."""

from __future__ import annotations

import pytest
from helpers.differentials import FRONT, REAR, SHCHUR, Differential, Motion, on

from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels


@pytest.mark.parametrize(
    ("driven", "expected"),
    [
        (FRONT, Wheels.front(60.0, 60.0)),
        (REAR, Wheels.rear(60.0, 60.0)),
        (WHEEL_NAMES, Wheels.all(30.0)),
        (("rear_left",), Wheels.rear(120.0, 0.0)),
    ],
)
def test_equal_torque_on_every_layout(driven, expected):
    assert (
        Differential("equal_torque", on(SHCHUR, driven)).step(Motion(torque=120.0)).drive
        == expected
    )
