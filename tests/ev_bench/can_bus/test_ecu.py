"""docs/examples/ecu.

An exported law behind CAN frames in C, in the place of the gateway, beside the law here.
"""

from __future__ import annotations

import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from can_bus.databases import ours
from can_bus.test_processes import (
    EXAMPLES,
    PATIENT,
    end,
    hub_channels,
    launch,
    no_process_left,
    started,
    wait_for_fault,
    wait_for_torque,
)
from helpers.patience import PATIENCE
from helpers.ros_graph import ros_domain

from ev_bench.bus.channel import Channel
from ev_bench.inverter_gateway.gateway import GatewayParameters
from ev_bench.inverter_gateway.station import GatewayStation
from ev_bench.nodes.bus_nodes import Ticks
from ev_core.parameters.values import build
from ev_doors.export.targets import TARGETS
from ev_msgs_py.can.frames import SPEED_MODE
from ev_msgs_py.contract import stamps
from ev_stack.interface.driving import only_run, overrides
from ev_stack.interface.simulation import SteppedLaw

pytestmark = pytest.mark.slow

LAW = "electronic_differential"
# N m, s, and s because a loaded machine holds processes up
PEDAL, SECONDS, TIMEOUT = 300.0, 0.4, 5.0
HELD = 15.0  # rad/s, of the left shaft without torque
USED = no_process_left  # a fixture for all tests here


@pytest.fixture(scope="module")
def folders(tmp_path_factory):
    """Folder for the programs of each target."""
    return tmp_path_factory.mktemp("ecu")


def built(target: str, folder: Path) -> list[str]:
    """The words that start the program here."""
    on = TARGETS[target]
    for needed in ("make", on.compiler, *on.emulator[:1]):
        if not shutil.which(needed):
            pytest.skip(f"{needed} is not installed")
    words = [
        "make",
        "-C",
        EXAMPLES / "ecu",
        f"BUILD={folder}",
        f"TARGET={target}",
        f"CC={on.compiler}",
    ]
    for _ in range(2):
        done = subprocess.run(words, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
    return [*on.emulator, str(folder / "ecu")]


class LeftLoad:
    """The left load machine, which holds its shaft back at a speed."""

    def __init__(self, channel: Channel) -> None:
        patient = {"feedback_timeout": 1.0, "command_timeout": 10.0}
        self.station, self.ticks = (
            GatewayStation(ours(), build(GatewayParameters, patient)),
            Ticks(),
        )
        self.channel, self.own = channel, int(self.station.own["Load12"].set_point)
        self.station.command("Load12", SPEED_MODE, HELD)

    def lead(self, until: Callable[[], bool]) -> None:
        deadline = time.monotonic() + PATIENCE
        while not until():
            assert time.monotonic() < deadline
            while (frame := self.channel.receive()) is not None:
                self.station.receive("12", frame)
            for _, frame in self.station.step(passed) if (passed := self.ticks.passed()) else ():
                if frame.identifier == self.own:
                    self.channel.send(frame)
            time.sleep(self.ticks.until_next())

    def holds(self) -> bool:
        return abs(self.station.devices["Load12"].feedback.speed - HELD) < 1.0


@pytest.mark.weekly
@pytest.mark.parametrize("target", ["x86_64-linux", "aarch64-linux"])
def test_an_exported_law_drives_our_inverters(target, folders):
    """Answers are those of the law here to the same wheel speeds, to the bit; the shaft obeys.

    Twice in a row, after one that was killed.

    The left wheel is held back, so the right one overtakes it, and the left one gets more torque.
    """
    program, bus = built(target, folders / target), hub_channels()
    for words, line in (
        (["0", "1"], "there is no hub at port 1"),
        (["0", "0"], "SECONDS and TIMEOUT are refused, "),
        (["a", "1"], "PEDAL is refused, "),
    ):
        alone = subprocess.run([*program, "1", *words, "1"], capture_output=True, text=True)
        assert alone.returncode == 1
        assert alone.stderr.startswith(f"ecu: {line}")
    port = bus["bus.channel_11"].rpartition(":")[2]
    with ros_domain() as context:
        inverter = launch("ev_bench", "inverter", context.get_domain_id(), {**bus, **PATIENT})
        load = LeftLoad(Channel("socketcand", bus["bus.channel_12"]))
        load.lead(lambda: load.station.enable(("Load12",)) == "")
        load.lead(load.holds)
        words = [*program, port, str(PEDAL), str(SECONDS), str(TIMEOUT)]
        killed = started([*words[:-2], "30", str(TIMEOUT)])
        # against the drive
        load.lead(lambda: load.station.devices["Load12"].feedback.torque < -1.0)
        killed.kill()  # the drives keep a fault, which the next one resets
        before = started(words)
        load.lead(lambda: before.poll() is not None)
        assert before.returncode == 0, before.communicate()[0]
        ecu = started(words)
        load.lead(lambda: ecu.poll() is not None)
        load.channel.close()
        end([inverter])
    output = ecu.communicate()[0]
    assert ecu.returncode == 0, output
    rows = np.array(
        [line.split() for line in output.splitlines() if not line.startswith("ecu: held, ")], float
    )
    run = only_run("urban_mixed_bench", "", overrides(method={LAW: "limited_slip"}))
    law = SteppedLaw(run.configurations[LAW])
    given = dict.fromkeys(law.inputs, 0.0) | {"driver.command.drive_torque": PEDAL}
    for n, (left, right, *torques) in enumerate(rows.tolist()):
        given |= {
            "wheel_states.velocity.front_left": left,
            "wheel_states.velocity.front_right": right,
        }
        answer = law.answer(stamps.to_seconds(n * run.period), given)
        assert [
            answer[f"torque_request.drive.front_{side}"] for side in ("left", "right")
        ] == torques
    left, right, *torques = rows[-1]
    assert right > left and torques[0] > torques[1]  # by how much hangs on the wall clock


@pytest.mark.weekly
def test_a_fault_while_the_program_is_held_up_past_its_end_is_printed(folders):
    """It is stopped for longer than the 3 s that it holds, and the drives miss its set-points.

    Exit status 1.
    """
    program, bus = built("x86_64-linux", folders / "x86_64-linux"), hub_channels()
    with ros_domain() as context:
        inverter = launch("ev_bench", "inverter", context.get_domain_id(), {**bus, **PATIENT})
        ecu = started(
            [*program, bus["bus.channel_11"].rpartition(":")[2], str(PEDAL), "3", str(TIMEOUT)]
        )
        wait_for_torque(bus)
        ecu.send_signal(signal.SIGSTOP)
        time.sleep(3.0)
        wait_for_fault(bus)
        ecu.send_signal(signal.SIGCONT)
        output = ecu.communicate(timeout=PATIENCE)[0]
        end([inverter])
    assert "ecu: a drive or the law has failed" in output
    assert ecu.returncode == 1


def test_a_torque_that_is_none_goes_out_as_zero(folders):
    """The law refuses a pedal that is no number; 1e6 N m are more than the frame has."""
    folder, on = folders / "x86_64-linux", TARGETS["x86_64-linux"]
    built(on.name, folder)
    sources = [
        Path(__file__).with_name("ecu_cycles.c"),
        folder / "ev_bench.c",
        folder / "law" / "libevs_law.a",
    ]
    options = ["-std=gnu2x", *(f"-I{each}" for each in (EXAMPLES / "ecu", folder, folder / "law"))]
    program = on.program(sources, folder / "ecu_cycles", options)
    done = subprocess.run(
        [program, "300", "nan", "300", "1e6", "300"], capture_output=True, text=True, check=True
    )
    rows = [line.split() for line in done.stdout.splitlines()]
    cycles = [[float(word) for word in words] for kind, *words in rows if kind == "cycle"]
    # half a step of the frame
    drives = pytest.approx([1.0, PEDAL / 2 / 7.4, PEDAL / 2 / 7.4], abs=0.02)
    assert cycles == [drives, [0.0, 0.0, 0.0], drives, [0.0, 0.0, 0.0], drives]
    assert [line.partition(" is refused")[0] for line in done.stderr.splitlines()] == [
        "ecu: driver.command.drive_torque",
        "ecu: 67567.6 N m at a shaft",
    ]
