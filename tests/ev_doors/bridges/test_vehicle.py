"""A car that Autoware or ackermann_msgs command.

A real graph, with stand-ins for their messages.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from types import SimpleNamespace

import pytest
from bridges.stand_ins import KINDS
from helpers.ros_graph import NAMESPACE, Graph, graph, shchur
from rclpy.parameter import Parameter

from ev_core.lockstep.configuration import configure
from ev_core.lockstep.parts import part_of
from ev_doors.bridges import vehicle
from ev_msgs_py.contract.roles import MASTER, REQUIRED
from ev_stack.commands.program import perform
from ev_stack.interface.simulation import SteppedLaw

CONTROL, GEAR = "/control/command/control_cmd", "/control/command/gear_cmd"
GEARS = KINDS["autoware_vehicle_msgs/msg/GearCommand"]
MODES = KINDS["autoware_vehicle_msgs/msg/ControlModeReport"]
WHEELBASE = 2.405  # m, of the Audi A2


class Commander:
    """Another program: one message in each look of the driver, and the reports that it gets."""

    def __init__(self) -> None:
        self.says, self.reports = {}, defaultdict(list)

    def reader(self, _node, kind, topic, _receive, _speaker) -> Commander.Reader:
        assert kind in KINDS.values()
        return self.Reader(self.says, topic)

    class Reader:
        """Gives the present command at every other call."""

        def __init__(self, says, topic) -> None:
            self._says, self._topic, self._gives = says, topic, False

        def take(self):
            self._gives = not self._gives
            return self._says.get(self._topic) if self._gives else None

    def publisher(self, _node, name, kind):
        return self.Publisher(self.reports[name]), KINDS[f"autoware_vehicle_msgs/msg/{kind}"]

    class Publisher:
        """Keeps what is published."""

        def __init__(self, kept) -> None:
            self.publish = kept.append


@pytest.fixture
def commander(monkeypatch) -> Commander:
    made = Commander()
    monkeypatch.setattr(vehicle, "needed", KINDS.__getitem__)
    monkeypatch.setattr(vehicle, "Reader", made.reader)
    monkeypatch.setattr(vehicle, "deserialize_message", lambda message, kind: message)
    monkeypatch.setattr(vehicle.Autoware, "_publisher", staticmethod(made.publisher))
    return made


@pytest.fixture
def started(commander, tmp_path, request) -> Iterator[Graph]:
    """The graph of shchur2019 with a driver in one of the two languages.

    A command holds for 3 s.
    """
    with graph(shchur(1000.0), tmp_path, names=()) as running:
        running.parameters[MASTER]["await_recorder"] = False
        for name in REQUIRED:
            if name != "driver":
                running.start(name)
        values = {**running.parameters["driver"], "commands_last": 3.0}
        overrides = [Parameter(name, value=value) for name, value in values.items()]
        arguments = {
            "context": running.context,
            "namespace": NAMESPACE,
            "parameter_overrides": overrides,
        }
        running.nodes["driver"] = vehicle.CommandedDriver(request.param, **arguments)
        yield running


def drive(running: Graph, seconds: float) -> None:
    end = running.time + seconds
    running.run(lambda: running.time >= end)


def control(velocity: float, acceleration: float | None = None, angle: float = 0.0):
    command = KINDS["autoware_control_msgs/msg/Control"]()
    command.longitudinal.velocity, command.lateral.steering_tire_angle = velocity, angle
    if acceleration is not None:
        command.longitudinal.acceleration, command.longitudinal.is_defined_acceleration = (
            acceleration,
            True,
        )
    return command


@pytest.mark.parametrize("started", [vehicle.Autoware], indirect=True)
def test_autoware_drives_the_car_and_hears_what_it_does(started, commander):
    """A circle by r = v tan(delta)/L, backwards, and to rest without commands.

    The rear axle of this car does not slip: its lateral velocity, which Autoware wants, is zero;
    that of the centre of mass is not.
    """
    reports = commander.reports
    drive(started, 2.0)
    assert (reports["control_mode"][-1].mode, reports["gear_status"][-1].report) == (
        MODES.NOT_READY,
        GEARS.PARK,
    )
    assert reports["velocity_status"][-1].longitudinal_velocity == 0.0

    commander.says |= {GEAR: GEARS(command=GEARS.DRIVE), CONTROL: control(5.0, 1.0, 0.1)}
    drive(started, 20.0)
    velocity, steering = reports["velocity_status"], reports["steering_status"]
    # m/s, the PI control has settled
    assert velocity[-1].longitudinal_velocity == pytest.approx(5.0, abs=0.05)
    assert steering[-1].steering_tire_angle == pytest.approx(0.1, rel=0.02)
    expected = (
        velocity[-1].longitudinal_velocity * math.tan(steering[-1].steering_tire_angle) / WHEELBASE
    )
    assert velocity[-1].heading_rate == pytest.approx(expected, rel=1e-3)
    assert abs(velocity[-1].lateral_velocity) < 1e-6
    at = [each.header.stamp.sec + each.header.stamp.nanosec / 1e9 for each in velocity]
    gained = [each.longitudinal_velocity for each in velocity]
    early = next(i for i, speed in enumerate(gained) if speed > 1.0)
    late = next(i for i, speed in enumerate(gained) if speed > 4.0)
    # m/s^2 as asked for
    assert (gained[late] - gained[early]) / (at[late] - at[early]) == pytest.approx(1.0, rel=0.1)
    assert (reports["control_mode"][-1].mode, reports["gear_status"][-1].report) == (
        MODES.AUTONOMOUS,
        GEARS.DRIVE,
    )

    commander.says[CONTROL] = control(9.0, 0.0, 0.1)  # an acceleration of zero that is defined
    drive(started, 5.0)
    assert velocity[-1].longitudinal_velocity == pytest.approx(5.0, abs=0.05)

    commander.says[CONTROL] = control(-2.0)  # not in this gear
    drive(started, 10.0)
    assert velocity[-1].longitudinal_velocity == pytest.approx(0.0, abs=1e-3)
    commander.says[GEAR] = GEARS(command=GEARS.REVERSE)
    drive(started, 10.0)
    assert velocity[-1].longitudinal_velocity == pytest.approx(-2.0, abs=0.05)

    commander.says[CONTROL] = control(float("nan"))  # refused, so no command comes any more
    drive(started, 10.0)
    assert reports["control_mode"][-1].mode == MODES.DISENGAGED
    assert velocity[-1].longitudinal_velocity == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("started", [vehicle.Ackermann], indirect=True)
def test_ackermann_drives_backwards_by_a_negative_speed_and_steers_at_a_rate(started, commander):
    command = KINDS["ackermann_msgs/msg/AckermannDriveStamped"]()
    command.drive.speed, command.drive.steering_angle, command.drive.steering_angle_velocity = (
        -3.0,
        0.2,
        0.02,
    )
    commander.says["ackermann_cmd"] = command
    state, places = started.nodes["driver"].stepper.part.state, started.nodes["driver"]._places
    drive(started, 5.0)
    # rad: 0.02 rad/s for as long as it has been commanded
    assert 0.02 < state[places["road_wheel_angle"]] < 0.15
    drive(started, 20.0)
    assert state[places["longitudinal"]] == pytest.approx(-3.0, abs=0.05)
    assert state[places["road_wheel_angle"]] == pytest.approx(0.2, rel=0.02)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_an_angle_beyond_the_stop_comes_back_at_once(side):
    """The commanded angle ends at the stop of the wheels: nothing winds up beyond it."""
    configuration = configure("driver", {"method": vehicle._LAW})
    law = SteppedLaw(configuration)
    place = {name: n for n, name in enumerate(configuration.method.law.names())}

    def angle_after(wanted: float, steps: int) -> float:
        command = {"wanted_angle": wanted, "angle_rate": 1.0, "left": 100.0, "highest_speed": 1.0}
        state = [*law.state]
        for name, value in command.items():
            state[place[name]] = value
        law.state = state
        for _ in range(steps):
            law.answer(0.0, {})
        return law.state[place["angle"]]

    stop = configuration.common.vehicle.maximum_road_wheel_angle
    assert angle_after(side * 100.0, 1000) == side * stop
    # 1 rad/s for ten steps of 10 ms.
    assert angle_after(0.0, 10) == pytest.approx(side * (stop - 0.1))


@pytest.mark.parametrize("faults", [(), ("delayed driver/command.drive_torque 0.1",)])
@pytest.mark.parametrize("compiled", [True, False])
def test_a_command_counts_whatever_plays_the_driver(faults, compiled):
    """The state of a plain law, and of one behind sensors and faults, is a copy."""
    configuration = configure("driver", {"method": vehicle._LAW, "faults": faults})
    part = part_of(configuration, compiled)
    names = configuration.method.law.names()
    node = SimpleNamespace(
        stepper=SimpleNamespace(part=part), _places={name: n for n, name in enumerate(names)}
    )
    before = [*part.state]
    vehicle.CommandedDriver._obey(node, {"wanted_speed": 5.0, "left": 3.0})
    changed = {
        name: now for name, was, now in zip(names, before, part.state, strict=False) if now != was
    }
    assert changed == {"wanted_speed": 5.0, "left": 3.0}


@pytest.mark.parametrize(
    ("kind", "package"),
    [
        ("autoware", "autoware_control_msgs"),
        ("ackermann", "ackermann_msgs"),
        ("simulation_interfaces", "simulation_interfaces"),
    ],
)
def test_a_package_that_is_not_sourced_is_one_line(kind, package):
    with pytest.raises(SystemExit) as ended:
        perform(["bridge", kind])
    assert (
        f"the package {package} is not sourced here" in ended.value.code
        and "\n" not in ended.value.code
    )
