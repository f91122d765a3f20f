"""Real time that a service has stopped.

A rest ages no command and is no period, by a clock that the test turns.
"""

from __future__ import annotations

import time

import pytest
from helpers.ros_graph import node_of, ros_domain
from std_srvs.srv import Trigger

from ev_msgs_py.contract import frame
from ev_msgs_py.contract.signals import SteeringColumnState, WheelTorqueCommand

pytestmark = pytest.mark.slow

EFFORT = frame.channels()["wheel_states.effort.front_left"]
TORQUE = 50.0  # N m


def test_a_car_drives_on_behind_a_rest_and_in_single_steps(monkeypatch):
    """The held command goes on: none comes while time stands still, for hours if need be."""
    wall = [time.monotonic()]
    with ros_domain() as context:
        plant = node_of(context, "plant", {"mode": "realtime", "method": "kinematic"})
        monkeypatch.setattr(time, "monotonic", lambda: wall[0])

        def efforts(seconds: float) -> list[float]:
            """Efforts in the states of so many seconds.

            The others answer to each with a command.
            """
            found, end = [], wall[0] + seconds
            while wall[0] < end:
                wall[0] += 0.005
                before = plant.now
                plant.idle()
                if plant.now > before:
                    found.append(plant.stepper.answer.frame.numbers[EFFORT])
                    say()
            return found

        def say() -> None:
            plant.schedule.hold(SteeringColumnState, plant.stepper.answer.stamp, [0.0] * 5)
            plant.schedule.hold(
                WheelTorqueCommand, plant.stepper.answer.stamp, [TORQUE, TORQUE, *[0.0] * 6]
            )

        def call(service: str) -> None:
            (found,) = [each for each in plant.services if each.srv_name.endswith(f"/{service}")]
            found.callback(Trigger.Request(), Trigger.Response())

        plant.schedule.note_recorded(0)
        say()
        assert set(efforts(0.1)[1:]) == {TORQUE}
        for rest in (0.2, 3600.0):
            call("pause")
            assert efforts(0.2) == []
            wall[0] += rest
            call("step")
            assert efforts(0.2) == [TORQUE]
            wall[0] += rest
            call("step")
            call("step")
            assert efforts(0.2) == [TORQUE] * 2
            wall[0] += rest
            call("resume")
            assert set(efforts(0.1)) == {TORQUE}
        timing = plant.schedule.timing.as_json()
        assert timing["without_command"] == timing["overruns"] == 0
        assert timing["period"]["largest"] < 0.02
        simulated, driven = (
            float(each.split(" s")[0]) for each in plant.schedule.summary.split(" simulated in ")
        )
        assert driven < 2.0 * simulated
        call("reset")
        call("pause")
        stale = plant.stepper.answer.stamp - plant.stepper.inbox.run
        plant.schedule.hold(WheelTorqueCommand, stale, [TORQUE, TORQUE, *[0.0] * 6])
        assert plant.schedule.held.stamp_of(WheelTorqueCommand) == -1, "a command of the run before"
        plant.destroy_node()


def test_a_recorder_that_is_ahead_of_the_present_is_not_believed():
    """It still holds what a master before has sent.

    To be believed it has to see that another one counts from zero.
    """
    with ros_domain() as context:
        plant = node_of(context, "plant", {"method": "kinematic", "await_recorder": True})
        schedule, period = plant.schedule, plant.stepper.period
        for stale in (20 * period, period):
            schedule.note_recorded(stale)
            assert schedule.recorder_is_behind and not schedule.recorder_keeps_up
        schedule.note_recorded(0)
        assert schedule.recorder_keeps_up


def test_a_plant_that_waits_for_its_pace_alone_is_not_woken_up_by_messages():
    """An unread message of the recorder would make a paced plant spin for most of each period."""
    with ros_domain() as context:
        plant = node_of(
            context,
            "plant",
            {"method": "kinematic", "real_time_factor": 0.001, "await_recorder": True},
        )
        inbox, period = plant.stepper.inbox, plant.stepper.period
        for kind, stamp in (
            (WheelTorqueCommand, 0),
            (SteeringColumnState, 0),
            (SteeringColumnState, period),
        ):
            assert plant.awaits() is plant.readers[plant.wanted()[-1]].handle
            inbox.offer(kind, stamp, [0.0] * len(frame.places(kind)))
        plant.schedule.note_recorded(0)
        assert plant.awaits() is None and 0.0 < plant.wake_up_within() <= 0.05
        plant.destroy_node()
