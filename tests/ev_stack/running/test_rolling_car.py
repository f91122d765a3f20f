"""A car that rolls, through all that drives and shows a car."""

from __future__ import annotations

from collections import defaultdict
from types import SimpleNamespace
from xml.etree.ElementTree import fromstring

import fmpy
import numpy as np
import pytest
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

import ev_stack
from documentation.processors import hash_on
from ev_doors.export.targets import TARGETS
from ev_doors.learning.environment import Environment
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.program import perform
from ev_stack.interface.simulation import Simulation
from ev_stack.measures.handling import slip_energy
from ev_stack.recording.bag_writer import ros_types
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import Recording, load, signal_hash
from ev_stack.running.offline import run_offline_into
from ev_stack.scenarios.scenario import Overrides, load_scenario
from ev_stack.views.messages import TF, CarViews
from ev_stack.views.urdf import urdf

OVERRIDES = Overrides(duration=3.0, vehicle="sedan")
MET = "maximum_roll_angle"


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> SimpleNamespace:
    """A step steer of the sedan: its run, signals, and the messages of its bag by topic."""
    folder = tmp_path_factory.mktemp("rolling")
    run = load_scenario("step_steer", OVERRIDES, ("left",)).runs[0]
    run_offline_into(run, folder, bag=True, progress=lambda time: None)
    messages = defaultdict(list)
    with (folder / "bag" / "bag.mcap").open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for each in reader.iter_decoded_messages(("/ev/left/imu/roll", "/tf", "/tf_static")):
            messages[each.channel.topic].append(each.decoded_message)
    signals = load(folder / "signals.npz")
    return SimpleNamespace(run=run, signals=signals, messages=messages)


def test_it_leans_to_the_outside_of_the_bend(driven):
    """Left bend, to the right; the rate is the change of the angle (2 % of its largest)."""
    signals = driven.signals
    angle = 2.0 * np.arctan2(
        signals.channels["imu.roll.orientation_x"], signals.channels["imu.roll.orientation_w"]
    )
    assert angle[-1] > 0.02
    rate = signals.channels["imu.roll.rate"]
    middle = 0.5 * (rate[1:] + rate[:-1])
    assert np.abs(np.diff(angle) / np.diff(signals.time) - middle).max() < 0.02 * rate.max()


def test_the_bag_has_an_orientation_and_the_frame_of_the_body(driven):
    """The body turns about the axis through the roll centres, at every instant of /tf."""
    rolls = driven.messages["/ev/left/imu/roll"]
    angular = [each.angular_velocity.x for each in rolls]
    assert angular == driven.signals.channels["imu.roll.rate"].tolist()
    # -1 would mean that an Imu knows no orientation.
    assert rolls[0].orientation_covariance[0] == 0.0
    body = [
        transform
        for each in driven.messages["/tf"]
        for transform in each.transforms
        if transform.child_frame_id == "body"
    ]
    assert len(body) == len(driven.messages["/tf"])
    assert body[-1].transform.translation.z == pytest.approx(0.5 * (0.45861 + 0.47661))
    assert body[-1].transform.rotation.x == pytest.approx(rolls[-1].orientation.x, rel=1e-2)
    assert not any(
        transform.child_frame_id == "body"
        for each in driven.messages["/tf_static"]
        for transform in each.transforms
    )


def test_a_plant_without_roll_keeps_the_body_upright(driven):
    """All frames of a rolling car, such as on the kinematic plant, are there without the signal."""
    car = driven.run.configurations["plant"].common.vehicle
    rigid = {
        name: values
        for name, values in driven.signals.channels.items()
        if not name.startswith("imu.roll.")
    }
    time = driven.signals.time
    stamps = np.round(time * 1e9).astype(np.int64)
    views = CarViews("/ev/left", car).moving(stamps, Recording(time, rigid))
    (frames,) = (messages for view, messages in views if view.message_type == TF.message_type)
    transforms = ros_types().deserialize_cdr(frames[-1], TF.message_type).transforms
    (body,) = (each.transform for each in transforms if each.child_frame_id == "body")
    assert (body.rotation.x, body.rotation.w) == (0.0, 1.0)


def test_slip_energy_is_that_of_wheels_over_which_the_centre_of_mass_sways(driven):
    """Forces times the slips that the plant shows, within 3 %: its carcasses lag by some cm.

    Without the sway the side forces would take 12 % more.
    """
    channels = driven.signals.channels
    of_wheels = []
    for wheel in WHEEL_NAMES:
        along, across, ratio, angle = (
            channels[f"tire_forces.{name}.{wheel}"]
            for name in ("longitudinal_force", "lateral_force", "slip_ratio", "slip_angle")
        )
        of_wheels.append(along * ratio - across * np.sin(angle))
    power = sum(of_wheels) * channels["twist.longitudinal"]
    car = driven.run.configurations["plant"].common.vehicle
    expected = np.trapezoid(power, driven.signals.time)
    assert slip_energy(driven.signals, car) == pytest.approx(expected, rel=0.03)


def test_the_description_has_a_joint_for_the_roll(driven):
    car = driven.run.configurations["plant"].common.vehicle
    joints = {joint.get("name"): joint for joint in fromstring(urdf(car)).findall("joint")}
    assert joints["body_roll"].get("type") == "revolute"
    assert joints["body_roll"].find("axis").get("xyz") == "1 0 0"


def test_its_metric_and_its_sensors():
    """A biased sensor shows another angle to all, while the metric is of the true motion."""
    biased = {"plant.sensors.body_roll.bias": 0.01, "plant.sensors.body_roll_rate.gain": 0.5}
    arguments = {"runs": ["left"], "vehicle": "sedan", "duration": 3.0, "metrics": [MET]}
    true, shown = (ev_stack.run("step_steer", **arguments, set=each) for each in ({}, biased))
    assert true.metrics[MET].value == shown.metrics[MET].value > 0.01
    of_true, of_shown = true.runs["left"].channels, shown.runs["left"].channels
    assert of_shown["imu.roll.orientation_x"][0] == pytest.approx(0.005, rel=1e-4)
    rates = [each["imu.roll.rate"] for each in (of_true, of_shown)]
    assert rates[1] == pytest.approx(0.5 * rates[0])


def test_a_batch_has_its_numbers_to_the_bit():
    """Noise of the sensor follows from the seed; a batch of rolling and rigid cars is refused."""
    noise = {"plant.sensors.body_roll.noise": 0.01, "plant.sensors.imu_yaw_rate.noise": 0.01}
    arguments = {"vehicle": "sedan", "duration": 3.0, "metrics": [MET, "peak_sideslip"]}
    found = ev_stack.batch(
        "step_steer", {"*.seed": [0, 1]}, run="left", set=noise, **arguments
    ).metrics
    one = ev_stack.run("step_steer", runs=["left"], set=noise, seed=1, **arguments)
    assert {name: values[1] for name, values in found.items()} == {
        name: one.metrics[name].value for name in found
    }
    masses = {"*.vehicle.suspension.sprung_mass": [0.0, 1671.26]}
    with pytest.raises(ValueError, match="all runs of a batch have the same"):
        ev_stack.batch("step_steer", masses, run="left", **arguments)


def test_a_simulation_goes_on_from_its_state():
    """A rolling car is saved and continued to the bit; a rigid one does not take its state."""
    rolling = Simulation("step_steer", run="left", vehicle="sedan")
    rigid = Simulation("step_steer", run="left", vehicle="compact_ev")
    for _ in range(250):
        rolling.step()
    kept = rolling.state
    ends = []
    for _ in range(2):
        rolling.state = kept
        for _ in range(30):
            rolling.step()
        ends.append(dict(rolling.frame))
    assert ends[0] == ends[1]
    assert ends[0]["imu.roll.rate"] != 0.0
    with pytest.raises(ParameterError):
        rigid.state = kept


def test_an_agent_observes_it():
    seen = ["imu.roll.orientation_x", "imu.roll.rate"]
    environment = Environment("step_steer", observe=seen, run="left", vehicle="sedan", duration=1.0)
    _, info = environment.reset(seed=1)
    for _ in range(250):
        observed, *_, info = environment.step(info["own"])
    assert observed.tolist() == [info["frame"][name] for name in seen]
    assert environment.observation_space.contains(observed)


@pytest.mark.slow
@pytest.mark.weekly  # compiles the plant for C once more
def test_exported_it_has_the_same_bits(tmp_path):
    """The C library in a program of its own, and the FMU."""
    (run,) = load_scenario("step_steer", Overrides(duration=2.5, vehicle="sedan"), ("left",)).runs
    plain = run_offline(run.configurations, 2.5)
    assert hash_on(run, TARGETS["x86_64-linux"], tmp_path) == signal_hash(plain)
    # The command scales the steering angles to this car, as every run does.
    driven = ev_stack.run("step_steer", runs=["left"], vehicle="sedan", duration=2.5)
    file = tmp_path / "car.fmu"
    words = ["step_steer", "--run", "left", "--vehicle", "sedan", "--duration", "2.5"]
    perform(["fmu", *words, "--out", str(file), "--target", "x86_64-linux"])
    simulated = fmpy.simulate_fmu(
        str(file), stop_time=2.5, step_size=0.01, output_interval=0.01, output=["imu.roll.rate"]
    )
    rates = driven.runs["left"].channels["imu.roll.rate"]
    assert rates.max() > 0.01
    assert np.array_equal(simulated["imu.roll.rate"][: len(rates)], rates)
