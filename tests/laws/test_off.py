"""No traction control."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from ev_msgs_py.methods import create, find_method
from ev_msgs_py.signals import WheelTorqueCommand, WheelTorqueRequest
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import Wheels

wheels = st.builds(Wheels, *[st.floats(-1000.0, 1000.0)] * 4)


@given(wheels, wheels)
@settings(max_examples=20)
def test_off_passes_everything_through(torques, brakes):
    method = find_method("asr", "off")
    law = create(method, method.parameters(), Vehicle(), 0.001)
    assert law.step(WheelTorqueRequest(torques, brakes)) == WheelTorqueCommand(torques, brakes)
