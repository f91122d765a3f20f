"""The limits of the gateway: what it sends is within them, and what the machines then do."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from can_bus.databases import FILE, ours
from hypothesis import example, given, settings
from hypothesis import strategies as st

from ev_bench.bus.checking import TOLERANCES, CheckState, check, is_valid, no_new_data
from ev_bench.bus.parameters import load_database
from ev_bench.inverter.circuit_station import CircuitStation
from ev_bench.inverter.device import INJECTIONS, CircuitParameters, inject
from ev_bench.inverter_gateway.can import prepare
from ev_bench.inverter_gateway.gateway import (
    GatewayParameters,
    LockstepGatewayParameters,
    check_limits,
    most_torque,
)
from ev_bench.inverter_gateway.station import GatewayStation
from ev_core.parameters.values import build
from ev_msgs_py.can.drive_states import OPERATION_ENABLED
from ev_msgs_py.can.frame_length import Frame
from ev_msgs_py.can.frames import SPEED_MODE, TORQUE_MODE, bench_frames
from ev_msgs_py.can.payload import BitField, rounded_down
from ev_msgs_py.refusal import ParameterError

RPM = math.pi / 30.0
TORQUE_STEP, SPEED_STEP = 4.0, 0.5 * RPM  # of `TorqueLimit` and `Speed` in the frames
QUICK = {"dc_link.precharge_resistance": 10.0, "offers_speed_mode": True, "speed_gain": 10.0}
_ANY_CAR: Any = None  # `prepare` asks nothing of it
MODES = st.sampled_from([TORQUE_MODE, SPEED_MODE])
COMMANDS = st.floats(-2000.0, 2000.0)
TORQUE_LIMITS, SPEED_LIMITS = st.floats(TORQUE_STEP, 1000.0), st.floats(0.06, 1047.0)


class Loop:
    """The gateway and the circuit 11, each with the other's frames of the cycle before."""

    def __init__(self, torque: float, load_torque: float, speed: float) -> None:
        self.station = GatewayStation(ours(), GatewayParameters())
        self.limit(torque, load_torque, speed)
        values = {
            f"{of}.{name}": value for of in ("drive", "load") for name, value in QUICK.items()
        }
        self.circuit = CircuitStation(ours(), "11", build(CircuitParameters, values))
        self.s = self.circuit.s

    def limit(self, torque: float, load_torque: float, speed: float) -> None:
        """Go on with these limits."""
        values = {"torque_limit": torque, "load_torque_limit": load_torque, "speed_limit": speed}
        self.station.change(build(GatewayParameters, values))

    def cycle(self, commands: dict[str, tuple[int, float]]) -> dict[str, dict[str, float]]:
        """Do one cycle and return what goes out to each device of the circuit."""
        for name, (mode, value) in commands.items():
            self.station.command(name, mode, value)
        for name in commands:
            self.station.enable((name,))
        sent = {}
        for circuit, frame in self.station.step():
            if circuit == "11":
                sent.update(_read(frame))
                self.circuit.receive(frame)
        for frame in self.circuit.step():
            self.station.receive("11", frame)
        return sent


def _read(frame: Frame) -> dict[str, dict[str, float]]:
    for layout in ours():
        if layout.identifier == frame.identifier and layout.name.endswith("_SetPoint"):
            return {
                layout.name.partition("_")[0]: layout.values(int.from_bytes(frame.data, "little"))
            }
    return {}


@given(MODES, COMMANDS, TORQUE_LIMITS, SPEED_LIMITS, st.sampled_from(["Drive11", "Load11"]))
@example(SPEED_MODE, 100.0, 360.0, 10.0, "Load11")
@example(TORQUE_MODE, 300.0, 250.0, 10.0, "Drive11")
@example(TORQUE_MODE, -1000.0, 999.99, 1047.0, "Load11")
@settings(max_examples=200, deadline=None)
def test_what_is_sent_is_within_the_limits_by_less_than_a_step(mode, command, torque, speed, name):
    """Commands beyond the limits become the largest steps within them, in both modes and signs."""
    station = GatewayStation(
        ours(), GatewayParameters(torque_limit=torque, load_torque_limit=torque, speed_limit=speed)
    )
    device = station.devices[name]
    device.enable, device.feedback.state, device.feedback.age = 1.0, float(OPERATION_ENABLED), 0.0
    station.command(name, mode, command)
    sent: dict[str, dict[str, float]] = {}
    for _, frame in station.step():
        sent.update(_read(frame))
    values, rounding = sent[name], 1e-6  # of a step
    assert torque - TORQUE_STEP < values["TorqueLimit"] <= torque + rounding * TORQUE_STEP
    assert abs(values["Torque"]) <= values["TorqueLimit"]
    assert abs(values["Speed"]) * RPM <= speed + rounding * SPEED_STEP
    if mode == TORQUE_MODE or abs(command) >= speed:
        assert abs(values["Speed"]) * RPM > speed - SPEED_STEP * (1.0 + rounding)
    if mode == TORQUE_MODE and abs(command) >= torque:
        assert abs(values["Torque"]) == values["TorqueLimit"]


@given(
    MODES, COMMANDS, MODES, COMMANDS, TORQUE_LIMITS, TORQUE_LIMITS, SPEED_LIMITS,
    st.none() | st.tuples(st.sampled_from(["drive", "load"]), st.sampled_from(sorted(INJECTIONS))),
)  # fmt: skip
@example(TORQUE_MODE, 0.0, SPEED_MODE, 100.0, 360.0, 400.0, 10.0, None)
@example(TORQUE_MODE, 0.0, TORQUE_MODE, 100.0, 360.0, 4.5, 10.0, ("drive", "trip"))
@settings(max_examples=30, deadline=None)
def test_the_machines_keep_the_limits(
    drive_mode, drive, load_mode, load, torque, load_torque, speed, fault
):
    """Limits hold in every cycle, with a fault half-way and after they have become narrow.

    A shaft in speed mode swings beyond its set-point, here by a fifth at most. Torques fade out
    before the speed limit, within their lags of 1 and 2 ms and the cycle of the bus: 4 ms of both
    on 0.12 kg m^2. Narrow limits hold two cycles later, but for exp(-8) of the torque that is left
    16 ms later.
    """
    loop = Loop(torque, load_torque, speed)
    commands = {"Drive11": (drive_mode, drive), "Load11": (load_mode, load)}
    late = 0.004 * (min(torque, 360.0) + min(load_torque, 400.0)) / 0.12
    for tick in range(140):
        if tick == 100 and fault is not None:
            inject(getattr(loop.s, fault[0]).injected, (fault[1],))
        loop.cycle(commands)
        assert abs(loop.s.drive.torque) <= torque * (1.0 + 1e-9)
        assert abs(loop.s.load.torque) <= load_torque * (1.0 + 1e-9)
        assert abs(loop.s.speed) <= 1.2 * speed + late
    before = abs(loop.s.drive.torque), abs(loop.s.load.torque)
    loop.limit(TORQUE_STEP, TORQUE_STEP, speed)
    for _ in range(18):
        loop.cycle(commands)
    assert abs(loop.s.drive.torque) <= TORQUE_STEP + math.exp(-8.0) * before[0]
    assert abs(loop.s.load.torque) <= TORQUE_STEP + math.exp(-8.0) * before[1]


def test_a_load_machine_in_speed_mode_stays_below_the_speed_limit():
    """10 rad/s of 100 rad/s commanded: 95 rpm are sent, 95.5 rpm would be 10.0007 rad/s."""
    loop = Loop(360.0, 400.0, 10.0)
    for _ in range(1500):
        sent = loop.cycle({"Load11": (SPEED_MODE, 100.0)})
    assert sent["Load11"]["Speed"] == 95.0
    assert loop.s.speed == pytest.approx(95.0 * RPM, rel=1e-3)


@pytest.mark.parametrize(
    ("values", "text"),
    [
        (
            {"torque_limit": 1.9},
            "torque_limit: 1.9 is refused, expected 0 or at least 4 N m, the step of the frames",
        ),
        (
            {"load_torque_limit": 3.99},
            "load_torque_limit: 3.99 is refused, expected 0 or at least 4 N m",
        ),
        (
            {"speed_limit": 0.05},
            "speed_limit: 0.05 is refused, expected 0 or at least 0.05236 rad/s",
        ),
    ],
)
def test_a_limit_that_would_be_zero_on_the_bus_is_refused(values, text):
    """The nodes on a bus and the role of a run refuse it."""
    with pytest.raises(ParameterError) as refused:
        GatewayStation(ours(), build(GatewayParameters, values))
    assert text in str(refused.value)
    with pytest.raises(ParameterError) as refused:
        prepare(build(LockstepGatewayParameters, values), _ANY_CAR, 0.001)
    assert text in str(refused.value)


def test_a_limit_below_one_step_of_the_torque_is_refused():
    """Torque in steps of 10 N m, limit in steps of 4 N m: below 12 N m no torque goes out."""
    coarse = BitField(
        start=24.0,
        length=16.0,
        signed=1.0,
        scale=10.0,
        steps=0.1,
        offset=0.0,
        low=-1000.0,
        high=1000.0,
    )
    layout = replace(bench_frames(ours()).set_point, torque=coarse)
    with pytest.raises(
        ParameterError, match=r"torque_limit: 9.0 is refused, expected 0 or at least 12 N m"
    ):
        check_limits(layout, GatewayParameters(torque_limit=9.0))
    check_limits(layout, GatewayParameters(torque_limit=12.0))
    assert most_torque(layout, 12.0) == 10.0


def test_no_torque_at_all_may_be_asked_for():
    GatewayStation(
        ours(), GatewayParameters(torque_limit=0.0, load_torque_limit=0.0, speed_limit=0.0)
    )


def test_a_limit_that_is_a_step_stays_what_it_is():
    """Whole and half revolutions a minute come back from rad/s; a little less is a step below."""
    field = bench_frames(ours()).set_point.speed
    for steps in range(20000):
        there = 0.5 * steps * RPM / RPM
        assert rounded_down(field, there) == 0.5 * steps
        assert rounded_down(field, there - 1e-4) == 0.5 * (steps - 1)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_back_in_speed_mode_at_the_present_speed_there_is_no_jolt(sense: float):
    """A load machine that coasts in torque mode and is asked for its speed turns on.

    Friction takes 0.2 N m and the speed 0.05 rad/s in 10 ms; what held 200 N m would give 200 N m
    again.
    """
    loop = Loop(360.0, 400.0, 785.0)
    coasts = {"Drive11": (TORQUE_MODE, 0.0), "Load11": (TORQUE_MODE, 0.0)}
    for commands, cycles in (
        (coasts, 1000),  # until they are enabled
        ({"Drive11": (TORQUE_MODE, -200.0 * sense), "Load11": (SPEED_MODE, 100.0 * sense)}, 1500),
        (coasts, 300),
    ):
        for _ in range(cycles):
            loop.cycle(commands)
    speed = loop.s.speed
    assert speed * sense > 50.0
    for _ in range(100):
        loop.cycle({"Drive11": (TORQUE_MODE, 0.0), "Load11": (SPEED_MODE, speed)})
        assert abs(loop.s.load.torque) < 5.0
        assert loop.s.speed == pytest.approx(speed, abs=0.3)


@pytest.mark.parametrize(
    ("before", "after", "signal"),
    [
        ("(0.03125,0) [-1000|1000]", "(0.03125,0.02) [-1000|1000]", "Torque"),
        ("(0.03125,0) [-1000|1000]", "(0.03125,0) [5|1000]", "Torque"),
        ("(0.5,0) [-10000|10000]", "(0.5,0.3) [-10000|10000]", "Speed"),
        ("(4,0) [0|1000]", "(4,2) [2|1000]", "TorqueLimit"),
        (
            "Controlword : 16|8@1+ (1,0) [0|255]",
            "Controlword : 16|8@1+ (1,1) [1|255]",
            "Controlword",
        ),
    ],
)
def test_set_points_that_cannot_take_the_torque_away_are_refused(
    tmp_path: Path, before: str, after: str, signal: str
):
    """Zero between two steps would go out as the nearest one.

    Torque beyond a limit of 0, and no reset.
    """
    lines = FILE.read_text().splitlines()
    of, changed = "", []
    for line in lines:
        of = line.split()[2] if line.startswith("BO_ ") else of
        changed.append(line.replace(before, after) if of.endswith("_SetPoint:") else line)
    assert changed != lines
    file = tmp_path / "own.dbc"
    file.write_text("\n".join(changed) + "\n", encoding="cp1252")
    with pytest.raises(
        ParameterError,
        match=rf"^frame Drive11_SetPoint, signal {signal}: .* a signal that can be 0$",
    ):
        bench_frames(load_database(str(file)))


def test_a_database_with_an_offset_of_whole_steps_keeps_the_limits(tmp_path: Path):
    """100 N m are 3200 steps of 1/32 N m."""
    file = tmp_path / "own.dbc"
    text = FILE.read_text().replace("(0.03125,0) [-1000|1000]", "(0.03125,100) [-900|1000]")
    file.write_text(text, encoding="cp1252")
    layout = bench_frames(load_database(str(file))).set_point
    assert rounded_down(layout.torque, 360.0) == 360.0
    assert rounded_down(layout.torque, 0.0) == 0.0


@pytest.mark.parametrize("cycle", [1, 6, 7, 10])
def test_a_motion_that_comes_too_seldom_to_be_taken_is_refused(tmp_path: Path, cycle: int):
    """Up to 6 ms each frame is taken but the first two, by which a receiver synchronises.

    More seldom none is.
    """
    text = FILE.read_text()
    identifiers = re.findall(r"BO_ (\d+) \w+_Motion:", text)
    for identifier in identifiers:
        text = text.replace(
            f'"GenMsgCycleTime" BO_ {identifier} 1;', f'"GenMsgCycleTime" BO_ {identifier} {cycle};'
        )
    assert len(identifiers) == 4
    file = tmp_path / "own.dbc"
    file.write_text(text, encoding="cp1252")
    if cycle > 6:
        with pytest.raises(
            ParameterError,
            match=rf"^frame Drive11_Motion: a cycle of {cycle} ms is refused, expected",
        ):
            bench_frames(load_database(str(file)))
    else:
        assert bench_frames(load_database(str(file))).motion.ticks == cycle
    layout, state, taken = ours()["Drive11_Motion"], CheckState(), []
    for tick in range(20 * cycle):
        if tick % cycle:
            no_new_data(state)
        else:
            payload = int.from_bytes(
                layout.pack(dict.fromkeys(layout.signals, 0.0), tick // cycle % 15), "little"
            )
            taken.append(is_valid(check(TOLERANCES, state, payload, layout.length, layout.data_id)))
    assert taken[2:] == [cycle <= 6] * 18
