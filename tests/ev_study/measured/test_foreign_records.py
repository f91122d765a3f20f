"""Bags of standard messages and CAN logs with a DBC: the same car comes back as from a CSV file."""

from __future__ import annotations

import json
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from measured.made_records import CAR, PERIOD, driven

from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.run_scenario import main
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import save
from ev_stack.scenarios.files import vehicle_of
from ev_stack.scenarios.scenario import Overrides, load_scenario
from ev_study.measured.records.mapping import read_record, read_standard
from ev_study.measured.records.record import (
    LATERAL,
    LONGITUDINAL,
    ROAD_WHEEL_ANGLE,
    SIDESLIP,
    YAW_RATE,
)

EPOCH = 1_700_000_000  # s


def write_bag(
    folder: Path,
    topics: tuple[str, ...] = ("/imu", "/odom", "/steering"),
    aside: float = 1.0,
    unstamped: str = "",
) -> Path:
    """Write a rosbag2 bag of standard messages: imu at 100 Hz, odometry and steering at 50 Hz.

    There is no lateral velocity.
    """
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    drive = "float32 steering_angle\nfloat32 speed\n"
    store.register(get_types_from_msg(drive, "ackermann_msgs/msg/AckermannDrive"))
    stamped = "std_msgs/Header header\nackermann_msgs/AckermannDrive drive\n"
    store.register(get_types_from_msg(stamped, "ackermann_msgs/msg/AckermannDriveStamped"))
    of = store.types
    vector, header = of["geometry_msgs/msg/Vector3"], of["std_msgs/msg/Header"]
    still = of["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    zeros = np.zeros(36)

    def imu(stamp, c, n):
        rate = vector(0.0, 0.0, c[YAW_RATE][n])
        force = vector(
            c["imu.longitudinal_acceleration"][n], c["imu.lateral_acceleration"][n], 9.81
        )
        return of["sensor_msgs/msg/Imu"](stamp, still, zeros[:9], rate, zeros[:9], force, zeros[:9])

    def odom(stamp, c, n):
        twist = of["geometry_msgs/msg/Twist"](
            vector(c[LONGITUDINAL][n], aside * c[LATERAL][n], 0.0), vector(0.0, 0.0, 0.0)
        )
        pose = of["geometry_msgs/msg/Pose"](of["geometry_msgs/msg/Point"](0.0, 0.0, 0.0), still)
        return of["nav_msgs/msg/Odometry"](
            stamp, "base_link", of["geometry_msgs/msg/PoseWithCovariance"](pose, zeros),
            of["geometry_msgs/msg/TwistWithCovariance"](twist, zeros),
        )  # fmt: skip

    def steering(stamp, c, n):
        inner = of["ackermann_msgs/msg/AckermannDrive"](float(c[ROAD_WHEEL_ANGLE][n]), 0.0)
        return of["ackermann_msgs/msg/AckermannDriveStamped"](stamp, inner)

    kinds = {"/imu": (imu, 1), "/odom": (odom, 2), "/odom2": (odom, 2), "/steering": (steering, 2)}
    types = {imu: "sensor_msgs/msg/Imu", odom: "nav_msgs/msg/Odometry"}
    types[steering] = "ackermann_msgs/msg/AckermannDriveStamped"
    run = driven()
    with Writer(folder / "bag", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for topic in topics:
            make, every = kinds[topic]
            connection = writer.add_connection(topic, types[make], typestore=store)
            for n in range(0, len(run.time), every):
                time = round(n * PERIOD * 1e9)
                at = (0, 0) if topic == unstamped else (EPOCH + time // 10**9, time % 10**9)
                stamp = header(of["builtin_interfaces/msg/Time"](*at), "base_link")
                data = store.serialize_cdr(make(stamp, run.channels, n), types[make])
                writer.write(connection, EPOCH * 10**9 + time, data)
    return folder / "bag"


def test_a_bag_of_standard_messages_needs_no_mapping(tmp_path):
    """Imu, odometry at half the rate and a float32 angle, a line over 20 ms of a sine of 5 rad/s.

    5e-4 of 0.14 m/s.
    """
    record = read_standard(write_bag(tmp_path))
    assert record.period == PERIOD
    assert record.valid.all()
    assert record.begin == EPOCH
    size = len(record.valid)
    for channel in (YAW_RATE, LONGITUDINAL, LATERAL, ROAD_WHEEL_ANGLE):
        assert record[channel] == pytest.approx(driven().channels[channel][:size], abs=5e-4), (
            channel
        )
    assert any("taken as measured at the centre of mass" in note for note in record.notes)


def test_a_car_is_identified_from_a_bag_that_knows_no_lateral_velocity(tmp_path, capsys):
    """Odometry of wheels has zero there.

    Each window begins 1 s earlier, and the yaw rate alone is compared.

    Yaw inertia begun 20 % off comes back to 2 %, without noise; what is left is the way into the
    window.
    """
    bag = write_bag(tmp_path, aside=0.0)
    of = [
        "identify",
        str(bag),
        "--vehicle",
        CAR,
        "--free",
        "vehicle.yaw_inertia",
        "--window",
        "2",
        "--steps",
        "5",
    ]
    main(
        [
            *of,
            "--set",
            "*.vehicle.yaw_inertia=3000.0",
            "--no-report",
            "--out",
            str(tmp_path / "out"),
        ]
    )
    assert (
        "note: twist.yaw_rate is /imu:angular_velocity.z, taken as measured"
        in capsys.readouterr().out
    )
    found = json.loads((tmp_path / "out" / "summary.json").read_text())
    truth = vehicle_of(CAR).yaw_inertia
    assert found["identified"]["vehicle.yaw_inertia"]["value"] == pytest.approx(truth, rel=0.02)
    assert SIDESLIP not in found["errors"]


@pytest.mark.parametrize(
    ("topics", "message"),
    [
        (("/imu", "/odom"), "has no steering_column.state.road_wheel_angle, expected .*Ackermann"),
        (("/imu", "/odom", "/odom2", "/steering"), "any of /odom:.*, /odom2:.*: a mapping chooses"),
    ],
)
def test_a_bag_that_says_too_little_or_too_much_is_refused(tmp_path, topics, message):
    with pytest.raises(ParameterError, match=message):
        read_standard(write_bag(tmp_path, topics))


def test_a_topic_without_stamps_beside_others_with_stamps_is_named(tmp_path):
    """The recorder's clock has a delay, and may be quite another one."""
    for name in ("without", "all"):
        (tmp_path / name).mkdir()
    record = read_standard(write_bag(tmp_path / "without", unstamped="/odom"))
    count = len(driven().time[::2])
    assert (
        f"/odom: {count} messages without a stamp count by when they were recorded" in record.notes
    )
    assert not any(
        "without a stamp" in note for note in read_standard(write_bag(tmp_path / "all")).notes
    )


def test_a_mapping_names_fields_of_a_bag(tmp_path):
    bag = write_bag(tmp_path, ("/imu", "/odom", "/odom2"))
    mapping = tmp_path / "bag.yaml"
    mapping.write_text(
        "channels:\n  twist.yaw_rate: {column: '/imu:angular_velocity.z', unit: rad/s, frame: sae}\n"
        "  twist.longitudinal: {column: '/odom2:twist.twist.linear.x', unit: m/s}\n"
        "  sideslip: '/imu:angular_velocity_covariance[0]'\n"
    )
    record = read_record(bag, mapping)
    assert record[YAW_RATE] == pytest.approx(
        -driven().channels[YAW_RATE][: len(record.valid)], abs=2e-7
    )  # doubles of the epoch
    assert not record[SIDESLIP].any()
    for wrong in (
        "/imu:angular_velocity",
        "/imu:nothing.z",
        "/nowhere:x",
        "/imu:angular_velocity_covariance[9]",
    ):
        mapping.write_text(f"channels:\n  twist.yaw_rate: '{wrong}'\n")
        with pytest.raises(ParameterError, match=r"is no number of|unknown topic"):
            read_record(bag, mapping)
    with pytest.raises(SystemExit, match=r"nowhere: No such file or directory$"):
        main(["validate", str(tmp_path / "nowhere"), "--vehicle", CAR])
    (tmp_path / "no.mcap").write_bytes(b"no bag at all")
    with pytest.raises(ParameterError, match="the bag cannot be read"):
        read_record(tmp_path / "no.mcap", mapping)


DBC = """VERSION ""
BU_: Car
BO_ 256 MOTION: 8 Car
 SG_ YAW_RATE : 0|16@1- (0.0001,0) [-3|3] "rad/s" Car
 SG_ SPEED : 16|16@1+ (0.01,0) [0|300] "km/h" Car
BO_ 257 STEERING: 2 Car
 SG_ ANGLE : 0|16@1- (0.01,0) [-300|300] "deg" Car
"""
CAN_MAPPING = """
dbc: car.dbc
channels:
  twist.yaw_rate: {column: MOTION.YAW_RATE, unit: rad/s}
  twist.longitudinal: {column: MOTION.SPEED, unit: km/h}
  steering_column.state.road_wheel_angle: {column: STEERING.ANGLE, unit: deg}
"""


def write_log(folder: Path, suffix: str) -> Path:
    """Write frames as a logger on the bus has them, between unmapped others."""
    import can
    from cantools.database import load_string

    (folder / "car.dbc").write_text(DBC)
    (folder / f"drive{suffix}.yaml").write_text(CAN_MAPPING)
    known, path, c = load_string(DBC, "dbc"), folder / f"drive{suffix}", driven().channels
    with can.Logger(path) as log:
        for n in range(0, len(driven().time), 2):
            time = EPOCH + n * PERIOD
            motion = known.encode_message(
                "MOTION", {"YAW_RATE": c[YAW_RATE][n], "SPEED": 3.6 * c[LONGITUDINAL][n]}
            )
            angle = known.encode_message("STEERING", {"ANGLE": np.degrees(c[ROAD_WHEEL_ANGLE][n])})
            for frame_id, data in ((256, motion), (257, angle), (0x7FF, b"\1")):
                log(
                    can.Message(
                        timestamp=time, arbitration_id=frame_id, data=data, is_extended_id=False
                    )
                )
    return path


@pytest.mark.parametrize(
    "suffix", [".log", ".asc", ".blf", *([".mf4"] if find_spec("asammdf") else [])]
)
def test_a_can_log_is_read_by_its_dbc(tmp_path, suffix):
    """Values agree to half a digit of the DBC, at 50 Hz; .asc has times to 1e-6 s."""
    path = write_log(tmp_path, suffix)
    record = read_record(path, tmp_path / f"drive{suffix}.yaml")
    assert record.period == pytest.approx(2 * PERIOD, abs=1e-6)
    assert record.valid.all()
    size = len(record.valid)
    assert record[YAW_RATE] == pytest.approx(driven().channels[YAW_RATE][::2][:size], abs=6e-5)
    assert record[LONGITUDINAL] == pytest.approx(
        driven().channels[LONGITUDINAL][::2][:size], abs=0.0015
    )
    assert len(record.digest) == 64


def test_what_a_can_log_lacks_is_refused(tmp_path):
    path = write_log(tmp_path, ".log")
    mapping = tmp_path / "drive.log.yaml"
    for change, message in (
        (("MOTION.SPEED", "MOTION.SPEEDS"), "unknown signal of car.dbc"),
        (("dbc: car.dbc", ""), "needs dbc"),
        (("dbc: car.dbc", "dbc: none.dbc"), "none.dbc: No such file"),
        (("dbc: car.dbc", "dbc: car.dbc\ntime: t"), "no use for time"),
    ):
        mapping.write_text(CAN_MAPPING.replace(*change))
        with pytest.raises(ParameterError, match=message):
            read_record(path, mapping)
    mapping.write_text(CAN_MAPPING)
    path.write_text(path.read_text().splitlines()[0] + "\n")
    with pytest.raises(ParameterError, match=r"no frame with STEERING\.ANGLE"):
        read_record(path, mapping)
    if not find_spec("asammdf"):
        (tmp_path / "drive.mf4").write_bytes(b"")
        for text in (CAN_MAPPING, CAN_MAPPING.replace("dbc: car.dbc", "")):
            mapping.write_text(text)
            with pytest.raises(
                ParameterError, match="needs the Python package asammdf, which is missing"
            ):
                read_record(tmp_path / "drive.mf4", mapping)


@pytest.mark.skipif(
    not find_spec("asammdf"), reason="asammdf is not installed: only what it refuses is tested"
)
def test_channels_of_an_mdf_file_are_read_by_name(tmp_path):
    """Each has its own times, as in a measuring tool; a missing one, or a text, is refused."""
    from asammdf import MDF, Signal

    c, time = driven().channels, driven().time
    with MDF() as file:
        for name, channel, every in (("r", YAW_RATE, 1), ("v", LONGITUDINAL, 2)):
            file.append(Signal(c[channel][::every], time[::every], name=name))
        file.append(Signal(np.array([b"text"] * 9), time[:9], name="note", encoding="utf-8"))
        file.save(tmp_path / "drive.mf4")
    mapping = tmp_path / "drive.yaml"
    mapping.write_text("channels: {twist.yaw_rate: r, twist.longitudinal: v}")
    record = read_record(tmp_path / "drive.mf4", mapping)
    size = len(record.valid)
    assert record.valid.all()
    assert record[YAW_RATE] == pytest.approx(c[YAW_RATE][:size], abs=1e-9)
    assert record[LONGITUDINAL] == pytest.approx(c[LONGITUDINAL][:size], abs=5e-4)
    for name, message in (("rr", "unknown channel of"), ("note", "cannot be read")):
        mapping.write_text(f"channels: {{twist.yaw_rate: {name}}}")
        with pytest.raises(ParameterError, match=message):
            read_record(tmp_path / "drive.mf4", mapping)


def test_pedals_drive_the_car_as_the_imposed_speed_does(tmp_path):
    """Torques of a run of ours that a driver drove, imposed on its car.

    Its speed and yaw rate come back to 0.1 %.
    """
    run = load_scenario("double_lane_change", Overrides(duration=6.0)).runs[0]
    save(run_offline(run.configurations, 6.0), tmp_path / "signals.npz")
    for impose in ("pedals", "torques"):
        of = [
            "validate",
            str(tmp_path / "signals.npz"),
            "--vehicle",
            "audi_a2",
            "--window",
            "2",
            "--impose",
            impose,
        ]
        main([*of, "--no-report", "--out", str(tmp_path / impose)])
        found = json.loads((tmp_path / impose / "summary.json").read_text())["errors"]
        assert found["twist.longitudinal"]["rms"] < 0.02
        assert found["twist.yaw_rate"]["explained"] > 0.99
