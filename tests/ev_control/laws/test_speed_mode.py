"""Slip control by set-points for drives in speed mode (dissertation, sections 1.4 and 2.4)."""

from __future__ import annotations

import dataclasses

import pytest
from helpers.traction import FASTEST, SPEED_MODE, SPINNING, Control, Measured, spinning_at, swapped

from ev_core.lockstep.configuration import configure
from ev_core.lockstep.graph import check_graph
from ev_msgs_py.contract.roles import REQUIRED
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_msgs_py.refusal import ParameterError

FREE = Wheels.all(FASTEST)


@pytest.mark.parametrize("name", SPEED_MODE)
def test_set_points_are_out_of_reach_but_for_wheels_that_slip(name):
    """Rolling, released, braked and regenerating wheels.

    The largest speed of the motor, in the request's direction.

    Torques pass always. In reverse and in the mirror all is as forwards, to the bit; corridors
    differ in reverse.
    """
    law, mirror, reverse = Control(name), Control(name), Control(name)
    assert law.set_points(dataclasses.replace(SPINNING, speed=Wheels.all(10.0))) == FREE
    lowest = FASTEST
    for n in range(40):
        m = spinning_at(10.0 + n, 10.0 + 0.01 * n)
        speeds = law.set_points(m)
        assert mirror.set_points(m.mirrored()) == swapped(speeds)
        if name != "speed_corridor":
            reverse.set_points(m.reversed())
        lowest = min(lowest, speeds.front_left)
    assert 10.0 < lowest < 12.0  # above rolling: a lower one would be a drive without torque
    assert speeds[1:] == FREE[1:]
    assert reverse.limits() == law.limits() or name == "speed_corridor"
    braked = dataclasses.replace(SPINNING, brake=Wheels.all(100.0))
    assert law.set_points(braked) == FREE
    assert law.set_points(dataclasses.replace(SPINNING, drive=NO_WHEELS)) == FREE
    assert (
        law.set_points(Measured(Wheels.front(-500.0, -500.0), speed=Wheels.all(20.0))).front_left
        == -FASTEST
    )


def test_drives_in_torque_mode_are_refused():
    """Drives in torque mode take no set-points; drives in speed mode need a law that sets them."""

    def refused(speed_mode: bool, asr: str) -> str:
        chosen = {role: configure(role, {}) for role in REQUIRED}
        chosen |= {
            "plant": configure("plant", {"method": "planar", "speed_mode": speed_mode}),
            "asr": configure("asr", {"method": asr}),
        }
        with pytest.raises(ParameterError) as error:
            check_graph(chosen)
        return str(error.value)

    required = refused(speed_mode=False, asr="speed_by_slip")
    assert "requires plant.speed_mode true, but false is chosen" in required
    assert "reads WheelSpeedCommand, which none" in refused(speed_mode=True, asr="off")
