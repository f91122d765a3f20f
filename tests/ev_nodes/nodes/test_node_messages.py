"""Nodes refuse messages that should not come, and commands that are too old."""

import math
import time
from array import array
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from helpers.patience import PATIENCE
from helpers.ros_graph import Probe, node_of, ros_domain

from ev_core.lockstep.finding import find_method
from ev_core.methods.method_record import create
from ev_core.methods.part import CalledBack
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.contract.frame import TIME, Frame
from ev_msgs_py.contract.signals import (
    DriverCommand,
    SteeringColumnState,
    WheelStates,
    WheelTorqueCommand,
    WheelTorqueRequest,
)
from ev_msgs_py.contract.stamps import from_seconds, to_seconds
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_nodes.node_loop import steps
from ev_nodes.node_loop.ordinary_steps import VARIABLE, is_switched_on
from ev_nodes.stepping.spinning import spin

pytestmark = pytest.mark.slow

PERIOD = 0.01
DRIVER = DriverCommand(drive_torque=100.0, brake_torque=0.0, hand_torque=1.0)
TURNED = SteeringColumnState(0.8, 0.1, 1.0, 0.02, 0.0)
STANDING = WheelStates(NO_WHEELS, NO_WHEELS, NO_WHEELS)


class Bench:
    """One node, and a probe that plays all the others."""

    def __init__(
        self, context: Any, name: str, says: tuple[type, ...], hears: type, **values: Any
    ) -> None:
        self.node = node_of(context, name, values)
        self.probe = Probe(context)
        self.heard = self.probe.listen(hears)
        writer = self.node.writers[hears].publisher
        mouths = [self.probe.publisher_of(signal) for signal in says]
        self.run(
            lambda: (
                writer.get_subscription_count() and all(m.get_subscription_count() for m in mouths)
            )
        )

    def run(self, until: Callable[[], Any]) -> None:
        deadline = time.monotonic() + PATIENCE

        def finished() -> bool:
            self.probe.look()
            assert time.monotonic() < deadline, f"{self.heard[-3:]}; {self.probe.reports}"
            return bool(until())

        spin([self.node], finished)

    def say(
        self, seconds: float, signal: Any, spoil: Callable[[Any], None] = lambda message: None
    ) -> None:
        message = self.probe.message(seconds, signal)
        spoil(message)
        self.probe.publisher_of(type(signal)).publish(message)

    def say_packed(self, seconds: float, *signals: Any) -> None:
        """Publish signals packed as our nodes pack them."""
        for signal in signals:
            self.probe.publisher_of(type(signal)).publish(self.probe.packed(seconds, signal))


@pytest.fixture(params=["1", "0"], ids=["compiled loop", "loop in Python"])
def law(request: Any, monkeypatch: pytest.MonkeyPatch) -> Iterator[Bench]:
    """A law with a memory, after its first step."""
    monkeypatch.setenv(VARIABLE, request.param)
    with ros_domain() as context:
        bench = Bench(
            context,
            "electronic_differential",
            (DriverCommand, WheelStates, SteeringColumnState),
            WheelTorqueRequest,
            method="steer_by_wire",
        )
        bench.say(0.0, DRIVER)
        bench.say(0.0, STANDING)
        bench.say(0.0, TURNED)
        bench.run(lambda: bench.heard)
        yield bench


def expected(steps: int) -> list[WheelTorqueRequest]:
    """Answers of the law to equal inputs step by step.

    Its integral makes each answer another one.
    """
    method = find_method("electronic_differential", "steer_by_wire")
    law = create(method, method.parameters(), Vehicle(), PERIOD)
    return [law.step(DRIVER, TURNED, STANDING) for _ in range(steps)]


def assert_goes_on_as_if_nothing_had_been(law: Bench) -> None:
    law.say(PERIOD, TURNED)
    law.run(lambda: len(law.heard) == 2)
    assert [to_seconds(stamp) for stamp, _ in law.heard] == [0.0, PERIOD]
    assert [signal for _, signal in law.heard] == expected(2)
    assert expected(2)[0] != expected(2)[1]


def set_number(field: str, value: float) -> Callable[[Any], None]:
    def spoil(message: Any) -> None:
        getattr(message, field)[0] = value

    return spoil


def set_names(*names: str) -> Callable[[Any], None]:
    def spoil(message: Any) -> None:
        message.name = list(names)

    return spoil


def shorten(message: Any) -> None:
    message.velocity = message.velocity[:1]


def lengthen(message: Any) -> None:
    message.name = [*message.name, "trailer"]
    for field in ("position", "velocity", "effort"):
        setattr(message, field, array("d", [*getattr(message, field), 0.0]))


SPOILT = {
    "NaN": (set_number("position", math.nan), "angle is nan"),
    "infinity": (set_number("velocity", math.inf), "rate is inf"),
    "a wrong name": (set_names("steering_wheel", "rear_wheels"), "rear_wheels"),
    "a name twice": (set_names("steering_wheel", "steering_wheel"), "road_wheels"),
    "a missing name": (set_names("steering_wheel"), "road_wheels"),
    "no names": (set_names(), "road_wheels"),
    "a missing number": (shorten, "velocity"),
    "a joint too many": (lengthen, "trailer"),
}


@pytest.mark.sampled
@pytest.mark.parametrize(("spoil", "named"), SPOILT.values(), ids=SPOILT)
def test_a_spoilt_message_is_reported_and_changes_nothing(law, spoil, named):
    law.say(PERIOD, DRIVER)
    law.say(PERIOD, STANDING)
    law.say(PERIOD, TURNED, spoil)
    law.run(lambda: law.probe.reports)
    (report,) = law.probe.reports
    assert report.startswith(
        "/ev/electronic_differential: steering_column/state at 0.01 s ignored: "
    )
    assert named in report
    assert_goes_on_as_if_nothing_had_been(law)


@pytest.mark.parametrize(
    ("brake", "named"),
    [(-2.0, "DriverCommand.brake_torque is -2.0, expected 0 or more"), (-1e-17, "")],
)
def test_a_negative_brake_torque_of_a_stranger_is_reported_and_changes_nothing(law, brake, named):
    """Packed as our nodes do it, so that the loop would take it; what rounding leaves is 0."""
    law.say_packed(PERIOD, STANDING, DRIVER._replace(brake_torque=brake))
    if named:
        law.run(lambda: law.probe.reports)
        (report,) = law.probe.reports
        assert report.endswith(f"driver/command at 0.01 s ignored: {named}")
        law.say_packed(PERIOD, DRIVER)
    assert_goes_on_as_if_nothing_had_been(law)
    assert not law.probe.reports[1:]


@pytest.mark.parametrize("seconds", [0.015, 0.03, 500.0])
def test_a_stamp_of_no_step_that_can_come_is_reported_once_and_changes_nothing(law, seconds):
    law.say(PERIOD, DRIVER)
    law.say(PERIOD, STANDING)
    law.say(seconds, TURNED)
    law.say(seconds, TURNED)
    law.run(lambda: law.probe.reports)
    assert_goes_on_as_if_nothing_had_been(law)
    (report,) = law.probe.reports
    assert f"steering_column/state at {seconds} s ignored (reported once): 0.01 s is due" in report


def test_a_graph_with_another_period_is_reported(law):
    """The driver leaves out the step that is due, as it does if its steps are twice as long.

    It will never come.
    """
    law.say(2 * PERIOD, DRIVER)
    law.run(lambda: law.probe.reports)
    (report,) = law.probe.reports
    assert "driver/command at 0.02 s ignored (reported once): 0.01 s is due" in report


def test_joints_in_another_order_are_read_by_name(law):
    """A stranger's node may list them as it likes."""

    def turn_round(message: Any) -> None:
        for field in ("name", "position", "velocity", "effort"):
            setattr(message, field, getattr(message, field)[::-1])

    law.say(PERIOD, DRIVER)
    law.say(PERIOD, STANDING)
    law.say(PERIOD, TURNED, turn_round)
    law.run(lambda: len(law.heard) == 2)
    assert [signal for _, signal in law.heard] == expected(2)
    assert law.probe.reports == []


class Stopping(CalledBack):
    """A part that fails at an instant."""

    def __init__(self, part: Any, instant: float) -> None:
        self.part, self.instant, self.state, self.notes = part, instant, None, part.notes

    def step(self, here: Frame, there: Frame) -> None:
        """That of the part, up to the instant."""
        if here.numbers[TIME] >= self.instant:
            raise SignalError("no further")
        self.part.step(here, there)


def test_ordinary_steps_are_taken_in_compiled_code_and_others_in_python(law, monkeypatch):
    """Both ways have the same numbers, and the node raises what a part raises.

    Switched off, all steps are taken in Python.
    """
    assert steps.CODE.address()  # compiled if it is not yet
    judged = []
    for reader in law.node.readers.values():
        receive = reader.receive_from
        monkeypatch.setattr(
            reader,
            "receive_from",
            lambda *taken, receive=receive: judged.append(taken) or receive(*taken),
        )
    for step in range(1, 4):
        law.say_packed(step * PERIOD, DRIVER, STANDING, TURNED)
        law.run(lambda step=step: len(law.heard) == step + 1)
    assert not judged and (law.node._ordinary is not None) == is_switched_on()
    law.say_packed(3 * PERIOD, DRIVER)  # once more: it asks for the answer
    law.run(lambda: len(law.heard) == 5)
    law.node.stepper.part = Stopping(law.node.stepper.part, 5 * PERIOD)
    law.say_packed(4 * PERIOD, DRIVER, STANDING, TURNED)
    law.run(lambda: len(law.heard) == 6)
    answers = expected(5)
    assert [signal for _, signal in law.heard] == [*answers[:4], answers[3], answers[4]]
    law.say_packed(5 * PERIOD, DRIVER, STANDING, TURNED)
    with pytest.raises(SignalError, match="no further"):
        law.run(lambda: False)


def test_an_answered_stamp_cannot_be_rewritten(law):
    """The driver is before the law.

    Its repeated stamp asks for the answer again, whatever it says now.
    """
    law.say(0.0, DriverCommand(-5.0, 0.0, 0.0))
    law.run(lambda: len(law.heard) == 2)
    assert [to_seconds(stamp) for stamp, _ in law.heard] == [0.0, 0.0]
    assert law.heard[0] == law.heard[1]


@pytest.fixture
def plant() -> Iterator[Bench]:
    """A car on the wall clock, on its wheels, with straight wheels."""
    with ros_domain() as context:
        says = (SteeringColumnState, WheelTorqueCommand)
        bench = Bench(context, "plant", says, WheelStates, mode="realtime", method="kinematic")
        bench.say(0.0, SteeringColumnState(0.0, 0.0, 0.0, 0.0, 0.0))
        repeated = bench.node.health.late_answers
        bench.run(lambda: bench.node.health.late_answers > repeated + 1)
        assert bench.node.now == 0  # it asks for the command, too
        bench.say(0.0, WheelTorqueCommand(Wheels.front(0.0, 0.0)))
        bench.run(lambda: bench.node.now > 0)
        yield bench


def driven(plant: Bench) -> list[int]:
    """Stamps of the states before which a drive torque acted."""
    return [stamp for stamp, wheels in plant.heard if wheels.effort.front_left != 0.0]


def command_while(plant: Bench, until: Callable[[], bool], **spoil: Any) -> int:
    """Send commands of 50 N m that are stamped now; the last stamp."""
    last = 0

    def has_enough() -> bool:
        nonlocal last
        if until():
            return True
        last = plant.node.now
        plant.say(to_seconds(last), WheelTorqueCommand(Wheels.front(50.0, 50.0)), **spoil)
        return False

    plant.run(has_enough)
    return last


def test_a_command_fades_until_it_is_as_old_as_may_be_and_drives_again_when_it_is_back(plant):
    """A state shows the torque of the period before it.

    50 N m up to 0.08 s, 25 N m up to 0.09 s, none at 0.1 s.
    """
    last = command_while(plant, lambda: len(driven(plant)) >= 5)
    plant.run(lambda: plant.heard[-1][0] > last + from_seconds(0.3))
    efforts = {
        stamp - last: wheels.effort.front_left for stamp, wheels in plant.heard if stamp > last
    }
    assert all(torque == 0.0 for age, torque in efforts.items() if age >= from_seconds(0.1))
    assert efforts[from_seconds(0.09)] <= 25.0 + 1e-9  # less where the wall clock was ahead
    before = len(driven(plant))
    command_while(plant, lambda: len(driven(plant)) > before)


def test_real_time_counts_what_it_does(plant):
    command_while(plant, lambda: len(driven(plant)) >= 3)
    plant.run(lambda: plant.node.schedule.timing.without_command)
    timing = plant.node.schedule.timing.as_json()
    assert (
        timing["steps"] == sum(timing["lateness"]["counts"]) == sum(timing["period"]["counts"]) + 1
    )
    assert sum(timing["arrival"]["torque_command"]["counts"]) >= 3
    plant.say(to_seconds(plant.node.now) + 5.0, WheelTorqueCommand(Wheels.front(50.0, 50.0)))
    plant.run(lambda: plant.node.schedule.timing.refused[WheelTorqueCommand] == 1)


def test_a_spoilt_command_counts_as_none(plant):
    start = plant.node.now
    command_while(
        plant,
        lambda: plant.node.now > start + from_seconds(0.2),
        spoil=set_number("effort", math.nan),
    )
    assert driven(plant) == []
    assert any(
        "torque_command" in report and "drive.front_left is nan" in report
        for report in plant.probe.reports
    )


def test_a_law_says_in_diagnostics_which_motors_it_does_not_trust():
    """The front left motor gives nothing of 100 N m, the right one its command of a step ago."""
    with ros_domain() as context:
        bench = Bench(
            context,
            "asr",
            (WheelTorqueRequest, WheelStates),
            WheelTorqueCommand,
            method="limp_home",
        )
        measured, lost = NO_WHEELS, []
        for step in range(20):
            states = WheelStates(NO_WHEELS, NO_WHEELS, measured)
            bench.say_packed(
                step * PERIOD, states, WheelTorqueRequest(Wheels.front(100.0, 100.0), NO_WHEELS)
            )
            bench.run(lambda step=step: len(bench.heard) == step + 1)
            measured = Wheels.front(0.0, bench.heard[-1][1].drive.front_right)
            lost.append(bench.node.health.counts()["lost"])
        assert lost[0] == "nothing" and lost[-1] == "motors.lost.front_left"
        bench.probe.health.clear()
        bench.run(lambda: bench.probe.health)
        (health,) = bench.probe.health.values()
        assert health["lost"] == "motors.lost.front_left" and health["method"] == "limp_home"
