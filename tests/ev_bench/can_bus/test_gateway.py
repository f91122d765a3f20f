"""The gateway: what it sends, what it believes, and how it leads an inverter."""

from __future__ import annotations

import math

import pytest
from can_bus.databases import ours
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_bench.inverter.circuit_station import CircuitStation
from ev_bench.inverter.device import CircuitParameters
from ev_bench.inverter_gateway.gateway import GatewayParameters
from ev_bench.inverter_gateway.panel import FAULTY, GOOD, SILENT, WARNED, diagnosis
from ev_bench.inverter_gateway.station import GatewayStation
from ev_core.lockstep.configuration import configure
from ev_core.parameters.values import build
from ev_msgs_py.can.drive_states import (
    ENABLE_COMMAND,
    FAULT,
    FAULT_REACTION_ACTIVE,
    FAULT_RESET,
    OPERATION_ENABLED,
    READY_TO_SWITCH_ON,
    REMOTE,
    SHUTDOWN,
    STATE_BITS,
    STATE_NAMES,
    SWITCH_ON_COMMAND,
    SWITCH_ON_DISABLED,
    SWITCHED_ON,
)
from ev_msgs_py.can.frame_length import Frame
from ev_msgs_py.can.frames import DEVICES, DRIVES, SPEED_MODE, TORQUE_MODE
from ev_msgs_py.can.payload import checksum, counter_of, next_counter
from ev_msgs_py.refusal import ParameterError

RPM = math.pi / 30.0


class FedGateway:
    """A gateway in a loop with feedback that the test sets."""

    def __init__(self, **values) -> None:
        self.station = GatewayStation(ours(), build(GatewayParameters, values))
        self.state = dict.fromkeys(DEVICES, SWITCH_ON_DISABLED)
        self.counters = dict.fromkeys(DEVICES, 0)
        self.sent: dict[str, dict[str, float]] = {}
        self.silent: set[str] = set()
        self.released: set[str] = set()

    def motion(self, name: str) -> Frame:
        layout = ours()[f"{name}_Motion"]
        values = {
            "CommandCheck": 0.0,
            "Torque": 10.0,
            "Speed": 600.0,
            "Statusword": float(
                STATE_BITS[self.state[name]] | (REMOTE if name in self.released else 0)
            ),
        }
        self.counters[name] = next_counter(self.counters[name])
        return Frame(layout.identifier, layout.pack(values, self.counters[name]))

    def cycle(self, ticks: int = 1, commanded: bool = True) -> None:
        by_identifier = {layout.identifier: layout for layout in ours()}
        for _ in range(ticks):
            for name in DEVICES:
                if name not in self.silent:
                    self.station.receive(name[-2:], self.motion(name))
            if commanded:
                self.station.command("Drive11", TORQUE_MODE, 100.0)
                self.station.command("Drive12", TORQUE_MODE, -1000.0)
                self.station.command("Load11", SPEED_MODE, 50.0)
                self.station.command("Load12", TORQUE_MODE, 5.0)
            for _, frame in self.station.step():
                layout = by_identifier[frame.identifier]
                self.sent[layout.name] = layout.values(int.from_bytes(frame.data, "little"))


def test_everything_it_sends_is_protected_and_counted():
    station, counters = GatewayStation(ours(), GatewayParameters()), {}
    by_identifier = {layout.identifier: layout for layout in ours()}
    for _ in range(40):
        for circuit, frame in station.step():
            layout, payload = by_identifier[frame.identifier], int.from_bytes(frame.data, "little")
            assert payload & 0xFF == checksum(payload, layout.length, layout.data_id)
            assert counters.get((circuit, layout.name), 14) == (counter_of(payload) - 1) % 15
            counters[circuit, layout.name] = counter_of(payload)
    assert len(counters) == 6  # a set-point for each device, a heartbeat on each channel


def test_it_leads_a_drive_by_its_states_and_commands_no_torque_on_the_way():
    gateway = FedGateway()
    gateway.cycle(3)
    assert gateway.sent["Drive11_SetPoint"]["Controlword"] == 0.0
    assert gateway.station.enable(("Drive11",)) == ""
    for state, word in (
        (SWITCH_ON_DISABLED, SHUTDOWN),
        (READY_TO_SWITCH_ON, SWITCH_ON_COMMAND),
        (SWITCHED_ON, ENABLE_COMMAND),
    ):
        gateway.state["Drive11"] = state
        gateway.cycle()
        assert gateway.sent["Drive11_SetPoint"]["Controlword"] == word
        assert gateway.sent["Drive11_SetPoint"]["Torque"] == 0.0
    gateway.state["Drive11"] = OPERATION_ENABLED
    gateway.cycle()
    assert gateway.sent["Drive11_SetPoint"] == {
        "Mode": 1.0, "Direction": 0.0, "Controlword": ENABLE_COMMAND, "Torque": 100.0, "Speed": 7500.0,
        "TorqueLimit": 360.0,
    }  # fmt: skip
    assert gateway.sent["Drive12_SetPoint"]["Torque"] == 0.0  # it was not enabled


def test_one_drive_alone_is_enabled_once_the_other_one_says_that_it_is_not_released():
    """Bit 9 of the statusword decides.

    Before ten cycles are over, both could be meant; then the released one is enabled alone.
    """
    gateway = FedGateway()
    gateway.released = {"Drive12"}
    gateway.station.s.waits = 1.0
    gateway.cycle(10)
    enabled = {name: device.enable for name, device in gateway.station.devices.items()}
    assert enabled == {"Drive11": 0.0, "Drive12": 0.0, "Load11": 1.0, "Load12": 1.0}
    gateway.cycle(3)
    assert (gateway.station.s.drive_11.enable, gateway.station.s.drive_12.enable) == (0.0, 1.0)
    assert gateway.station.s.waits == 0.0


def test_a_drive_that_offers_it_holds_a_speed_over_the_bus():
    """A drive goes from rest through pre-charge and states to 50 rad/s.

    The tolerance is the 0.5 rpm that the bus resolves.
    """
    values = {
        "drive.offers_speed_mode": True,
        "drive.speed_gain": 10.0,
        "drive.speed_integral_time": 0.05,
    }
    values["drive.dc_link.precharge_resistance"] = 10.0
    circuit = CircuitStation(ours(), "11", build(CircuitParameters, values))
    station = GatewayStation(ours(), GatewayParameters())
    for tick in range(400):
        station.command("Drive11", SPEED_MODE, 50.0)
        if tick == 20:
            assert station.enable(("Drive11",)) == ""
        for name, frame in station.step():
            if name == "11":
                circuit.receive(frame)
        for frame in circuit.step():
            station.receive("11", frame)
    feedback = station.devices["Drive11"].feedback
    assert feedback.state == OPERATION_ENABLED
    assert feedback.speed == pytest.approx(50.0, abs=0.5 * RPM)


def test_torque_is_limited_and_a_load_machine_gets_its_speed():
    gateway = FedGateway()
    gateway.cycle(3)
    gateway.state = dict.fromkeys(DEVICES, OPERATION_ENABLED)
    assert gateway.station.enable(DEVICES) == ""
    gateway.cycle(2)
    assert gateway.sent["Drive12_SetPoint"]["Torque"] == -360.0
    assert gateway.sent["Load11_SetPoint"]["Mode"] == 2.0
    assert gateway.sent["Load11_SetPoint"]["Speed"] * RPM == pytest.approx(50.0, abs=0.25 * RPM)


def test_feedback_is_taken_in_si_units():
    gateway = FedGateway()
    gateway.cycle(3)
    feedback = gateway.station.devices["Drive11"].feedback
    assert feedback.torque == 10.0
    assert feedback.speed == pytest.approx(600.0 * RPM)


def test_enabling_is_refused_with_the_reason():
    gateway = FedGateway()
    assert (
        gateway.station.enable(("Drive11",)) == "Drive11 is silent: no valid feedback within 0.01 s"
    )
    gateway.cycle(3, commanded=False)
    assert gateway.station.enable(("Drive11",)) == "Drive11 has no command: none within 0.1 s"
    gateway.cycle(3)
    assert gateway.station.enable(("Drive11",)) == ""
    gateway.state["Drive11"] = FAULT
    gateway.cycle(2)
    assert gateway.station.enable(("Drive11",)) == "Drive11 has a latched fault: reset it first"


def test_damaged_feedback_is_not_believed():
    gateway = FedGateway()
    gateway.cycle(3)
    gateway.silent = set(DEVICES)
    wrong = gateway.motion("Drive11")
    gateway.station.receive(
        "11", Frame(wrong.identifier, bytes([wrong.data[0] ^ 1]) + wrong.data[1:])
    )
    gateway.station.receive("11", Frame(wrong.identifier, wrong.data[:7]))
    gateway.station.receive("12", gateway.motion("Drive11"))  # not its channel
    feedback = gateway.station.devices["Drive11"].feedback
    assert feedback.refused == 2.0
    gateway.cycle()
    assert feedback.age > 0.001


@pytest.mark.parametrize(("stops", "other"), [("drive", 1.0), ("both", 0.0)])
def test_a_fault_stops_its_drive_and_if_asked_for_the_other(stops: str, other: float):
    gateway = FedGateway(fault_stops=stops)
    gateway.cycle(3)
    gateway.state = dict.fromkeys(DEVICES, OPERATION_ENABLED)
    assert gateway.station.enable(("Drive11", "Drive12")) == ""
    gateway.cycle(2)
    gateway.silent = {"Drive11"}
    gateway.cycle(15)
    assert gateway.station.devices["Drive11"].enable == 0.0
    assert gateway.station.devices["Drive12"].enable == other
    assert gateway.sent["Ecu_Heartbeat"]["StaleDrive11"] == 1.0


def test_the_reset_begins_without_its_bit_so_that_it_can_rise_and_ends_in_time():
    gateway = FedGateway()
    gateway.cycle(3)
    gateway.state["Drive11"] = FAULT
    gateway.station.devices["Drive11"].tripped = 1.0
    gateway.station.reset()
    words = []
    for _ in range(250):
        gateway.cycle()
        words.append(gateway.sent["Drive11_SetPoint"]["Controlword"])
    assert words[:4] == [0.0] * 4
    assert words[10] == FAULT_RESET
    assert words[-1] == 0.0  # it gave up after 0.2 s, as the inverter stays in its fault
    assert gateway.station.devices["Drive11"].tripped == 1.0
    gateway.station.reset()
    gateway.cycle(12)
    gateway.state["Drive11"] = SWITCH_ON_DISABLED
    gateway.cycle(3)
    assert gateway.station.devices["Drive11"].tripped == 0.0


@pytest.mark.parametrize("state", [FAULT, FAULT_REACTION_ACTIVE])
@pytest.mark.parametrize("faulty", ["Drive11", "Drive12"])
def test_beside_a_drive_that_is_in_a_fault_from_before_the_other_one_stays_off(faulty, state):
    """Torque on one side alone would turn the car, as behind a gateway that ended without 00h."""
    gateway = FedGateway(auto_enable=True)
    gateway.state[faulty] = state
    gateway.cycle(20)
    drives = [gateway.station.devices[name] for name in DRIVES]
    assert [drive.enable for drive in drives] == [False, False]
    assert gateway.station.enable(DRIVES) == f"{faulty} has a latched fault: reset it first"
    assert [drive.enable for drive in drives] == [False, False]
    gateway.station.reset()
    gateway.state[faulty] = SWITCH_ON_DISABLED
    gateway.cycle(12)  # a reset takes two times 5 ms
    assert gateway.station.enable(DRIVES) == ""
    assert [drive.enable for drive in drives] == [True, True]


@given(*2 * [st.sampled_from(range(len(STATE_NAMES)))])
def test_both_drives_are_enabled_or_none_in_whatever_states_they_are_found(right, left):
    """Both have to follow their controlwords."""
    gateway = FedGateway(auto_enable=True)
    gateway.state |= {"Drive11": right, "Drive12": left}
    gateway.cycle(20)
    assert gateway.station.s.drive_11.enable is gateway.station.s.drive_12.enable


@pytest.mark.parametrize("press", [GatewayStation.disable, GatewayStation.reset])
@given(st.integers(0, 25), st.booleans(), st.booleans())
@settings(deadline=None)
def test_a_disabled_device_is_not_enabled_by_itself(press, cycles, loads, drives):
    """A device that was disabled stays so under `auto_enable`, in any cycle and after any commands.

    The load machines wait for nothing but their feedback and commands, so they are on before the
    drives have theirs.
    """
    gateway = FedGateway(auto_enable=True)
    for _ in range(cycles):
        gateway.cycle(commanded=loads and drives)
        if loads:
            gateway.station.command("Load11", SPEED_MODE, 50.0)
        if drives:
            gateway.station.command("Drive11", TORQUE_MODE, 100.0)
    press(gateway.station)
    for _ in range(250):  # longer than a reset may take
        gateway.cycle()
        assert all(device.enable == 0.0 for device in gateway.station.devices.values())
    assert gateway.station.enable(DEVICES) == ""
    gateway.cycle(3)
    assert all(device.enable == 1.0 for device in gateway.station.devices.values())


def test_diagnosis_by_level():
    gateway = FedGateway()
    device = gateway.station.devices["Drive11"]
    assert diagnosis(device, 0.01)[:2] == (SILENT, "no valid feedback")
    gateway.cycle(3)
    assert diagnosis(device, 0.01)[:2] == (GOOD, "switch on disabled")
    device.feedback.warning_bits = 1.0
    assert diagnosis(device, 0.01)[:2] == (WARNED, "switch on disabled: Derating")
    device.feedback.fault_bits = 32.0
    device.stale = 1.0
    assert diagnosis(device, 0.01)[:2] == (FAULTY, "switch on disabled: Trip, StaleFeedback")


def test_commands_that_are_no_numbers_are_refused():
    station = GatewayStation(ours(), GatewayParameters())
    with pytest.raises(ValueError, match="command of Drive11: nan is refused"):
        station.command("Drive11", TORQUE_MODE, math.nan)


def test_one_wheel_cannot_have_both_circuits():
    with pytest.raises(
        ParameterError, match="'front_left' is refused, it is the wheel of the other circuit"
    ):
        build(GatewayParameters, {"wheel_11": "front_left"})


def test_in_a_graph_the_right_circuit_has_a_right_wheel():
    """The bench has its circuits so.

    With the wheels exchanged each side would get the torque of the other one.
    """
    values = {"control_period": 0.005, "vehicle.gear_ratio": 7.4}
    configure("inverter_gateway", values)
    with pytest.raises(
        ParameterError,
        match="needs wheel_11 on the right and wheel_12 on the left, not front_left and f",
    ):
        configure(
            "inverter_gateway", {**values, "wheel_11": "front_left", "wheel_12": "front_right"}
        )
