"""The gateway and the inverters as nodes, in one process over python-can's virtual bus."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

import can
import pytest
from can_bus.benches import TORQUE, Bench
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from helpers.patience import PATIENCE
from helpers.ros_graph import NAMESPACE, ros_domain
from rclpy.node import Node
from rclpy.parameter import Parameter
from sensor_msgs.msg import BatteryState, JointState
from std_srvs.srv import SetBool, Trigger

from ev_bench.bus.channel import Channel
from ev_bench.nodes.gateway import InverterGatewayNode
from ev_bench.nodes.inverter import InverterNode
from ev_msgs_py.can.drive_states import (
    ENABLE_COMMAND,
    FAULT,
    FAULT_REACTION_ACTIVE,
    OPERATION_ENABLED,
)
from ev_msgs_py.refusal import ParameterError
from ev_nodes.stepping.spinning import spin
from ev_stack.scenarios.scenario import Overrides, load_scenario

QUICK_CHARGE = {f"{machine}.dc_link.precharge_resistance": 10.0 for machine in ("drive", "load")}
# A loaded machine may hold a node up for longer than the time-outs of a real bus: here they are no
# subject.
PATIENT = {"drive.command_timeout": 1.0, "load.command_timeout": 1.0}
WHEELS = ("front_left", "front_right", "rear_left", "rear_right")


class World(Node):
    """The graph around the gateway: its commands, and the signals that it receives."""

    def __init__(self, context: Any) -> None:
        super().__init__("asr", context=context, namespace=NAMESPACE)
        self.plant = Node("plant", context=context, namespace=NAMESPACE)
        self.torques = self.create_publisher(JointState, "torque_command", 10)
        self.loads = self.plant.create_publisher(JointState, "load_command", 10)
        self.stranger = self.create_publisher(JointState, "load_command", 10)
        self.enable = self.create_client(SetBool, "inverter_gateway/enable")
        self.reset = self.create_client(Trigger, "inverter_gateway/reset")
        self.states: dict[str, tuple[float, float]] = {}
        self.links: list[BatteryState] = []
        self.diagnoses: dict[str, tuple[bytes, str]] = {}
        self.texts: set[str] = set()
        self.create_subscription(JointState, "drive_states", self._on_states, 10)
        self.create_subscription(BatteryState, "drives/right_drive/dc_link", self.links.append, 10)
        self.create_subscription(DiagnosticArray, "/diagnostics", self._on_diagnostics, 100)

    def command(self, left: float, right: float) -> None:
        """Torques at the wheels [N m]."""
        names = [*WHEELS, *(f"{wheel}_brake" for wheel in WHEELS)]
        self.torques.publish(JointState(name=names, effort=[left, right] + [0.0] * 6))

    def _on_states(self, message: JointState) -> None:
        self.states = {
            n: (v, e)
            for n, v, e in zip(message.name, message.velocity, message.effort, strict=True)
        }

    def _on_diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            self.diagnoses[status.name.rpartition(": ")[2]] = (status.level, status.message)
            self.texts.add(status.message)


class Rig:
    """Both nodes and the world."""

    def __init__(
        self, context: Any, name: str, gateway: dict[str, Any], inverter: dict[str, Any]
    ) -> None:
        bus = {
            "bus.interface": "virtual",
            "bus.channel_11": f"{name}_11",
            "bus.channel_12": f"{name}_12",
        }
        self.world = World(context)
        patient = {"feedback_timeout": 1.0, "command_timeout": 10.0, "reset_timeout": 10.0}
        self.gateway = made(InverterGatewayNode, context, {**bus, **patient, **gateway})
        self.inverter = made(InverterNode, context, {**bus, **QUICK_CHARGE, **PATIENT, **inverter})
        self.torque: tuple[float, float] | None = (0.0, 0.0)
        self._next = 0.0

    def run(self, until: Callable[[], bool]) -> None:
        """Run with a torque command each 5 ms until something holds."""
        deadline = time.monotonic() + PATIENCE
        from rclpy.executors import SingleThreadedExecutor

        executor = SingleThreadedExecutor(context=self.world.context)
        executor.add_node(self.world)

        def finished() -> bool:
            assert time.monotonic() < deadline, self.world.diagnoses
            if time.monotonic() >= self._next:
                self._next = time.monotonic() + 0.005
                if self.torque is not None:
                    self.world.command(*self.torque)
                for _ in range(5):
                    executor.spin_once(timeout_sec=0.0)
            return until()

        spin([self.gateway, self.inverter], finished)
        executor.remove_node(self.world)
        executor.shutdown()

    def call(self, client: Any, request: Any) -> Any:
        """Call a service of the gateway and return its answer."""
        self.run(client.service_is_ready)
        answer = client.call_async(request)
        self.run(answer.done)
        return answer.result()

    def states(self, *names: str) -> set[float]:
        return {
            self.gateway.station.devices[name].feedback.state
            for name in names or ("Drive11", "Drive12")
        }

    def drive(self, circuit: str) -> Any:
        return self.inverter.circuits[circuit].s.drive


def made(kind: type, context: Any, values: dict[str, Any]) -> Any:
    given = [Parameter(key, value=value) for key, value in values.items()]
    return kind(context=context, namespace=NAMESPACE, parameter_overrides=given)


@contextmanager
def rig(
    name: str, gateway: dict[str, Any] | None = None, inverter: dict[str, Any] | None = None
) -> Iterator[Rig]:
    with ros_domain() as context:
        found = Rig(context, name, gateway or {}, inverter or {})
        try:
            yield found
        finally:
            found.gateway.close()
            found.inverter.close()


def test_torque_goes_from_the_graph_to_the_machines_and_feedback_comes_back():
    """74 N m at the wheel behind 7.4 are 10 N m at the shaft; right is circuit 11."""
    with rig("through") as r:
        assert "is silent" in r.gateway.station.enable(("Drive11",))
        r.run(
            lambda: r.gateway.station.devices["Drive12"].command_age < 1.0 and r.states() == {1.0}
        )
        assert (
            r.call(r.world.enable, SetBool.Request(data=True)).message
            == "being enabled: Drive11, Drive12"
        )
        r.run(lambda: r.states() == {float(OPERATION_ENABLED)})
        r.torque = (74.0, -148.0)
        r.run(lambda: abs(r.world.states.get("left_drive", (0.0, 0.0))[1] - 10.0) < 0.05)
        r.run(lambda: abs(r.world.states["right_drive"][1] + 20.0) < 0.05)
        assert r.world.states["left_drive"][0] > 0.0 > r.world.states["right_drive"][0]
        # 329.6 V in steps of 0.125 V
        r.run(lambda: bool(r.world.links) and r.world.links[-1].voltage == 329.625)
        r.run(
            lambda: (
                r.world.diagnoses.get("left_drive") == (DiagnosticStatus.OK, "operation enabled")
            )
        )
        assert r.call(r.world.enable, SetBool.Request(data=False)).success
        r.run(lambda: r.drive("11").torque == r.drive("12").torque == 0.0)


def test_a_fault_is_named_in_diagnostics_and_cleared_by_the_reset_service_alone():
    with rig("fault", {"auto_enable": True}) as r:
        r.run(lambda: r.states() == {float(OPERATION_ENABLED)})
        r.torque = (100.0, 100.0)
        r.run(lambda: r.drive("11").torque > 5.0)
        r.inverter.set_parameters([Parameter("inject.drive_11", value=["trip"])])
        r.run(lambda: "Trip" in r.world.diagnoses["right_drive"][1])
        assert r.world.diagnoses["right_drive"][0] == DiagnosticStatus.ERROR
        r.run(lambda: r.states("Drive11") == {float(FAULT)})
        assert r.drive("11").torque == 0.0
        assert r.drive("12").torque > 5.0
        r.inverter.set_parameters([Parameter("inject.drive_11", Parameter.Type.STRING_ARRAY, [])])
        answer = r.call(r.world.enable, SetBool.Request(data=True))
        assert (answer.success, answer.message) == (
            False,
            "Drive11 has a latched fault: reset it first",
        )
        assert r.call(r.world.reset, Trigger.Request()).success
        r.run(lambda: not r.gateway.station.enable(("Drive11", "Drive12")))
        r.run(lambda: r.states() == {float(OPERATION_ENABLED)} and r.drive("11").torque > 5.0)


def test_a_silent_controller_ends_the_torque_of_both_drives():
    with rig("silent", {"auto_enable": True, "command_timeout": 0.3}) as r:
        r.torque = (100.0, 100.0)
        r.run(lambda: r.drive("11").torque > 5.0 and r.drive("12").torque > 5.0)
        r.torque = None
        r.run(lambda: r.drive("11").torque == r.drive("12").torque == 0.0)
        r.run(lambda: "StaleCommand" in r.world.diagnoses["left_drive"][1])
        r.torque = (100.0, 100.0)  # it comes back, and nothing turns before a reset
        end = r.gateway.station.s.tick + 300
        r.run(lambda: r.gateway.station.s.tick >= end)
        assert r.drive("11").torque == 0.0


def test_load_machines_follow_load_command():
    """A load machine in speed mode keeps its command to 0.5 rad/s."""
    with rig("load") as r:
        command = JointState(name=["right_load"], velocity=[50.0])

        def run(holds: Callable[[], bool]) -> None:
            r.run(lambda: r.world.loads.publish(command) or holds())

        run(lambda: not r.gateway.station.enable(("Load11",)))
        run(lambda: r.states("Load11") == {float(OPERATION_ENABLED)})
        run(lambda: abs(r.world.states.get("right_load", (0, 0))[0] - 50.0) < 0.5)


def test_commands_that_cannot_be_meant_are_ignored_and_reported():
    with rig("nonsense") as r:
        r.torque = (float("nan"), 0.0)
        r.run(lambda: any("torque_command" in text for text in r.world.texts))
        assert r.gateway.station.devices["Drive11"].command_age > 1e6
        r.run(lambda: r.world.loads.publish(JointState(name=["middle_load"], effort=[1.0]))
              or any("load_command ignored" in text for text in r.world.texts))  # fmt: skip
        r.run(lambda: r.world.stranger.publish(JointState(name=["right_load"], effort=[1.0]))
              or any(f"asr is refused: {NAMESPACE}/load_command" in text for text in r.world.texts))  # fmt: skip
        assert r.gateway.station.devices["Load11"].command_age > 1e6


def test_random_frames_end_no_node_and_move_no_motor():
    """Frames come as fast as both can take them; docs/can.md has the long form."""
    import random

    with rig("fuzz") as r:
        strangers = [
            can.Bus(channel=f"fuzz_{circuit}", interface="virtual") for circuit in ("11", "12")
        ]
        chance, sent = random.Random(5), 0

        def more() -> bool:
            nonlocal sent
            for bus in strangers:
                for _ in range(20):
                    extended = chance.random() < 0.1
                    identifier = chance.getrandbits(29 if extended else 11)
                    data = chance.randbytes(chance.randrange(9))
                    bus.send(
                        can.Message(arbitration_id=identifier, is_extended_id=extended, data=data)
                    )
                    sent += 1
                while bus.recv(timeout=0.0):
                    pass
            assert not any(
                c.s.speed or c.s.drive.torque or c.s.load.torque
                for c in r.inverter.circuits.values()
            )
            return sent >= 6000

        r.run(more)
        for bus in strangers:
            bus.shutdown()
        r.run(lambda: r.states() == {1.0})  # both still speak and listen


@pytest.mark.parametrize(
    ("kind", "values", "message"),
    [
        (
            InverterNode,
            {"bus.interface": "carrier_pigeon"},
            "'carrier_pigeon' is refused, expected one of virtual",
        ),
        (
            InverterNode,
            {"bus.interface": "socketcan", "bus.channel_11": "can77"},
            "CAN interface socketcan, channel can77",
        ),
        (
            InverterNode,
            {"bus.interface": "virtual", "bus.database": "none.dbc"},
            "none.dbc: No such file or directory",
        ),
        (InverterNode, {"inject.drive_11": ["fire"]}, "'fire' is refused, expected one of trip"),
        (
            InverterGatewayNode,
            {"bus.interface": "virtual", "bus.log": "x.txt"},
            "'x.txt' is refused",
        ),
        (
            InverterGatewayNode,
            {"torque_limit": -1.0},
            "torque_limit: -1.0 is refused, expected 0 to 1000 N m",
        ),
        (
            InverterGatewayNode,
            {"speed": 1.0},
            "unknown parameter 'speed'; did you mean speed_limit?",
        ),
    ],
)
def test_bad_parameters_are_one_clear_line(kind: type, values: dict[str, Any], message: str):
    with ros_domain() as context, pytest.raises((ValueError, RuntimeError)) as refused:
        made(kind, context, values)
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


def test_limits_change_while_it_runs_and_bad_ones_do_not():
    with ros_domain() as context:
        node = made(InverterGatewayNode, context, {"bus.interface": "virtual"})
        assert node.set_parameters([Parameter("torque_limit", value=100.0)])[0].successful
        assert node.station.p.torque_limit == 100.0
        refused = node.set_parameters([Parameter("torque_limit", value=2000.0)])[0]
        assert not refused.successful
        assert not node.set_parameters([Parameter("bus.interface", value="socketcan")])[
            0
        ].successful
        assert node.station.p.torque_limit == 100.0
        node.close()


def test_a_change_that_raises_half_way_is_taken_back(monkeypatch):
    """Both circuits have the parameters of before, and the node lives."""
    with ros_domain() as context:
        node = made(InverterNode, context, {"bus.interface": "virtual"})
        before, change = node.parameters, node.circuits["12"].change

        def fail(parameters):
            change(parameters)
            if parameters is not before:
                raise ValueError("too hot")

        monkeypatch.setattr(node.circuits["12"], "change", fail)
        refused = node.set_parameters([Parameter("drive.machine.torque_lag", value=0.05)])[0]
        assert (refused.successful, refused.reason) == (False, "too hot")
        assert node.parameters is before
        lags = [circuit.p.drive.machine.torque_lag for circuit in node.circuits.values()]
        assert lags == [before.drive.machine.torque_lag] * 2
        node.close()


def test_a_log_is_written(tmp_path: Path):
    file = tmp_path / "bus.log"
    with rig("logged", {"bus.log": str(file)}) as r:
        r.run(lambda: r.states() == {1.0})
    identifiers = {message.arbitration_id for message in can.LogReader(file)}
    assert {0x20B, 0x20C, 0x18B, 0x18C} <= identifiers


def test_a_file_names_no_log_outside_the_working_directory(tmp_path: Path, monkeypatch):
    """Only the command line names one elsewhere: a log from a file overwrites nothing there."""
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    file = tmp_path / "own.yaml"

    def gateway(log: str, *words: str) -> None:
        values = f"{{bus.interface: virtual, bus.log: {log}}}"
        file.write_text(f"/**/inverter_gateway:\n  ros__parameters: {values}\n")
        arguments = ["--ros-args", "--params-file", str(file), *words]
        with ros_domain() as context:
            InverterGatewayNode(context=context, namespace=NAMESPACE, cli_args=arguments).close()

    for log in ("../elsewhere.log", str(tmp_path / "elsewhere.log")):
        with pytest.raises(
            ValueError, match=r"^parameter bus.log: '\S+' is refused, expected from a file "
        ):
            gateway(log)
        assert not (tmp_path / "elsewhere.log").exists()
    gateway("own.log")
    gateway("own.log", "-p", f"bus.log:={tmp_path / 'elsewhere.log'}")
    assert (tmp_path / "here" / "own.log").exists()
    assert (tmp_path / "elsewhere.log").exists()


def test_a_file_opens_no_socket_to_a_network(tmp_path: Path):
    """Only the command line names a network: frames from any sender there command the drives."""
    file = tmp_path / "own.yaml"
    values = "{bus.interface: virtual, bus.address: 192.0.2.7}"
    file.write_text(f"/**/inverter_gateway:\n  ros__parameters: {values}\n")
    refused = r"bus\.address: '192.0.2.7' is refused, expected from a file 127.0.0.1; "
    can = ("test_bench", "method", "circuits_on_can")
    with pytest.raises(ParameterError, match=refused):
        load_scenario("urban_mixed_bench", Overrides([file], [can]))
    file.write_text(
        file.read_text().replace("address: 192.0.2.7", f"database: {tmp_path.parent / 'other.dbc'}")
    )
    with pytest.raises(
        ParameterError, match=r"bus\.database: '.*other.dbc' is refused, expected in "
    ):
        load_scenario("urban_mixed_bench", Overrides([file], [can]))
    file.write_text(f"/**/inverter_gateway:\n  ros__parameters: {values}\n")
    overrides = Overrides([file], [can, ("inverter_gateway", "bus.address", "192.0.2.8")])
    (run,) = load_scenario("urban_mixed_bench", overrides).runs
    assert run.configurations["inverter_gateway"].parameters.bus.address == "192.0.2.8"
    for words in ((), ("-p", "bus.address:=192.0.2.7")):
        arguments = ["--ros-args", "--params-file", str(file), *words]
        with (
            ros_domain() as context,
            nullcontext() if words else pytest.raises(ParameterError, match=refused),
        ):
            InverterGatewayNode(context=context, namespace=NAMESPACE, cli_args=arguments).close()


def test_set_points_that_waited_while_the_inverter_was_held_up_do_not_count_as_in_time(monkeypatch):
    """Held up for 50 ms under torque, with a time-out of 10 ms.

    The torque ends, though frames came all the time.
    """
    name = "held_up"
    bus = {
        "bus.interface": "virtual",
        "bus.channel_11": f"{name}_11",
        "bus.channel_12": f"{name}_12",
    }
    with ros_domain() as context:
        node = made(InverterNode, context, {**bus, **QUICK_CHARGE})
        drive, ecu = node.circuits["11"].s.drive, Bench()
        channel = Channel("virtual", f"{name}_11")
        drive.state, drive.dc_link.contactor = float(OPERATION_ENABLED), 1.0

        def send() -> None:
            values = TORQUE | {"Torque": 50.0, "Controlword": float(ENABLE_COMMAND)}
            channel.send(ecu.frame("Drive11", values))

        for _ in range(20):  # faster than cycles, so that no time-out can have passed
            send()
            node.take("11", node.channels._channels["11"].receive())
        drive.state = float(OPERATION_ENABLED)
        node.cycle(5)
        assert drive.torque > 40.0
        for _ in range(50):
            send()
        now = time.monotonic()
        monkeypatch.setattr("ev_bench.nodes.bus_nodes.time.monotonic", lambda: now + 0.05)
        node.poll()
        assert drive.torque == 0.0
        assert drive.state in (FAULT, FAULT_REACTION_ACTIVE)
        channel.close()
        node.close()
