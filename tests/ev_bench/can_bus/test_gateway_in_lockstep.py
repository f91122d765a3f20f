"""The gateway between ASR and the inverters of the test bench, as a part of the graph."""

from __future__ import annotations

import numpy as np
import pytest
from can_bus.databases import by_cantools, ours
from can_bus.lockstep_runs import driven

from ev_msgs_py.can.payload import joined

pytestmark = pytest.mark.slow

TORQUE_STEP = ours()["Drive11_SetPoint"].signals["Torque"].scale


@pytest.fixture(scope="module")
def healthy():
    return driven(0.6)


def test_a_torque_arrives_to_half_a_step_of_the_bus_and_at_the_next_cycle(healthy):
    """The inverter's cycle is half a cycle after the controller's.

    The mean of the machine follows by its lag.
    """
    asked = healthy["torque_command.drive.front_left"] / 7.4
    arrived = healthy["bench.shafts.set_point.front_left"]
    settled = np.r_[False, (asked[1:] == asked[:-1]) & (arrived[1:] != 0.0)]
    assert settled.sum() > 100
    assert np.abs(arrived - asked)[settled].max() <= TORQUE_STEP / 2 * (1 + 1e-9)


def test_the_frames_in_the_signals_are_what_another_tool_reads(healthy):
    """The last motion frame of the left drive, by cantools.

    Operation enabled, and the torque of the machine.
    """
    low, high = (healthy[f"can.feedback.drive_12_motion_0_{half}"][-1] for half in ("low", "high"))
    data = joined(low, high).to_bytes(8, "little")
    values = by_cantools().decode_message("Drive12_Motion", data, decode_choices=False)
    assert int(values["Statusword"]) & 0x6F == 0x27
    assert values["Torque"] == pytest.approx(
        healthy["bench.shafts.machine_torque.front_left"][-1], abs=0.1
    )
