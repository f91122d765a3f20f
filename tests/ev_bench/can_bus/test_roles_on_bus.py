"""Both ends of a run in real time: the roles of the graph with frames on a bus.

And such a run by the script.
"""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import can
import pytest
from can_bus.databases import by_cantools
from can_bus.exact_bits import exact_frame
from can_bus.test_channels import FRAMES, received
from helpers.run_script import ENVIRONMENT, RUN

from ev_bench.bus.channel import BusMeter, Channel
from ev_bench.bus.model import BusModelParameters
from ev_bench.bus.parameters import BusParameters
from ev_bench.inverter_gateway.station import GatewayOnBus
from ev_bench.machines.bench_on_bus import BenchOnBus, meters_of
from ev_bench.runs import can as can_of_runs
from ev_core.parameters.values import build
from ev_msgs_py.can.payload import NO_FRAME, joined
from ev_msgs_py.contract.optional_signals import LoadCommand
from ev_msgs_py.contract.signals import BatteryCondition, WheelTorqueCommand
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_stack.recording.outcome import RunFailed
from ev_stack.scenarios.scenario import Overrides, load_scenario

TICKS = 5  # of 1 ms in a control period
TRIP, RESET, DRIVEN = 0.2, 0.3, 0.45  # [s]
VALUES = (
    ("*", "mode", "realtime"),
    ("test_bench", "method", "circuits_on_can"),
    ("test_bench", "dc_link.precharge_resistance", 20.0),
    ("test_bench", "load.dc_link.precharge_resistance", 20.0),
    ("test_bench", "inject.kind", "trip"),
    ("test_bench", "inject.begin", TRIP),
    ("test_bench", "inject.end", TRIP + 0.02),
    ("inverter_gateway", "reset_at", RESET),
)
COMMAND = WheelTorqueCommand(Wheels.front(74.0, 148.0), NO_WHEELS)  # 10 and 20 N m at the shafts
SPEED = 2.0  # rad/s, which the shafts reach from rest without much torque
LOAD = LoadCommand(Wheels.all(2.0), Wheels.front(SPEED, SPEED), NO_WHEELS)  # mode 2: speed
BATTERY = BatteryCondition(650.0, 0.0, 60.0, 60.0, 1.0)


class Ends:
    """Gateway and bench, frames exchanged cycle by cycle, and the signals of each instant."""

    def __init__(self, waits: int = 7, values: tuple[tuple[str, str, Any], ...] = VALUES) -> None:
        (run,) = load_scenario("urban_mixed_bench", Overrides(values=values)).runs
        self.configurations = run.configurations
        self.meters = meters_of("can/ev_bench.dbc")
        self.bench = BenchOnBus(run.configurations["test_bench"], self.meters)
        self.stamp = 0
        self.gateway = GatewayOnBus(run.configurations["inverter_gateway"], lambda: self.stamp)
        self.signals: list[dict[str, Any]] = []
        for _ in range(waits):  # some time goes by before the graph is there
            self.cycle()

    def cycle(self, ticks: int = 1) -> None:
        ends = (self.gateway, self.bench)
        frames = [end.cycle(ticks) for end in ends]
        for sent, other in zip(frames, reversed(ends), strict=True):
            for circuit, frame in sent:
                self.meters[circuit].note(frame.identifier, frame.data)
                other.receive(circuit, frame)

    def instants(self, duration: float, commanded: bool = True) -> None:
        for _ in range(round(duration / (0.001 * TICKS))):
            self.stamp += commanded
            shafts, *_, feedback, states = self.bench.outputs()
            asked = self.gateway.step(COMMAND, LOAD, feedback, shafts)
            self.signals.append(
                {"shafts": shafts, "asked": asked, "feedback": feedback, "states": states}
            )
            self.bench.advance(asked, BATTERY)
            for _ in range(TICKS):
                self.cycle()


@pytest.fixture(scope="module")
def driven() -> Ends:
    """Both ends behind the reset, to look at; a test that goes on makes ends of its own."""
    ends = Ends()
    ends.instants(DRIVEN)
    return ends


def at(driven: Ends, time: float) -> dict[str, Any]:
    return driven.signals[round(time / (0.001 * TICKS))]


def test_torques_and_speeds_go_over_the_bus_and_back_into_the_graph(driven):
    """Right 20 and left 10 N m against load machines that hold their speed.

    To a tenth of the transducer's error.
    """
    shafts = at(driven, TRIP - 0.01)["shafts"]
    assert shafts.torque[:2] == pytest.approx((10.0, 20.0), abs=0.1)
    assert shafts.load_speed[:2] == pytest.approx((SPEED, SPEED), abs=0.1)
    assert at(driven, 0.02)["shafts"].torque[1] == 0.0  # until pre-charge and states are through


def test_a_fault_is_there_at_its_time_latched_and_gone_after_the_reset(driven):
    """A fault acts within a cycle.

    Its mean over a period arrives at the next instant but one. The other drive keeps its torque.
    """
    after = at(driven, TRIP + 0.015)["shafts"]
    assert after.machine_torque[1] == 0.0
    assert after.machine_torque[0] == pytest.approx(10.0, abs=0.1)
    assert at(driven, RESET)["shafts"].machine_torque[1] == 0.0
    assert driven.signals[-1]["shafts"].machine_torque[:2] == pytest.approx((10.0, 20.0), abs=0.1)
    assert driven.gateway.reports() == ("right drive: Trip",)


def test_the_signals_are_the_frames_of_the_cycles_before(driven):
    """Read by cantools: five set-points in a row, and what the drive answered.

    All that is loaded on the bus counts.
    """
    instant = at(driven, TRIP - 0.01)
    read = by_cantools().decode_message
    asked = [
        read("Drive11_SetPoint", joined(*instant["asked"][n : n + 2]).to_bytes(8, "little"))
        for n in range(0, 10, 2)
    ]
    assert [frame["Torque"] for frame in asked] == [20.0] * TICKS
    first = asked[0]["Counter"]
    assert [frame["Counter"] for frame in asked] == [(first + n) % 15 for n in range(TICKS)]
    heard = read("Drive11_Motion", joined(*instant["feedback"][8:10]).to_bytes(8, "little"))
    assert heard["Torque"] == pytest.approx(20.0, abs=0.1)
    assert 0.4 < instant["states"].load_11 < 0.606  # 60.6 % if each frame were as long as it can be
    assert instant["states"].lost_11 == 0.0


BUTTON = 0.25  # s, later than the fault and before the reset


@pytest.mark.parametrize("waits", [7, 600])
def test_buttons_and_faults_count_from_the_first_instant(waits):
    """Nothing is pressed, and nothing is wrong, until their times, however long the bus runs."""
    ends = Ends(
        waits,
        (
            *VALUES,
            ("inverter_gateway", "auto_enable", False),
            ("inverter_gateway", "enable_at", BUTTON),
        ),
    )
    gateway = ends.gateway.station.s
    assert (gateway.waits, gateway.drive_11.reset_time) == (0.0, -1.0)
    ends.instants(TRIP)
    assert ends.gateway.reports() == ()
    assert (gateway.drive_11.enable, gateway.drive_12.enable) == (0.0, 0.0)
    ends.instants(BUTTON - TRIP)
    assert "right drive: Trip" in ends.gateway.reports()
    assert gateway.drive_12.enable == 0.0
    ends.instants(0.01)
    assert (gateway.waits, gateway.drive_12.enable) != (0.0, 0.0)


def test_a_frame_behind_the_first_instant_meets_no_fault_of_later():
    """The time before the first instant counts for no fault, in the cycle of that instant, too."""
    begin, end = 0.2, 0.3  # [s]
    fault = (
        ("test_bench", "inject.kind", "wrong_counter"),
        ("test_bench", "inject.begin", begin),
        ("test_bench", "inject.end", end),
    )
    ends = Ends(waits=round(1e3 * (begin + end) / 2), values=(*VALUES, *fault))
    _, *_, feedback, _ = ends.bench.outputs()
    asked = ends.gateway.step(COMMAND, LOAD, feedback, ends.bench.outputs()[0])
    ends.bench.advance(asked, BATTERY)
    for circuit, frame in ends.gateway.cycle(1):
        ends.bench.receive(circuit, frame)
    # A frame that the fault would repeat is kept in its state.
    assert ends.bench.given["s"].line_11.fault.low == NO_FRAME


def test_a_station_with_the_state_of_another_goes_on():
    """A parameter that changes in a run does not repeat a fault of the past."""
    driven = Ends()
    driven.instants(DRIVEN)
    bench = BenchOnBus(driven.configurations["test_bench"], driven.meters)
    bench.state = driven.bench.state
    bench.go_on_from(driven.bench)
    for _ in range(TICKS):
        bench.cycle(1)
    bench.advance(driven.signals[-1]["asked"], BATTERY)
    assert bench.outputs()[0].load_speed[1] == pytest.approx(SPEED, abs=0.1)
    gateway = GatewayOnBus(driven.configurations["inverter_gateway"], lambda: 1)
    gateway.state = driven.gateway.state
    gateway.go_on_from(driven.gateway)
    gateway.step(COMMAND, LOAD, driven.signals[-1]["feedback"], driven.signals[-1]["shafts"])
    assert gateway.station.s.tick == driven.gateway.station.s.tick


@pytest.mark.sampled
@pytest.mark.parametrize("cycle", range(TICKS + 1))
def test_a_change_in_any_cycle_of_a_period_leaves_what_is_measured(cycle):
    """Means are those of all cycles since the last instant, over both benches.

    A lost set-point stays counted.
    """
    ends = Ends(values=tuple(each for each in VALUES if not each[1].startswith("inject")))
    ends.instants(0.25)
    circuit = ends.bench._circuits["11"]
    circuit.inverters[0].lost = 3.0
    before, asked = ends.bench.outputs(), ends.signals[-1]["asked"]
    ends.bench.advance(asked, BATTERY)
    for tick in range(TICKS + 1):
        if tick == cycle:
            after = BenchOnBus(
                ends.configurations["test_bench"].changed({"cooling": False}), ends.meters
            )
            after.state = ends.bench.state
            after.go_on_from(ends.bench)
            ends.bench = after
            assert after.outputs()[0].torque[:2] == pytest.approx((10.0, 20.0), abs=0.1)
        if tick < TICKS:
            ends.cycle()
    ends.bench.advance(asked, BATTERY)
    (shafts, electrical, *_, states), (was, electrical_then, *_) = ends.bench.outputs(), before
    assert shafts.torque == pytest.approx(was.torque, abs=1e-3)
    assert shafts.machine_torque == pytest.approx(was.machine_torque, abs=1e-3)
    assert electrical.current == pytest.approx(electrical_then.current, abs=1e-3)
    assert states.lost_11 == 3.0


@pytest.mark.parametrize("held", [1, 6, 20, 50])
def test_a_bench_that_was_held_up_measures_what_its_machines_give(held):
    """Means of the cycles that it made: those that are lost give nothing, and show nothing."""
    values = [each for each in VALUES if not each[1].startswith("inject")]
    values += [("test_bench", f"{of}command_timeout", 1.0) for of in ("", "load.")]
    ends = Ends(values=tuple(values))
    ends.instants(0.25)
    asked = ends.signals[-1]["asked"]
    ends.bench.advance(asked, BATTERY)
    ends.bench.cycle(held)
    ends.bench.advance(asked, BATTERY)
    shafts = ends.bench.outputs()[0]
    assert shafts.machine_torque[:2] == pytest.approx((10.0, 20.0), abs=0.1)
    assert shafts.torque[:2] == pytest.approx((10.0, 20.0), abs=0.1)


def test_a_command_that_is_held_from_before_gets_too_old():
    """Torques stop after `command_timeout`, 0.1 s, though time and load machines go on."""
    ends = Ends()
    ends.instants(DRIVEN)
    ends.instants(0.09, commanded=False)
    assert ends.signals[-1]["shafts"].machine_torque[1] == pytest.approx(20.0, abs=0.1)
    ends.instants(0.03, commanded=False)
    assert ends.signals[-1]["shafts"].machine_torque[:2] == (0.0, 0.0)
    assert "right drive: StaleCommand" in ends.gateway.reports()


def test_a_change_of_a_parameter_makes_no_command_fresh():
    """A law that is dead stays so.

    Its last torques stop after `command_timeout`, however often a parameter changes.
    """
    ends = Ends()
    ends.instants(0.15)
    assert ends.signals[-1]["shafts"].machine_torque[0] == pytest.approx(10.0, abs=0.1)
    for _ in range(3):
        after = GatewayOnBus(ends.configurations["inverter_gateway"], lambda: ends.stamp)
        after.state = ends.gateway.state
        after.go_on_from(ends.gateway)
        ends.gateway = after
        ends.instants(0.05, commanded=False)
    assert ends.signals[-1]["shafts"].machine_torque[0] == 0.0
    assert "left drive: StaleCommand" in ends.gateway.reports()


def test_an_instant_without_a_cycle_repeats_the_one_before():
    ends = Ends()
    ends.instants(0.02)
    ends.bench.advance(ends.signals[-1]["asked"], BATTERY)
    before = ends.bench.outputs()
    ends.bench.advance(ends.signals[-1]["asked"], BATTERY)
    assert ends.bench.outputs() == before


def test_a_meter_counts_all_bits_and_times_what_is_awaited():
    meter = BusMeter([FRAMES[0].identifier])
    meter.note(*FRAMES[0], 0.001)
    meter.note(*FRAMES[1], 0.5)
    assert meter.bits == sum(exact_frame(*frame) for frame in FRAMES[:2])
    assert meter.latency == 0.001


def _run_on(bus: BusParameters, of_bench: BusModelParameters) -> Any:
    both = zip(("inverter_gateway", "test_bench"), (bus, of_bench), strict=True)
    ends = {role: SimpleNamespace(parameters=SimpleNamespace(bus=each)) for role, each in both}
    return SimpleNamespace(name="hub", realtime=True, configurations=ends)


@pytest.mark.parametrize(
    ("name", "value"),
    [("interface", "socketcand"), ("channel_11", "239.1.1.1:2000"), ("channel_12", "can1")],
)
def test_a_bus_of_the_bench_alone_is_refused(name, value, tmp_path):
    """Both ends have that of the gateway: another one would be taken and never used."""
    run = _run_on(BusParameters(), build(BusModelParameters, {name: value}))
    line = f"^test_bench.bus.{name}: '{value}' is refused, expected '.*', as of inverter_gateway"
    with pytest.raises(RunFailed, match=line), can_of_runs.real_bus(run, 1, tmp_path):
        pass


def test_a_second_run_of_a_domain_does_not_share_the_bus(monkeypatch, tmp_path):
    """A run in another namespace would take the set-points of the first one, and send its own."""
    monkeypatch.setattr(can_of_runs, "_works", lambda channel: True)
    run = _run_on(BusParameters(), BusModelParameters())
    line = "^ROS domain 2 has a run with a bus in real time already"
    with can_of_runs.real_bus(run, 2, tmp_path) as first:
        with can_of_runs.real_bus(run, 3, tmp_path) as other:
            assert first["test_bench"]["bus.channel_11"] != other["test_bench"]["bus.channel_11"]
        with pytest.raises(RunFailed, match=line), can_of_runs.real_bus(run, 2, tmp_path):
            pass
        named = _run_on(
            build(BusParameters, {"channel_11": "239.1.1.1:2000", "channel_12": "239.1.1.2:2000"}),
            BusModelParameters(),
        )
        with can_of_runs.real_bus(named, 2, tmp_path):
            pass
    with can_of_runs.real_bus(run, 2, tmp_path):
        pass


@pytest.mark.slow
def test_without_multicast_a_run_has_a_hub_of_its_own(monkeypatch, tmp_path: Path):
    """Socketcand's protocol over TCP on 127.0.0.1; the hub ends with the run."""
    monkeypatch.setattr(can_of_runs, "_works", lambda channel: False)
    run = _run_on(BusParameters(), BusModelParameters())
    with can_of_runs.real_bus(run, 1, tmp_path) as parameters:
        values = parameters["test_bench"]
        assert values["bus.interface"] == "socketcand" and "@127.0.0.1:" in values["bus.channel_11"]
        one, other = (Channel("socketcand", values["bus.channel_11"]) for _ in range(2))
        one.send(FRAMES[0])
        assert received(other, 1) == FRAMES[:1]
        one.close()
        other.close()
    assert parameters["test_bench"] == parameters["inverter_gateway"]


@pytest.mark.slow
@pytest.mark.weekly
def test_a_run_in_real_time_has_its_frames_on_a_real_bus(tmp_path: Path):
    """Gateway and inverters in processes of their own over udp_multicast.

    The log has the frames of both ends.

    Time-outs are none here: a loaded machine holds processes up for longer than those of a bus.
    """
    values = [
        "*.control_period=0.005",
        "test_bench.command_timeout=1",
        "test_bench.load.command_timeout=1",
    ]
    values += [
        f"inverter_gateway.{each}"
        for each in ("feedback_timeout=1", "command_timeout=10", "bus.log=bus.log")
    ]
    words = [str(RUN), "bench_fault", "--realtime", "--duration", "1"]
    words += ["--no-report", "--no-record", "--out", str(tmp_path)]
    for value in values:
        words += ["--set", value]
    subprocess.run(words, env=ENVIRONMENT, check=True, capture_output=True)
    content = json.loads((tmp_path / "summary.json").read_text())
    measured = content["metrics"]
    assert measured["bus_11_load"]["value"] > 0.01
    assert 0.0 < measured["bus_11_longest_latency"]["value"] < 1.0
    logged = {message.arbitration_id for message in can.LogReader(tmp_path / "bus.log")}
    names = {by_cantools().get_message_by_frame_id(identifier).name for identifier in logged}
    assert {
        "Drive11_SetPoint",
        "Load12_SetPoint",
        "Drive11_Motion",
        "Load12_Motion",
        "Ecu_Heartbeat",
    } <= names
    assert not [text for text in content["notes"] if "StaleFeedback" in text]
