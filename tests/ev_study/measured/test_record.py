"""Records as others write them are read as what they mean, or refused in one line."""

from __future__ import annotations

import numpy as np
import pytest
from measured.made_records import CHANNELS, MAPPING, columns_of, driven, write

from ev_msgs_py.refusal import ParameterError
from ev_study.measured.records.mapping import read_record
from ev_study.measured.records.record import SIDESLIP, ColumnParameters
from ev_study.measured.replays.open_loop import windows_of


@pytest.mark.parametrize("name", ["made.csv", "made.csv.xz"])
def test_units_axes_and_place_of_the_sensor_are_taken_back(tmp_path, name):
    """km/h, degrees, SAE axes, a sensor 1 m ahead and 0.5 m to the left: to the digits of the file.

    The acceleration goes through two derivatives of the yaw rate, one of the file's digits: 1e-4
    m/s^2.
    """
    path = write(tmp_path, columns_of(driven()), name)
    record = read_record(path, tmp_path / "made.yaml")
    for channel in CHANNELS.values():
        if channel != "time":
            tolerance = 1e-4 if channel.endswith("acceleration") else 1e-7
            assert record[channel] == pytest.approx(driven().channels[channel], abs=tolerance)
    assert record.period == 0.01
    assert record.valid.all()
    truth = np.arctan2(driven().channels["twist.lateral"], driven().channels["twist.longitudinal"])
    assert record[SIDESLIP] == pytest.approx(truth, abs=1e-7)


@pytest.mark.parametrize(
    ("channel", "sign"),
    [
        *(
            (f"twist.{name}", sign)
            for name, sign in (("longitudinal", 1.0), ("lateral", -1.0), ("yaw_rate", -1.0))
        ),
        *(
            (f"imu.{name}", sign)
            for name, sign in (("longitudinal_acceleration", 1.0), ("lateral_acceleration", -1.0))
        ),
        *(
            (f"steering_column.state.{name}", -1.0)
            for name in ("angle", "rate", "hand_torque", "road_wheel_rate")
        ),
        *(
            (f"{name}.rear_left", 1.0)
            for name in ("wheel_states.velocity", "tire_forces.load", "torque_command.drive")
        ),
        *(
            ("tire_forces.lateral_force.front_left", -1.0),
            (SIDESLIP, -1.0),
            ("rear_steering.state.angle", -1.0),
        ),
    ],
)
def test_the_axes_of_sae_turn_the_sign_of_all_that_points_to_the_left(channel, sign):
    """Axes with y right and z down turn each such channel that an estimator may read."""
    assert ColumnParameters(frame="sae").factor(channel) == sign
    assert ColumnParameters(frame="iso").factor(channel) == 1.0


def test_a_short_spike_is_bridged_and_a_gap_is_masked(tmp_path):
    """One sample that jumps by 10 deg is interpolated.

    Half a second without rows splits the windows.
    """
    columns = columns_of(driven())
    columns["steer"][300] += 10.0
    kept = np.ones(len(columns["t"]), bool)
    kept[700:750] = False
    record = read_record(
        write(tmp_path, {n: v[kept] for n, v in columns.items()}), tmp_path / "made.yaml"
    )
    angle = "steering_column.state.road_wheel_angle"
    # a line for 20 ms of sines of up to 5 rad/s and 0.7 deg: 0.0122 * 25 * 0.02^2 / 8
    assert record[angle][:700] == pytest.approx(driven().channels[angle][:700], abs=2e-5)
    assert record.valid[:700].all()
    assert not record.valid[700:750].any()
    assert record.valid[750:].all()
    begins = windows_of(record, 2.0).first
    assert begins.tolist() == [0, 200, 400, 750, 950]
    with pytest.raises(
        ParameterError,
        match=r"^no window of 5 s without a gap from 8\.0 s to 12\.0 s of .*made\.csv, expected a",
    ):
        windows_of(record, 5.0, 2 / 3)
    assert record.notes == ("51 instants in 2 jumps and gaps, 1 of them bridged, 1 masked",)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("column: r,", "column: rr,"), "unknown column of"),
        (("unit: deg/s", "unit: furlong"), "unit"),
        (("twist.yaw_rate", "twist.yawrate"), "unknown channel"),
        (("time: {column: t, unit: ms}", ""), "needs time"),
        (("frame: sae", "frame: left"), "frame"),
    ],
)
def test_a_wrong_mapping_is_refused_in_one_line(tmp_path, change, message):
    path = write(tmp_path, {n: v[:5] for n, v in columns_of(driven()).items()})
    mapping = tmp_path / "made.yaml"
    mapping.write_text(MAPPING.replace(*change))
    with pytest.raises(ParameterError, match=message) as refused:
        read_record(path, mapping)
    assert str(mapping) in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    "text",
    ["", "t,speed\n1,2,3\n4,5,6\n", "t,speed\n"],
)
def test_a_file_without_a_table_is_refused(tmp_path, text):
    (tmp_path / "made.csv").write_text(text)
    (tmp_path / "made.yaml").write_text(MAPPING)
    with pytest.raises(ParameterError, match=r"made\.csv"):
        read_record(tmp_path / "made.csv", tmp_path / "made.yaml")
