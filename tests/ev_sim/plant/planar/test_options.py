"""Options of the planar plant: each adds its signals, and they go with each other."""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from plant.planar.car import STRAIGHT, command, outputs, plant, steered

from ev_core.lockstep.configuration import configure
from ev_core.lockstep.finding import find_method
from ev_core.lockstep.graph import check_graph
from ev_msgs_py.contract.optional_signals import (
    CellCondition,
    MotorElectrics,
    MotorTemperatures,
    RearSteeringState,
    WheelSpeedCommand,
)
from ev_msgs_py.contract.signals import (
    BatteryCondition,
    BodyVelocity,
    SteeringColumnState,
    WheelTorqueCommand,
)
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.refusal import ParameterError
from ev_stack.interface.simulation import Simulation
from ev_stack.recording.offline import run_offline
from ev_stack.running.steering_angles import with_own_angles
from ev_stack.scenarios.scenario import Overrides, load_scenario

OPTIONS = ("electrical", "rear_steering", "speed_mode")
FREE = WheelSpeedCommand(Wheels.all(1e4))  # out of reach, so that the torque counts
PULLING = command((200.0, 200.0, 0.0, 0.0))
FORMER = {f"planar_{option}": option for option in OPTIONS}


def rear(angle: float) -> RearSteeringState:
    return RearSteeringState(angle, 0.0, 0.0, 0.0, 0.0)


@pytest.mark.parametrize("chosen", [*product((False, True), repeat=3)])
def test_each_option_adds_its_signals_beside_the_others(chosen):
    """Eight plants of one name.

    Their signals are those of the plain one, and those of each option.
    """
    values = dict(zip(OPTIONS, chosen, strict=True))
    method = configure("plant", values | {"method": "planar"}).method
    plain = configure("plant", {"method": "planar"}).method
    reads = {WheelTorqueCommand, SteeringColumnState}
    reads |= {RearSteeringState} if values["rear_steering"] else set()
    reads |= {WheelSpeedCommand} if values["speed_mode"] else set()
    electrics = {MotorElectrics, MotorTemperatures, CellCondition}
    assert {*method.reads} == reads
    assert {*method.writes} == {*plain.writes} | (electrics if values["electrical"] else set())


def test_an_option_that_is_put_off_leaves_the_plain_plant():
    """Its sensors go with its signals, and come back with their defaults."""
    plain = configure("plant", {"method": "planar"})
    named = {"sensors.motor_current.bias": 1.0}
    electrical = plain.changed({"electrical": True, **named})
    assert electrical.values()["sensors.motor_current.bias"] == 1.0
    off = electrical.changed({"electrical": False})
    assert off.method == plain.method
    assert {*named} <= {*off.unused}


@pytest.mark.weekly
def test_rear_wheels_and_speed_mode_act_together_as_each_alone():
    """Straight rear wheels leave speed mode to the bit, a far set-point leaves steering.

    The electrical side beside them moves nothing, and the plant of all options is compiled anyway.
    """
    all_on = dict.fromkeys(OPTIONS, True)
    steered_rear = plant(rear_steering=True, initial_speed=15.0)
    by_speed = plant(speed_mode=True, initial_speed=15.0)
    straight, free = (plant(initial_speed=15.0, **all_on) for _ in range(2))
    slow = WheelSpeedCommand(Wheels.all(20.0))
    for n in range(40):
        angle = min(0.001 * n, 0.02)
        steered_rear.advance(PULLING, STRAIGHT, rear(angle))
        free.advance(PULLING, STRAIGHT, rear(angle), FREE)
        by_speed.advance(PULLING, STRAIGHT, slow)
        straight.advance(PULLING, STRAIGHT, rear(0.0), slow)
    for one, other in ((straight, by_speed), (free, steered_rear)):
        found, alone = outputs(one), outputs(other)
        del alone[BatteryCondition]  # which gives the losses of the electrical side
        assert {each: found[each] for each in alone} == alone
    # Rear wheels to the left turn the car to the right.
    assert outputs(free)[BodyVelocity].yaw_rate < -0.01
    assert outputs(straight)[BodyVelocity].yaw_rate == 0.0


@pytest.mark.weekly
def test_all_options_mirror_to_the_bit():
    """Steered to the left and to the right, the car of all options has mirrored yaw rates."""
    options = dict.fromkeys(OPTIONS, True)
    left, right = (plant(initial_speed=15.0, **options) for _ in range(2))
    speeds = WheelSpeedCommand(Wheels.all(60.0))
    for _ in range(40):
        left.advance(PULLING, steered(0.03), rear(-0.01), speeds)
        right.advance(PULLING, steered(-0.03), rear(0.01), speeds)
    turning = outputs(left)[BodyVelocity].yaw_rate
    assert turning > 0.1
    assert outputs(right)[BodyVelocity].yaw_rate == -turning


def test_the_electrical_side_does_not_move_a_car_whose_torque_it_does_not_limit():
    """Rear steering at 80 km/h takes a tenth of the torque.

    Motion to the bit, and the losses as heat.
    """
    driven = {
        run: run_offline(loaded.runs[0].configurations, loaded.runs[0].duration).channels
        for run in ("zero_sideslip", "electrical")
        for loaded in [load_scenario("rear_steering", Overrides((), (), 3.0), (run,))]
    }
    plain, electrical = driven["zero_sideslip"], driven["electrical"]
    for name in ("twist.lateral", "imu.yaw_rate", "rear_steering.state.angle"):
        assert np.abs(plain[name]).max() > 0.0
        assert electrical[name].tobytes() == plain[name].tobytes(), name
    winding = electrical["motor_temperatures.winding.front_left"]
    assert winding[-1] > winding[0]


@pytest.mark.parametrize(("name", "option"), [*FORMER.items()])
def test_a_former_name_is_the_plant_with_its_option_for_one_release(name, option):
    """A value beside it counts before what the name stands for; a line names the present way."""
    now = configure("plant", {"method": "planar", option: True})
    assert configure("plant", {"method": name}) == now
    assert configure("plant", {"method": "planar"}).changed({"method": name}) == now
    assert configure("plant", {"method": name, option: False}).method.reads == (
        find_method("plant", "planar").reads
    )
    asked = {"planar_rear_steering": ("rear_steering", "method", "zero_sideslip")}
    asked["planar_speed_mode"] = ("asr", "method", "speed_by_slip")
    values = [("plant", "method", name), *([asked[name]] if name in asked else [])]
    notes = load_scenario("double_lane_change", Overrides((), values)).notes
    (note,) = (each for each in notes if "old name" in each)
    assert note.startswith(f"plant method {name} is now planar, here with {option} true")


@pytest.mark.parametrize(("name", "option"), [*FORMER.items()])
def test_the_note_on_a_former_name_names_the_value_that_counts(name, option):
    """That is the one beside the name."""
    values = [("plant", "method", name), ("plant", option, False)]
    (note,) = load_scenario("shchur2019_steps", Overrides((), values, 1.0)).notes[-1:]
    assert note.startswith(f"plant method {name} is now planar, here with {option} false")


@pytest.mark.parametrize(
    "option",
    [
        "rear_steering",
        *(
            pytest.param(option, marks=pytest.mark.weekly)
            for option in ("electrical", "speed_mode")
        ),
    ],
)
def test_a_state_is_not_taken_over_by_a_plant_with_other_options(option):
    """A rear angle would stay for ever where no actuator sets it.

    Nothing changes where a state is refused.
    """
    asks = {"rear_steering": ("rear_steering", "method", "zero_sideslip")}
    asks["speed_mode"] = ("asr", "method", "speed_by_slip")
    values = [asks.get(option, ("plant", option, True))]
    # Without what only one of them has, both have the same roles.
    without = ["rear_steering"] if option == "rear_steering" else []
    (run,) = load_scenario("double_lane_change", Overrides((), values, 1.0)).runs
    other = Simulation(run, without=without)
    plain = Simulation("double_lane_change")
    plain.step()
    before = plain.state
    with pytest.raises(ParameterError, match=rf"{option}|asr\.method"):
        plain.state = other.state
    assert plain.state.frame.tobytes() == before.frame.tobytes()


@pytest.mark.parametrize(
    ("role", "law", "option"),
    [("rear_steering", "zero_sideslip", "rear_steering"), ("asr", "speed_by_slip", "speed_mode")],
)
def test_a_law_puts_the_option_on_that_it_requires(role, law, option):
    """The scenario need not name it; where it names the contrary it is refused."""
    chosen = (role, "method", law)
    (run,) = load_scenario("double_lane_change", Overrides((), [chosen])).runs
    assert getattr(run.configurations["plant"].parameters, option) is True
    contrary = ("plant", option, False)
    with pytest.raises(ParameterError, match=rf"requires plant\.{option} true, but false is"):
        load_scenario("double_lane_change", Overrides((), [chosen, contrary]))


@pytest.mark.parametrize(
    ("name", "option"),
    [("speed_control.gain", "speed_mode"), ("sensors.cell_temperature.bias", "electrical")],
)
def test_a_value_of_an_option_that_is_off_is_refused_with_its_switch(name, option):
    """It would do nothing; the line names the option that uses it."""
    given = ("plant", name, 7.0)
    way = f"{name} is refused: .* expected with planar and plant.{option} true$"
    with pytest.raises(ParameterError, match=way):
        load_scenario("double_lane_change", Overrides(values=[given]))
    # A file, and a study of several methods, may have it for runs with the option.
    (run,) = load_scenario("double_lane_change", Overrides(prepared=[given])).runs
    assert run.configurations["plant"].unused == (name,)
    used = configure("plant", {"method": "planar", option: True, name: 7.0})
    assert not used.unused
    assert used.values()[name] == 7.0


def test_the_slow_ramp_of_a_car_in_speed_mode_is_that_of_the_car():
    """The ramp has no traction control that would set wheel speeds; the run keeps the option."""
    heavy = ("*", "vehicle.mass", 1300.0)
    scales = []
    for values in ([heavy], [heavy, ("asr", "method", "speed_by_slip")]):
        loaded = load_scenario("step_steer", Overrides(values=values), only=["left"])
        (run,) = with_own_angles(loaded).runs
        scales.append(run.configurations["steering_column"].parameters.scale)
        # A simulation of the run as it was resolved drives the ramp as well.
        stepped = Simulation(loaded.runs[0]).configurations["steering_column"]
        assert stepped.parameters.scale == scales[-1]
    assert run.configurations["plant"].parameters.speed_mode
    assert scales[0] == scales[1] != 1.0


def test_a_law_may_require_an_option_by_its_former_name():
    """Former names go on for one release, also where a law requires one."""
    option = "electrical"
    named = [("plant", "method", f"planar_{option}")]
    (run,) = load_scenario("double_lane_change", Overrides(values=named)).runs
    asr = run.configurations["asr"]
    law = replace(asr.method.law, requires={"plant": f"planar_{option}"})
    graph = {**run.configurations, "asr": replace(asr, method=replace(asr.method, factory=law))}
    check_graph(graph)
    graph["plant"] = graph["plant"].changed({option: False})
    with pytest.raises(ParameterError, match=f"requires plant.{option} true, but false is chosen"):
        check_graph(graph)


def test_a_simulation_without_angles_of_its_own_car_warns():
    """No angle gives a lateral acceleration at rest: those of the file are driven."""
    at_rest = {"plant.initial_speed": 0.0}
    with pytest.warns(UserWarning, match="a slow ramp gives none: the run begins at rest"):
        Simulation("step_steer", run="left", set=at_rest)
    loaded = load_scenario(
        "step_steer", Overrides(values=[("plant", "initial_speed", 0.0)]), only=["left"]
    )
    with pytest.warns(UserWarning, match="a slow ramp gives none"):
        car = Simulation(loaded.runs[0])
    assert car.configurations["steering_column"].parameters.scale == 1.0
