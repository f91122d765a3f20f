"""Between processes of this machine: both nodes, and a stranger's program at either end."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from can_bus.databases import FILE, ours
from can_bus.test_bus_nodes import World
from can_bus.test_channels import FRAMES, free_port, group, received
from helpers.patience import PATIENCE
from helpers.ros_graph import NAMESPACE, ros_domain
from std_srvs.srv import SetBool, Trigger

from ev_bench import can_hub
from ev_bench.bus.channel import Channel
from ev_bench.inverter_gateway.gateway import GatewayParameters
from ev_bench.inverter_gateway.station import GatewayStation
from ev_bench.nodes.bus_nodes import Ticks
from ev_core.parameters.values import build
from ev_msgs_py.can.drive_states import FAULT, OPERATION_ENABLED, SWITCH_ON_DISABLED
from ev_msgs_py.can.frames import TORQUE_MODE

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[3] / "docs" / "examples"
# A loaded machine holds processes up for longer than the time-outs of a real bus: here they are no
# subject.
PATIENT = {
    "drive.command_timeout": 1.0,
    "load.command_timeout": 1.0,
    "drive.dc_link.precharge_resistance": 20.0,
}


STARTED: list[subprocess.Popen] = []


@pytest.fixture(autouse=True)
def no_process_left() -> Iterator[None]:
    yield
    for process in STARTED:
        if process.poll() is None:
            process.kill()
            process.wait()
    STARTED.clear()


def started(words: list[str], **more: object) -> subprocess.Popen:
    """A process that does not outlive its test."""
    process = subprocess.Popen(
        words, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **more
    )
    STARTED.append(process)
    return process


def launch(package: str, name: str, domain: int, values: dict[str, object]) -> subprocess.Popen:
    """A node as it is started by `ros2 run`, or what that would start."""
    for prefix in os.environ["AMENT_PREFIX_PATH"].split(os.pathsep):
        path = Path(prefix) / "lib" / package / name
        if path.exists():
            break
    words = [str(path), "--ros-args", "-r", f"__ns:={NAMESPACE}"]
    for key, value in values.items():
        words += ["-p", f"{key}:={value}"]
    environment = {**os.environ, "ROS_DOMAIN_ID": str(domain)}
    return started(words, env=environment)


def channels() -> dict[str, str]:
    """Parameters of a bus of its own."""
    names = {f"bus.channel_{circuit}": group(free_port()) for circuit in ("11", "12")}
    return {"bus.interface": "udp_multicast", **names}


def hub_channels() -> dict[str, str]:
    """Those of a hub in a process of its own."""
    hub = started([sys.executable, "-m", "ev_bench.can_hub", "--port", "0"])
    place = hub.stdout.readline().split()[-1]
    names = {f"bus.channel_{circuit}": f"can{circuit}@{place}" for circuit in ("11", "12")}
    return {"bus.interface": "socketcand", **names}


def end(processes: list[subprocess.Popen]) -> list[str]:
    """Press Ctrl-C and return the output of each process."""
    for process in processes:
        process.send_signal(signal.SIGINT)
    return [process.communicate(timeout=PATIENCE)[0] for process in processes]


def test_a_hub_ends_without_output_however_often_it_is_stopped():
    """A hub that is interrupted several times ends without a line."""
    hub = started([sys.executable, "-m", "ev_bench.can_hub", "--port", "0"])
    hub.stdout.readline()
    hub.send_signal(signal.SIGINT)
    assert end([hub]) == [""]
    assert hub.returncode == 0


def test_a_port_of_a_hub_that_is_taken_or_none_is_refused(capsys):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(
            SystemExit, match=f"^error: can_hub: port {port}: Address already in use"
        ):
            can_hub.main(["--port", str(port)])
    with pytest.raises(SystemExit, match="2"):
        can_hub.main(["--port", "65536"])
    assert "expected a whole number from 0 to 65535" in capsys.readouterr().err


def test_torque_goes_through_two_processes_and_a_bus():
    """37 N m at the left wheel behind 7.4 are 5 N m at the left shaft."""
    bus = channels()
    with ros_domain() as context:
        from rclpy.executors import SingleThreadedExecutor

        domain, world = context.get_domain_id(), World(context)
        gateway = {"feedback_timeout": 1.0, "command_timeout": 60.0, "auto_enable": True}
        processes = [
            launch("ev_bench", "inverter", domain, {**bus, **PATIENT}),
            launch("ev_bench", "inverter_gateway", domain, {**bus, **gateway}),
        ]
        executor, deadline = SingleThreadedExecutor(context=context), time.monotonic() + PATIENCE
        executor.add_node(world)
        wait = time.monotonic() + 5.0
        must_reset = True
        try:
            while abs(world.states.get("left_drive", (0.0, 0.0))[1] - 5.0) > 0.05:
                world.command(37.0, 0.0)
                # A loaded machine may hold a process up for longer than the longest time-out of an
                # inverter, which latches its fault.
                if time.monotonic() > wait:
                    if must_reset:
                        world.reset.call_async(Trigger.Request())
                    else:
                        world.enable.call_async(SetBool.Request(data=True))
                    must_reset = not must_reset
                    wait = time.monotonic() + 5.0
                executor.spin_once(timeout_sec=0.005)
                assert time.monotonic() < deadline, world.diagnoses
            assert world.states["right_drive"][1] == 0.0
        finally:
            output = end(processes)
    assert [process.returncode for process in processes] == [0, 0], output


def test_frames_go_through_a_hub_in_its_own_process():
    """Nodes use a hub where there is no multicast.

    Here the test starts it, because it takes a core of its own at full traffic.
    """
    names = hub_channels()
    one, other = (Channel("socketcand", names["bus.channel_11"]) for _ in range(2))
    stranger = Channel("socketcand", names["bus.channel_12"])
    one.send(FRAMES[0])
    assert received(other, 1) == FRAMES[:1]
    assert stranger.receive() is None
    for channel in (one, other, stranger):
        channel.close()
    (hub,) = STARTED
    end([hub])
    assert hub.returncode == 0


def test_an_interface_that_is_missing_is_one_line_and_status_1():
    process = launch(
        "ev_bench", "inverter", 0, {"bus.interface": "socketcan", "bus.channel_11": "can77"}
    )
    output = process.communicate(timeout=PATIENCE)[0]
    assert process.returncode == 1
    assert output.startswith("inverter: CAN interface socketcan, channel can77: ")
    assert output.count("\n") == 1


def script(name: str, channel: str, *more: str) -> subprocess.Popen:
    bus, _, place = channel.partition("@")
    host, _, port = place.partition(":")
    words = [
        "--database",
        str(FILE),
        "--bus",
        f"interface=socketcand,channel={bus},host={host},port={port}",
    ]
    return started([sys.executable, str(EXAMPLES / name), *words, *more])


def heard(bus: dict[str, str]) -> None:
    """Wait until an inverter sends: the script gives up where there is none for 10 s."""
    ear, deadline = Channel("socketcand", bus["bus.channel_11"]), time.monotonic() + PATIENCE
    while ear.receive() is None:
        assert time.monotonic() < deadline
    ear.close()


@pytest.mark.parametrize(
    "inverter", ["ours", pytest.param("own_inverter.py", marks=pytest.mark.weekly)]
)
def test_the_ecu_script_drives_an_inverter_again_and_again(inverter):
    """20 N m within what the bus resolves, twice.

    And once more after a run that was killed left a fault behind.
    """
    bus = hub_channels()
    with ros_domain() as context:
        if inverter == "ours":
            process = launch("ev_bench", "inverter", context.get_domain_id(), {**bus, **PATIENT})
        else:
            process = script(inverter, bus["bus.channel_11"], "--timeout", "1.0")
        heard(bus)
        for is_killed in (False, False, True, False):
            ecu = script(
                "ecu_script.py",
                bus["bus.channel_11"],
                "--torque",
                "20",
                "--seconds",
                "30" if is_killed else "0.5",
            )
            if is_killed:
                wait_for_torque(bus)
                ecu.kill()
                ecu.wait()
                wait_for_fault(bus)
                continue
            output = ecu.communicate(timeout=PATIENCE)[0]
            assert ecu.returncode == 0, output
            torque, speed = (
                float(number) for number in re.findall(r"(\d+\.\d+) (?:N m|rpm)", output)
            )
            assert torque == pytest.approx(20.0, abs=1 / 16)
            assert speed > 100.0 or inverter != "ours"  # that one has no shaft
        end([process])


def test_a_fault_in_mid_run_ends_the_ecu_script_by_its_name():
    bus = hub_channels()
    with ros_domain() as context:
        trip = {"inject.drive_11": "[trip]"}
        inverter = launch(
            "ev_bench", "inverter", context.get_domain_id(), {**bus, **PATIENT, **trip}
        )
        heard(bus)
        ecu = script("ecu_script.py", bus["bus.channel_11"])
        output = ecu.communicate(timeout=PATIENCE)[0]
        end([inverter])
    assert ecu.returncode == 1
    assert (
        output.splitlines()[-1]
        == "Drive11: it is in a fault; its first fault: the power stage tripped"
    )


def wait_for(bus: dict[str, str], holds: Callable[[dict[str, float]], bool]) -> None:
    """Run until the motion of the right drive is such."""
    motion, deadline = ours()["Drive11_Motion"], time.monotonic() + PATIENCE
    ear = Channel("socketcand", bus["bus.channel_11"])
    while time.monotonic() < deadline:
        frame = ear.receive()
        if frame is None:
            time.sleep(0.001)
        elif frame.identifier == motion.identifier and holds(
            motion.values(int.from_bytes(frame.data, "little"))
        ):
            ear.close()
            return
    raise AssertionError("not in time")


def wait_for_torque(bus: dict[str, str]) -> None:
    """Run until it gives torque."""
    wait_for(bus, lambda motion: motion["Torque"] > 10.0)


def wait_for_fault(bus: dict[str, str]) -> None:
    """Run until it is in a fault."""
    wait_for(bus, lambda motion: int(motion["Statusword"]) & 0x4F == 0x08)


def test_our_gateway_leads_the_inverter_script():
    """The script in place of our inverter: enabled, 10 N m, a fault without set-points, reset."""
    bus = hub_channels()
    channel = Channel("socketcand", bus["bus.channel_11"])
    drive = script("own_inverter.py", bus["bus.channel_11"], "--seconds", "20", "--timeout", "0.5")
    patient = {"feedback_timeout": 1.0, "command_timeout": 10.0}
    station, ticks = GatewayStation(ours(), build(GatewayParameters, patient)), Ticks()
    feedback = station.devices["Drive11"].feedback

    def run(until, sends: bool = True) -> None:
        deadline = time.monotonic() + PATIENCE
        while not until():
            assert time.monotonic() < deadline, feedback
            while (frame := channel.receive()) is not None:
                station.receive("11", frame)
            for circuit, frame in station.step(passed) if (passed := ticks.passed()) else ():
                if sends and circuit == "11":
                    channel.send(frame)
            time.sleep(ticks.until_next())

    def again() -> None:
        station.command("Drive11", TORQUE_MODE, 10.0)
        run(lambda: station.enable(("Drive11",)) == "")
        run(lambda: feedback.state == OPERATION_ENABLED)
        run(lambda: abs(feedback.torque - 10.0) < 0.05)

    run(lambda: feedback.state == SWITCH_ON_DISABLED)
    again()
    run(lambda: feedback.state == FAULT and feedback.error_code == 0x8130, sends=False)
    assert feedback.torque == 0.0
    station.reset()
    run(lambda: feedback.state == SWITCH_ON_DISABLED)
    again()
    channel.close()
    drive.terminate()
    drive.communicate(timeout=PATIENCE)
