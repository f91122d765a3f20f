"""The offline runner: order, both ends, and how it stops."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from helpers.toy_methods import ToyParameters, toy, toy_graph

from ev_core.lockstep.configuration import Configuration
from ev_core.methods.method_record import Method
from ev_msgs_py.contract.fields import SignalError, shape_of
from ev_msgs_py.contract.roles import MASTER, ROLES
from ev_msgs_py.contract.signals import (
    BatteryCondition,
    BodyVelocity,
    DriverCommand,
    Instant,
    WheelTorqueCommand,
    WheelTorqueRequest,
)
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.refusal import ParameterError
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import signal_hash
from ev_stack.running.offline import node_parameters
from ev_stack.scenarios.scenario import Overrides, load_scenario


def played_by(role: str, factory: type, reads: tuple[type, ...]) -> Configuration:
    return dataclasses.replace(
        toy(role), method=Method(role, "test", factory, reads, ToyParameters)
    )


class ClockDriver:
    """Writes the time, so that the recording shows which input each node had when."""

    def __init__(self, parameters, vehicle, period):
        pass

    def step(self, now: Instant) -> DriverCommand:
        return DriverCommand(now.time, 0.0, 0.0)


class Copy:
    """A differential that passes the driver's torque on at once."""

    def __init__(self, parameters, vehicle, period):
        pass

    def step(self, driver: DriverCommand) -> WheelTorqueRequest:
        return WheelTorqueRequest(Wheels.all(driver.drive_torque))


class Counter:
    """A column that counts its steps and shows the torque of the step before."""

    def __init__(self, parameters, vehicle, period):
        self.count, self.heard = 0, -1.0

    def outputs(self):
        (kind,) = ROLES["steering_column"].writes
        return (kind(float(self.count), self.heard, 0.0, 0.0, 0.0),)

    def advance(self, driver: DriverCommand) -> None:
        self.count, self.heard = self.count + 1, driver.drive_torque


def clockwork() -> dict[str, Configuration]:
    return {
        **toy_graph(),
        "driver": played_by("driver", ClockDriver, (Instant,)),
        "electronic_differential": played_by("electronic_differential", Copy, (DriverCommand,)),
        "steering_column": played_by("steering_column", Counter, (DriverCommand,)),
    }


def test_answers_arrive_at_once_and_integrated_states_one_step_later():
    """roles.py: an answer at t_k follows from t_k, an integrated state from up to t_k-1."""
    channels = run_offline(clockwork(), 0.03).channels
    times = [0.0, 0.01, 0.02, 0.03]
    assert channels["driver.command.drive_torque"].tolist() == times
    assert channels["torque_request.drive.rear_left"].tolist() == times
    assert channels["steering_column.state.angle"].tolist() == [0.0, 1.0, 2.0, 3.0]
    assert channels["steering_column.state.rate"].tolist() == [-1.0, 0.0, 0.01, 0.02]


@pytest.mark.parametrize(
    ("duration", "steps"), [(0.03, 3), (0.039, 3), (0.0299999999999, 3), (0.01, 1), (0.0, 0)]
)
def test_both_ends_are_recorded(duration, steps):
    """A duration between two steps ends with the step before.

    One that misses a step by rounding has it.
    """
    recording = run_offline(clockwork(), duration)
    assert recording.time.tolist() == [step / 100 for step in range(steps + 1)]
    assert {len(column) for column in recording.channels.values()} == {steps + 1}


def test_the_order_in_which_nodes_are_named_does_not_matter():
    configurations = toy_graph()
    backwards = dict(reversed(configurations.items()))
    assert signal_hash(run_offline(configurations, 0.5)) == signal_hash(run_offline(backwards, 0.5))


def test_the_same_run_gives_the_same_bits_again():
    configurations = load_scenario("shchur2019").runs[0].configurations
    first = signal_hash(run_offline(configurations, 0.5))
    assert signal_hash(run_offline(configurations, 0.5)) == first


def test_signals_are_recorded_as_they_are_carried():
    """BatteryState holds single precision, and so do all its readers."""
    seen = []

    class Watcher:
        def __init__(self, parameters, vehicle, period):
            pass

        def step(self, battery: BatteryCondition) -> WheelTorqueRequest:
            seen.append(battery.voltage)
            return WheelTorqueRequest(Wheels.all(0.0))

    law = played_by("electronic_differential", Watcher, (BatteryCondition,))
    channels = run_offline({**toy_graph(), "electronic_differential": law}, 0.05).channels
    assert channels["battery.voltage"].tolist() == seen
    # 24 bits of mantissa
    assert all(math.ldexp(math.frexp(value)[0], 24).is_integer() for value in seen)


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_law_that_gives_no_number_stops_the_run_in_one_line(bad):
    """The line names signal and field of the law, before another law stumbles over them."""

    class Wrong(Copy):
        def step(self, driver: DriverCommand) -> WheelTorqueRequest:
            bad_wheel = bad if driver.drive_torque == 0.02 else 0.0
            return WheelTorqueRequest(Wheels(0.0, bad_wheel, 0.0, 0.0))

    class Stumbling(Copy):
        def step(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
            return WheelTorqueCommand(Wheels.all(float(int(request.drive.front_right))))

    law = played_by("electronic_differential", Wrong, (DriverCommand,))
    asr = played_by("asr", Stumbling, (WheelTorqueRequest,))
    with pytest.raises(SignalError) as error:
        run_offline({**clockwork(), "electronic_differential": law, "asr": asr}, 0.1)
    message = f"WheelTorqueRequest.drive.front_right is {bad}, expected a finite number"
    assert str(error.value) == f"at 0.02 s: electronic_differential: {message}"


class Counting:
    """A plant with one output that counts, from `start` on."""

    def __init__(self, place: int, start: float) -> None:
        self._shapes = [shape_of(kind) for kind in ROLES[MASTER].writes]
        self.row = np.zeros(sum(shape.size for shape in self._shapes))
        self.row[place] = start
        self._place = place

    def outputs(self):
        ends = np.cumsum([shape.size for shape in self._shapes])[:-1]
        parts = [part.tolist() for part in np.split(self.row, ends)]
        return tuple(shape.signal_of(part) for shape, part in zip(self._shapes, parts, strict=True))

    def advance(self, command: WheelTorqueCommand) -> None:
        self.row[self._place] += 1.0


def counting(place: int, start: float) -> dict[str, Configuration]:
    made = played_by(MASTER, lambda *given: Counting(place, start), (WheelTorqueCommand,))
    return {**toy_graph(), MASTER: made}


@pytest.mark.parametrize("bad", [math.nan, math.inf])
def test_a_number_of_a_plant_that_is_none_stops_the_run_by_its_name(bad):
    with pytest.raises(SignalError, match=f"WheelStates.position.front_right is {bad}"):
        run_offline(counting(1, bad), 0.03)


@pytest.mark.filterwarnings("ignore:overflow")
def test_a_number_with_an_infinite_square_is_a_number():
    channels = run_offline(counting(1, 1e200), 0.01).channels
    assert channels["wheel_states.position.front_right"].tolist() == [1e200, 1e200]


def test_nodes_that_do_not_fit_together_do_not_start():
    with pytest.raises(ParameterError, match="control_period differs"):
        run_offline({**toy_graph(), "asr": toy("asr", period=0.02)}, 0.1)


def test_progress_ends_at_the_end_and_never_goes_back():
    times: list[float] = []
    run_offline(clockwork(), 2.5, times.append)
    assert times == sorted(times)
    assert times[0] == 0.0
    assert times[-1] == 2.5
    assert len(times) >= 3


def test_only_what_the_methods_write_is_recorded():
    class Blind(toy(MASTER).method.factory):
        writes = tuple(signal for signal in ROLES[MASTER].writes if signal is not BatteryCondition)

        def outputs(self):
            return self.speak(self.writes)

    reads = {"asr": (WheelTorqueRequest,), "electronic_differential": (DriverCommand, BodyVelocity)}
    configurations = toy_graph(test_bench=(WheelTorqueCommand,), **reads)
    plant = configurations[MASTER]
    blind = dataclasses.replace(plant, method=dataclasses.replace(plant.method, factory=Blind))
    channels = run_offline({**configurations, MASTER: blind}, 0.1).channels
    assert not set(TOPICS[BatteryCondition].channels) & set(channels)
    assert "wheel_states.effort.rear_right" in channels


LAW = """
from dataclasses import dataclass
from ev_core.law import *

@dataclass(frozen=True, slots=True)
class P:
    speeds: tuple[float, ...] = setting((1.0, 2.0), unit="m/s", about="of a table")
    more: tuple[float, ...] = setting((), unit="m/s", about="of another one")

@method("asr", "of_a_table")
def of_a_table(p: P, request: WheelTorqueRequest) -> WheelTorqueCommand:
    return WheelTorqueCommand(request.drive, request.brake)
"""


def test_an_empty_list_that_a_node_would_not_receive_is_refused(tmp_path):
    """ROS has no type for it, so the node would take the default in its place."""
    file = tmp_path / "law.py"
    file.write_text(LAW)

    def parameters(**lists: tuple[float, ...]) -> dict[str, object]:
        values = [("asr", "method", str(file)), *(("asr", *each) for each in lists.items())]
        (run,) = load_scenario("double_lane_change", Overrides((), values, 1.0)).runs
        return node_parameters(run, tmp_path, bag=False)["asr"]

    sent = parameters(speeds=(3.0,))
    assert sent["speeds"] == [3.0]
    # One that is empty by itself is so in the node, too.
    assert "more" not in sent
    with pytest.raises(ParameterError, match=r"^asr: parameter speeds: \[\] is refused, expected"):
        parameters(speeds=())
