"""Refusals of a batch, before anything runs."""

from __future__ import annotations

import numpy as np
import pytest
from batches.batches import lane_change
from helpers.toy_methods import toy_graph

from ev_core.lockstep.parts import method_part
from ev_msgs_py.refusal import ParameterError
from ev_stack.batches.batch import batch
from ev_stack.batches.by_period import PERIOD, batch_by_period
from ev_stack.batches.observer import mean
from ev_stack.batches.whole_runs import Ending


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        (
            {"plant.initial_speed": [20.0, 300.0]},
            "run 1: plant: parameter initial_speed: 300.0 is refused, expected",
        ),
        (
            {"plant.initial_sped": [20.0]},
            "unknown parameter of plant 'initial_sped'; did you mean initial_speed",
        ),
        ({"plnt.initial_speed": [20.0]}, "unknown role 'plnt'; did you mean plant"),
        ({"*.initial_speed": [20.0]}, "unknown parameter of .* 'initial_speed'"),
        ({"plant.vehicle.mass": [1000.0]}, r"expected \*.vehicle.mass, one for all roles"),
        (
            {"*.control_period": [0.01]},
            r"\*.control_period is refused: all runs of a batch have the same",
        ),
        (
            {"plant.duration": [1.0]},
            "plant.duration is refused: all runs of a batch have the same duration",
        ),
        (
            {"asr.method": ["off"]},
            "asr.method is refused: all runs of a batch have the same method",
        ),
        # An option reads and writes other signals: with some runs alone the graph would not fit.
        (
            {"plant.rear_steering": [False, True]},
            "plant.rear_steering is refused: all runs of a batch have the same rear_steering",
        ),
        (
            {"plant.electrical": [False, True]},
            "plant.electrical is refused: all runs of a batch have the same electrical",
        ),
        (
            {"plant.speed_control.gain": [1.0, 2.0]},
            "speed_control.gain is refused: plant method planar does not have it, "
            "expected with planar and plant.speed_mode true",
        ),
        (
            {"plant.pedals.drive_torque": [[1.0]]},
            "unknown parameter of plant 'pedals.drive_torque'",
        ),
        (
            {"*.seed": range(3), "plant.initial_speed": [20.0]},
            r"numbers of runs differ: \*.seed 3, plant.initial_speed 1",
        ),
        (
            {"plant.initial_speed": "20"},
            r"vary\['plant.initial_speed'\]: '20' is refused, expected a list of values, such as \['20'\]",
        ),
        (
            {"plant.initial_speed": 20.0},
            r"vary\['plant.initial_speed'\]: 20.0 is refused, expected a list",
        ),
        (
            {"plant.initial_speed": np.array(20.0)},
            r"vary\['plant.initial_speed'\]: array\(20.\) is refused",
        ),
        ({"*.seed": [1.5]}, "run 0: .*: parameter seed: 1.5 is refused, expected a whole number"),
    ],
)
def test_values_that_differ(vary, message):
    with pytest.raises(ParameterError, match=message):
        batch(lane_change(), 1.0, vary)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"signals": ["imu.yaw_rat"]}, "unknown channel 'imu.yaw_rat'; did you mean imu.yaw_rate"),
        ({"metrics": {"m": mean("yaw_rate")}}, "unknown channel 'yaw_rate'; did you mean "),
        (
            {"metrics": {"m": mean("imu.yaw_rate")}, "ending": Ending(lambda *_: True)},
            "reductions are refused for",
        ),
        ({"every": 0}, "every: 0 is refused, expected a whole number of periods, at least 1"),
        ({"threads": 0}, "threads: 0 is refused, expected a whole number, at least 1"),
        ({"threads": -1}, "threads: -1 is refused, expected a whole number, at least 1"),
        ({"threads": 2.5}, r"threads: 2\.5 is refused, expected a whole number, at least 1"),
        (
            {"initial_states": {"plant": np.zeros((2, 3))}},
            "initial_states of plant have 3 numbers, expected ",
        ),
        ({"initial_states": {"plnt": np.zeros((2, 3))}}, "unknown role 'plnt'; did you mean plant"),
        (
            {"initial_states": {"plant": np.zeros((2, 3))}, "vary": {"*.seed": [1, 2, 3]}},
            r"numbers of runs differ: \*.seed 3, initial_states of plant 2",
        ),
    ],
)
def test_everything_else(given, message):
    with pytest.raises(ParameterError, match=message):
        batch(lane_change(), 1.0, **given)


@pytest.mark.parametrize("duration", [-1.0, -1e-3, np.nan, np.inf])
def test_a_duration_that_is_none(duration):
    with pytest.raises(ParameterError, match=f"duration: {duration} is refused, expected 0 s or"):
        batch(lane_change(), duration)


def test_states_that_are_not_finite():
    rows = np.repeat(method_part(lane_change()["plant"], compiled=True).state[None], 2, axis=0)
    rows[1, 2] = np.nan
    with pytest.raises(ParameterError, match="initial_states of plant are not finite in run 1"):
        batch(lane_change(), 1.0, initial_states={"plant": rows})


def test_a_method_that_only_python_runs():
    with pytest.raises(
        ParameterError,
        match="method toy runs in plain Python, expected in a batch are methods that run",
    ):
        batch(toy_graph(), 1.0)


def test_values_that_do_not_fit_together():
    """Each is in its range, but the plant cannot step so stiff tyres.

    The error says in which run.
    """
    vary = {
        "*.vehicle.tyre.longitudinal_stiffness": [3e5, 1e7],
        "*.vehicle.wheel_inertia": [1.0, 0.01],
    }
    with pytest.raises(
        ParameterError,
        match=r"^run 1: plant: vehicle.tyre: stiffness and damping_time need steps of",
    ):
        batch(lane_change(), 1.0, vary)


def test_a_fault_that_strikes_at_no_instant_of_another_period():
    """0.05 s until 0.06 s holds an instant of 10 ms and none of 40 ms.

    Such a run would be that of a sound car.
    """
    graph = {**lane_change()}
    graph["plant"] = graph["plant"].changed(
        {"faults": ["constant imu.yaw_rate 0.5 from 0.05 until 0.06"]}
    )
    with pytest.raises(ParameterError, match=r"strikes at no instant, .* control_period, 0.04 s"):
        batch_by_period(graph, 0.1, {PERIOD: [0.01, 0.04]}, ())
