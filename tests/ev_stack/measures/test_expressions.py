"""Metrics that users write.

What they give, and that nothing else than what is written down has a meaning.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract import frame
from ev_msgs_py.refusal import ParameterError
from ev_stack.measures.metric import Metric
from ev_stack.measures.named import DrivenRun
from ev_stack.measures.own_metrics import listed, named_metric, named_metrics
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.scenario import load_scenario

CAR = Vehicle(tyre=replace(Vehicle().tyre, coefficients=(0.9, 0.1, 0.0, 0.0)))
TIME = np.arange(5) * 0.5
RUN = DrivenRun(
    Recording(
        TIME,
        {
            "imu.yaw_rate": np.array([0.0, -3.0, 1.0, 2.0, 1.0]),
            "pose.x": np.array([0.0, 3.0, 6.0, 9.0, 12.0]),
            "pose.y": np.array([0.0, 4.0, 8.0, 12.0, 16.0]),
            "twist.longitudinal": np.full(5, 3.0),
            "twist.lateral": np.full(5, 4.0),
            "battery.current": np.array([0.0, np.nan, 0.0, 0.0, 0.0]),
        },
    ),
    CAR,
)


def measured(expression: str) -> Metric:
    return named_metric(f"mine [1] = {expression}").measured(RUN)


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        ("maximum(imu.yaw_rate)", 2.0),
        ("minimum(imu.yaw_rate) + 1", -2.0),
        ("largest_magnitude(imu.yaw_rate)", 3.0),
        ("first(pose.x) - last(pose.x)", -12.0),
        ("root_mean_square(imu.yaw_rate)", np.sqrt(15 / 5)),
        ("standard_deviation(pose.x)", np.sqrt(18.0)),
        ("maximum(imu.yaw_rate, 0.5) * 2", None),
        ("mean(maximum(imu.yaw_rate, 0))", 0.8),
        ("maximum(hypot(pose.x, pose.y)) ** 2 / 4", 100.0),
        ("maximum(imu.yaw_rate[time < 1.4])", 1.0),
        ("maximum(-imu.yaw_rate[(0.6 < time <= 1.5) & ~(imu.yaw_rate > 1.5)])", -1.0),
        ("mean(imu.yaw_rate >= 1)", 0.6),
        ("integral(twist.longitudinal)", 6.0),
        ("integral(where(time >= 1, 1, 0))", 1.25),
        ("mean(derivative(pose.x))", 6.0),
        ("maximum(degrees(imu.yaw_rate)) * pi / 180", 2.0),
        ("maximum(clip(imu.yaw_rate, -1, 1))", 1.0),
        ("maximum_speed + final_speed / maximum_speed", 6.0),
        ("at(pose.x, 0.75)", 4.5),
        ("at(pose.x + pose.y, first(time[pose.x > 5]))", 14.0),
        ("mean(pose.x[0.5:1.5])", 4.5),
        ("last(path_speed[0:1])", 5.0),
        ("degrees(first(sideslip_angle))", np.degrees(np.arctan2(4.0, 3.0))),
        ("vehicle.mass / vehicle.wheelbase", CAR.mass / CAR.wheelbase),
        ("vehicle.motor.maximum_speed * 30 / pi", CAR.motor.maximum_speed * 30.0 / np.pi),
        ("vehicle.tyre.coefficients[0]", 0.9),
    ],
)
def test_an_expression_is_what_it_says(expression, value):
    if value is None:
        with pytest.raises(
            ParameterError, match="it has a value at each sample, expected one number"
        ):
            measured(expression)
    else:
        assert measured(expression).value == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize(
    ("expression", "why"),
    [
        ("maximum(imu.yaw_rate[time > 99])", "the condition holds at no sample"),
        ("1 / 0", "the result is inf"),
        ("9 ** 9 ** 9 ** 9", "the result is inf"),
        ("maximum(battery.current)", "battery.current is not finite at 0.5 s"),
        ("maximum(battery.voltage)", "battery.voltage was not recorded"),
        ("mean(pose.x[1:3])", "the run lasts from 0 s to 2 s, the window from 1 s to 3 s"),
        ("at(pose.x, 2.5)", "the run lasts from 0 s to 2 s, without 2.5 s"),
        ("at(pose.x, -1)", "the run lasts from 0 s to 2 s, without -1 s"),
        ("vehicle.tyre.coefficients[4]", "vehicle.tyre.coefficients of this car has 4 numbers"),
    ],
)
def test_what_has_no_value_says_why(expression, why):
    assert measured(expression).verdict == f"not measured: {why}"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x [1] = maxi(imu.yaw_rate)", "unknown function 'maxi'; did you mean maximum?"),
        (
            "x [1] = maximum(imu.yaw_rat)",
            "unknown channel 'imu.yaw_rat'; did you mean imu.yaw_rate, twist.yaw_rate?",
        ),
        ("x [1] = slip_enrgy", "unknown name 'slip_enrgy'; did you mean slip_energy"),
        ("x [1] = __import__('os').system('touch /tmp/x')", "unknown function"),
        ("x [1] = imu.__class__", "unknown channel"),
        ("x [1] = (lambda: 1)()", "unknown function"),
        ("x [1] = maximum(imu.yaw_rate for x in y)", "has no meaning"),
        ("x [1] = [1 for x in y]", "has no meaning"),
        ("x [1] = (x := 1)", "has no meaning"),
        ("x [1] = f'{1}'", "has no meaning"),
        ("x [1] = 'a' * 9", "has no meaning"),
        ("x [1] = mean(imu.yaw_rate) and 1", "and, or, not are written &, |, ~"),
        ("x [1] = mean(*imu)", "has no meaning"),
        ("x [1] = mean(imu.yaw_rate, axis=0)", "mean takes values only"),
        ("x [1] = hypot(pose.x)", "hypot takes 2 values, here are 1"),
        ("x [1] = mean(1)", "mean is of a channel, '1' is one number"),
        ("x [1] = pose.x[0]", "expected CHANNEL[condition], such as [time > 1], or [1:2]"),
        ("x [1] = mean(pose.x[1:])", "expected [START:END], or [time > START]"),
        ("x [1] = mean(pose.x[time:2])", "expected CHANNEL[START:END] with two numbers"),
        ("x [1] = mean(pose.x[1:2][1:2])", "expected CHANNEL[START:END] with two numbers"),
        ("x [1] = at(pose.x)", "at takes 2 values, here are 1"),
        ("x [1] = at(3, 2)", "at is at(CHANNEL, TIME)"),
        ("x [1] = vehicle.mas", "unknown vehicle parameter 'mas'; did you mean mass"),
        (
            "x [1] = vehicle.tyre.coefficients",
            "is a list, expected one of its numbers, such as ",
        ),
        ("x [1] = vehicle.mass[0]", "vehicle.mass is refused, expected a number"),
        ("x [1] = vehicle.name", "vehicle.name is refused, expected a number"),
        ("x [1] = vehicle.driven_wheels", "vehicle.driven_wheels is refused, expected a number"),
        ("x [1] = vehicle.driven_wheels[0]", "vehicle.driven_wheels is refused, expected a number"),
        ("x [1] = mean(pose.x[time > 1] * pose.y[time > 1])", "expected (A * B)[condition]"),
        ("x [1] = mean(pose.x & pose.y)", "join conditions"),
        ("x [1] = mean(where(pose.x, 1, 0))", "where is where(condition, A, B)"),
        ("x [1] = 1 +", "no expression: invalid syntax"),
        ("x [1] = " + "-" * 400 + "1", "it has too many parts, expected 200"),
        ("x [1] = " + "(" * 250 + "1" + ")" * 240, "no expression: "),
        ("x [1] = " + "1+" * 300 + "1", "it has 601 characters, expected 500"),
        ("x [1] = 1" + "0" * 400, "a number is too large"),
        ("x [1] = 1\0", "no expression"),
        ("x = slip_energy / 2", "its unit is missing"),
        ("slip_energy [kJ] = slip_energy / 1000", "slip_energy is the name of another metric"),
    ],
)
def test_what_has_no_meaning_is_one_line(text, message):
    with pytest.raises(ParameterError) as error:
        named_metric(text)
    assert message in str(error.value) and str(error.value).startswith("metric ")
    assert "\n" not in str(error.value) and len(str(error.value)) < 1000


def test_a_name_of_no_metric_asks_for_the_similar_one():
    with pytest.raises(
        ParameterError, match=r"^unknown metric 'yaw_rate_eror'; did you mean yaw_rate_error, p"
    ):
        named_metric("yaw_rate_eror")
    with pytest.raises(ParameterError, match=r"^metric 'mine' is there twice, expected once$"):
        named_metrics(["mine [1] = 1", "mine [1] = 2"])


def test_a_unit_is_that_of_the_channel_or_the_users():
    assert named_metric("peak = maximum(imu.yaw_rate)").unit == "rad/s"
    assert named_metric("peak [deg/s] = maximum(degrees(imu.yaw_rate))").unit == "deg/s"
    assert named_metric("peak [deg/s] = maximum(degrees(imu.yaw_rate))").needs == ("imu.yaw_rate",)
    assert named_metric("share[1]=slip_energy/drive_energy").needs[-1] == "wheel_states.effort."


def test_every_channel_can_be_written():
    for name in frame.channels():
        assert named_metric(f"mine = last({name})").needs == (name,)


def test_commas_within_parentheses_separate_no_metrics():
    assert listed(" a, b [1] = hypot(x, y[z, 1]) ,c,") == ("a", "b [1] = hypot(x, y[z, 1])", "c")


def test_the_file_of_a_scenario_is_named_with_what_is_wrong_in_it(tmp_path):
    (tmp_path / "own.yaml").write_text(
        "/**/scenario:\n  ros__parameters: {metrics: ['yaw_rate_eror']}\n"
    )
    with pytest.raises(ParameterError) as error:
        load_scenario(str(tmp_path / "own.yaml"))
    assert (
        str(error.value)
        == f"{tmp_path}/own.yaml: unknown metric 'yaw_rate_eror'; did you mean yaw_rate_error, path_error?"
    )
