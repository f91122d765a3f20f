"""The bag of a run shows the car to viewers: frames, odometry, forces, description, parameters.

It is read by mcap-ros2-support, which knows no message but by the definition that the bag has
embedded.
"""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path
from types import SimpleNamespace
from xml.etree.ElementTree import fromstring

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory

from ev_core.vehicle.car import GRAVITY
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.recording.recording import load
from ev_stack.recording.run_recorder import write_bag
from ev_stack.running.offline import recorded_topics, run_offline_into
from ev_stack.scenarios.scenario import Overrides, load_scenario

VIEWED = (
    "/tf",
    "/tf_static",
    "/ev/odometry",
    "/ev/tyre_force_markers",
    "/ev/robot_description",
    "/parameter_events",
)
DURATION = 5.0  # s: the first of the two lane changes is over


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> SimpleNamespace:
    """A lane change, its signals, and the messages of its bag by topic."""
    folder = tmp_path_factory.mktemp("views")
    run = load_scenario("double_lane_change", Overrides(duration=DURATION)).runs[0]
    run_offline_into(run, folder, bag=True, progress=lambda time: None)
    messages = defaultdict(list)
    with (folder / "bag" / "bag.mcap").open("rb") as file:
        for each in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages(
            VIEWED
        ):
            messages[each.channel.topic].append(each)
    signals = load(folder / "signals.npz")
    car = run.configurations["plant"].common.vehicle
    return SimpleNamespace(
        run=run, folder=folder, messages=messages, of=signals.channels, time=signals.time, car=car
    )


def frames(driven: SimpleNamespace) -> dict[str, list]:
    """Transforms at each instant, by frame."""
    found = defaultdict(list)
    for each in driven.messages["/tf"]:
        for transform in each.decoded_message.transforms:
            found[transform.child_frame_id].append(transform)
    return found


def angles(transforms: list, axis: str) -> np.ndarray:
    """Turned angle about an axis [rad], unwrapped; the others of the quaternion are zero."""
    rotations = [each.transform.rotation for each in transforms]
    assert all(
        getattr(each, other) == 0.0 for each in rotations for other in {"x", "y", "z"} - {axis}
    )
    return np.unwrap([2.0 * np.arctan2(getattr(each, axis), each.w) for each in rotations])


def shown(driven: SimpleNamespace, channel: str) -> np.ndarray:
    return driven.of[channel][::2]  # 50 of the 100 instants of a second


def test_instants_are_20_ms_apart_and_stamped_by_themselves(driven):
    instants = [each.message.log_time for each in driven.messages["/tf"]]
    assert instants == list(range(0, int(DURATION * 1e9) + 1, 20_000_000))
    for topic in ("/tf", "/ev/odometry", "/ev/tyre_force_markers"):
        for each in driven.messages[topic]:
            of = each.decoded_message
            headers = [
                e.header for e in getattr(of, "transforms", getattr(of, "markers", None)) or [of]
            ]
            assert {h.stamp.sec * 10**9 + h.stamp.nanosec for h in headers} == {
                each.message.log_time
            }


def test_the_frame_of_the_car_is_its_pose(driven):
    base = frames(driven)["base_link"]
    at = [each.transform.translation for each in base]
    assert {each.header.frame_id for each in base} == {"odom"}
    assert [each.x for each in at] == shown(driven, "pose.x").tolist()
    assert [each.y for each in at] == shown(driven, "pose.y").tolist()
    assert max(each.y for each in at) > 2.0  # m: it has changed the lane
    heading = 2.0 * np.arctan2(
        shown(driven, "pose.orientation_z"), shown(driven, "pose.orientation_w")
    )
    assert np.allclose(angles(base, "z"), np.unwrap(heading), atol=1e-12)  # rounding of arctan


def test_front_wheels_are_steered_by_ackermann(driven):
    """cot(right) - cot(left) = track / wheelbase to the left; their mean is the mean angle's."""
    left, right = (
        angles(frames(driven)[f"front_{side}_steering"], "z") for side in ("left", "right")
    )
    mean = shown(driven, "steering_column.state.road_wheel_angle")
    turning = np.abs(mean) > 1e-3  # rad, against division by zero
    assert mean.max() > 0.02 and mean.min() < -0.02 and turning.sum() > 100
    cotangents = [1.0 / np.tan(angle[turning]) for angle in (left, right)]
    assert np.allclose(
        cotangents[1] - cotangents[0], driven.car.front_track / driven.car.wheelbase, rtol=1e-9
    )
    assert np.allclose(sum(cotangents) / 2, 1.0 / np.tan(mean[turning]), rtol=1e-9)
    for side in ("left", "right"):  # this car has no steered rear wheels
        assert not angles(frames(driven)[f"rear_{side}_steering"], "z").any()


def test_wheels_roll_by_the_angle_that_they_have_turned(driven):
    for name in WHEEL_NAMES:
        turned = angles(frames(driven)[f"{name}_wheel"], "y")
        position = shown(driven, f"wheel_states.position.{name}")
        assert position[-1] > 100.0  # rad
        assert np.allclose(turned, position - position[0], atol=1e-9)  # rounding of sums of turns


def test_odometry_is_pose_and_twist_in_the_frame_of_the_car(driven):
    found = [each.decoded_message for each in driven.messages["/ev/odometry"]]
    assert {(each.header.frame_id, each.child_frame_id) for each in found} == {
        ("odom", "base_link")
    }
    assert [each.pose.pose.position.y for each in found] == shown(driven, "pose.y").tolist()
    for axes, name in (
        ("linear.x", "longitudinal"),
        ("linear.y", "lateral"),
        ("angular.z", "yaw_rate"),
    ):
        vector, axis = axes.split(".")
        values = [getattr(getattr(each.twist.twist, vector), axis) for each in found]
        assert values == shown(driven, f"twist.{name}").tolist()


def test_arrows_are_the_forces_of_the_road(driven):
    """1.5 m for the mean wheel load, m g / 4, in the axes of the steered wheel."""
    scale = 1.5 * 4.0 / (driven.car.mass * GRAVITY)
    for place, name in enumerate(WHEEL_NAMES):
        markers = [
            each.decoded_message.markers[place]
            for each in driven.messages["/ev/tyre_force_markers"]
        ]
        assert {each.header.frame_id for each in markers} == {f"{name}_steering"}
        start, end = zip(*(each.points for each in markers), strict=True)
        assert {(p.x, p.y, p.z) for p in start} == {(0.0, 0.0, 0.0)}
        for axis, way in (("x", "longitudinal"), ("y", "lateral")):
            force = shown(driven, f"tire_forces.{way}_force.{name}")
            assert np.allclose(
                [getattr(point, axis) for point in end], scale * force, rtol=1e-12, atol=1e-15
            )


def test_frames_hang_together_as_the_description_has_them(driven):
    """All links have the parent and the place of their joints.

    Lasting transforms are kept for viewers that join later.
    """
    (description,), (static,) = (
        driven.messages["/ev/robot_description"],
        driven.messages["/tf_static"],
    )
    robot = fromstring(description.decoded_message.data)
    joints = {joint.find("child").get("link"): joint for joint in robot.findall("joint")}
    moving = {name: each[0] for name, each in frames(driven).items() if name != "base_link"}
    fixed = {each.child_frame_id: each for each in static.decoded_message.transforms}
    assert joints.keys() == {**moving, **fixed}.keys() and not moving.keys() & fixed.keys()
    for name, transform in {**moving, **fixed}.items():
        at = transform.transform.translation
        assert transform.header.frame_id == joints[name].find("parent").get("link")
        place = [float(number) for number in joints[name].find("origin").get("xyz").split()]
        assert [at.x, at.y, at.z] == pytest.approx(place, rel=1e-8)  # nine digits are written
    for each in (description, static):
        assert "durability: transient_local" in each.channel.metadata["offered_qos_profiles"]


def test_layouts_show_the_car_from_a_bag(driven):
    """Topics and frames in the layouts of RViz and Foxglove exist in the bag."""
    with (driven.folder / "bag" / "bag.mcap").open("rb") as file:
        topics = {channel.topic for channel in make_reader(file).get_summary().channels.values()}
    layouts = Path(__file__).parents[3] / "config" / "layouts"
    manager = yaml.safe_load((layouts / "car.rviz").read_text())["Visualization Manager"]
    panels = json.loads((layouts / "foxglove.json").read_text())["configById"]
    plotted = [
        path["value"].partition(".")[0]
        for panel in panels.values()
        for path in panel.get("paths", ())
    ]
    displays = [each.get("Topic") or each.get("Description Topic") for each in manager["Displays"]]
    named = {*panels["3D!car"]["topics"], *plotted, *(each["Value"] for each in displays if each)}
    assert len(named) > 5 and named <= topics
    base = frames(driven)["base_link"][0]
    assert manager["Global Options"]["Fixed Frame"] == base.header.frame_id
    assert (
        manager["Views"]["Current"]["Target Frame"]
        == panels["3D!car"]["followTf"]
        == base.child_frame_id
    )


_VALUE = (
    "",
    "bool",
    "integer",
    "double",
    "string",
    "",
    "bool_array",
    "integer_array",
    "double_array",
    "string_array",
)


def test_parameters_are_those_of_all_nodes(driven):
    file = yaml.safe_load((driven.folder / "parameters.yaml").read_text())
    events = [each.decoded_message for each in driven.messages["/parameter_events"]]
    assert [each.node for each in events] == list(file)
    for event in events:
        found = {
            each.name: getattr(each.value, f"{_VALUE[each.value.type]}_value")
            for each in event.new_parameters
        }
        assert found == file[event.node]["ros__parameters"]


def test_views_are_a_small_part_of_a_bag(driven, tmp_path):
    """Less than half of what the signals take.

    On by default, they must not make bags twice as large.
    """
    topics = recorded_topics(driven.run)
    names = [f"/ev/{topic.name}" for topic in topics]
    write_bag(
        load(driven.folder / "signals.npz"), topics, names, driven.run.period, tmp_path / "bag"
    )
    sizes = [(folder / "bag" / "bag.mcap").stat().st_size for folder in (tmp_path, driven.folder)]
    assert sizes[0] < sizes[1] < 1.5 * sizes[0]
