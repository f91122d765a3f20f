"""CSV files and clocks as other people's loggers have them.

Read whole, or one line that names what is not.
"""

from __future__ import annotations

import lzma
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from measured.made_records import MAPPING, columns_of, driven, write
from measured.test_foreign_records import write_bag

from ev_msgs_py.refusal import ParameterError
from ev_study.measured.records import bags
from ev_study.measured.records.mapping import read_record
from ev_study.measured.records.record import LONGITUDINAL, YAW_RATE, MeasuredRecord
from ev_study.measured.records.samples import believed


def text_of(folder: Path) -> str:
    return write(folder, columns_of(driven())).read_text()


def read(folder: Path, content: str | bytes, name: str = "made.csv") -> MeasuredRecord:
    (folder / name).write_bytes(content.encode() if isinstance(content, str) else content)
    (folder / "made.yaml").write_text(MAPPING)
    return read_record(folder / name, folder / "made.yaml")


def assert_whole(record: MeasuredRecord, notes: tuple[str, ...] = ()) -> None:
    """The car as it was driven, to the digits of the file."""
    assert record.valid.all()
    assert record.notes == notes
    for channel in (YAW_RATE, LONGITUDINAL):
        assert record[channel] == pytest.approx(driven().channels[channel], abs=1e-7)


def test_an_xz_file_is_read_to_the_end_of_its_last_stream_or_refused(tmp_path):
    """Loggers append streams; a file that was copied in part lacks the end."""
    text = text_of(tmp_path).encode()
    at = text.index(b"\n", len(text) // 2) + 1
    assert_whole(read(tmp_path, lzma.compress(text[:at]) + lzma.compress(text[at:]), "made.csv.xz"))
    whole = lzma.compress(text)
    for end in (len(whole) // 2, len(whole) - 1):
        with pytest.raises(
            ParameterError, match=r"made\.csv\.xz is no CSV table .*ended before the end-of-stream"
        ):
            read(tmp_path, whole[:end], "made.csv.xz")


def test_a_row_that_is_cut_off_is_named(tmp_path):
    lines = text_of(tmp_path).splitlines()
    with pytest.raises(
        ParameterError,
        match=rf"made\.csv: line {len(lines)} has 3 cells, expected 6, as the header",
    ):
        read(tmp_path, "\n".join([*lines[:-1], ",".join(lines[-1].split(",")[:3])]))


def test_other_separators_and_headers_are_read(tmp_path):
    """Semicolons with decimal commas, tabs, a header behind "#", comments, quotes, empty lines."""
    text = text_of(tmp_path)
    header, _, rows = text.partition("\n")
    for other in (
        text.replace(",", ";").replace(".", ","),
        text.replace(",", "\t"),
        f"# {text}",
        f"\n{header}\n# by hand\n\n{rows}\n\n",
        '"' + header.replace(",", '","') + '"\r\n' + rows.replace("\n", "\r\n"),
    ):
        assert_whole(read(tmp_path, other))


def test_a_row_of_units_is_held_against_the_mapping(tmp_path):
    header, _, rows = text_of(tmp_path).partition("\n")
    assert_whole(read(tmp_path, f"{header}\nms,[km/h],m/s,deg/s,m/s^2,°\n{rows}"))
    with pytest.raises(
        ParameterError,
        match=r"twist\.yaw_rate: r is in deg/s by the mapping and in 'rad/s' by the file",
    ):
        read(tmp_path, f"{header}\nms,km/h,m/s,rad/s,m/s2,deg\n{rows}")
    # m/s and N have the same factor to SI.
    with pytest.raises(ParameterError, match="is in m/s by the mapping and in 'N' by the file"):
        read(tmp_path, f"{header}\nms,km/h,N,deg/s,m/s2,deg\n{rows}")


def test_a_unit_in_brackets_of_the_header_counts_as_a_row_of_units_does(tmp_path):
    """Loggers write "speed [km/h]"; what is in brackets and is no unit is a part of the name."""
    _, _, rows = text_of(tmp_path).partition("\n")
    header = "t [ms],speed (km/h),vy [m/s],r [deg/s],ay [raw],steer (front)"
    (tmp_path / "made.csv").write_text(f"{header}\n{rows}")
    mapping = tmp_path / "made.yaml"
    named = MAPPING
    for name in header.split(","):
        column = name.partition(" ")[0]
        named = named.replace(f"column: {column},", f"column: '{name}',")
    mapping.write_text(named)
    assert_whole(read_record(tmp_path / "made.csv", mapping))
    for unit in (", unit: ms", ", unit: km/h", ", unit: deg/s"):
        assert unit in named
        named = named.replace(unit, "")
    mapping.write_text(named)
    assert_whole(read_record(tmp_path / "made.csv", mapping))
    mapping.write_text(named.replace("r [deg/s]',", "r [deg/s]', unit: rad/s,"))
    with pytest.raises(
        ParameterError, match=r"is in rad/s by the mapping and in 'deg/s' by the file"
    ):
        read_record(tmp_path / "made.csv", mapping)


def test_a_time_as_text_is_refused_and_another_text_counted(tmp_path):
    header, first, *rows = text_of(tmp_path).splitlines()
    clock = [",".join(["2026-05-04T10:00:00", *row.split(",")[1:]]) for row in rows]
    with pytest.raises(
        ParameterError,
        match=r"made\.csv: t: 1200 cells are no numbers, such as '2026-.* in line 3, exp",
    ):
        read(tmp_path, "\n".join([header, first, *clock]))
    cells = rows[500].split(",")
    cells[3] = "ERR"
    record = read(tmp_path, "\n".join([header, first, *rows[:500], ",".join(cells), *rows[501:]]))
    assert "r: 1 cells are no numbers, such as 'ERR' in line 503, passed over" in record.notes
    assert record.valid.all()


def test_a_clock_reading_ahead_or_behind_costs_one_row(tmp_path):
    """Row 300 comes from tomorrow or from 1970; those behind it count. The gap is bridged."""
    for wrong in (1e12, -1e12, 9000.0):
        columns = columns_of(driven())
        columns["t"][300] = wrong
        record = read_record(write(tmp_path, columns), tmp_path / "made.yaml")
        assert "1 of 1201 samples passed over: their times do not increase" in record.notes[0]
        assert len(record.valid) == 1201
        assert record.valid.all()


def test_a_clock_that_was_set_late_or_runs_backwards_is_named(tmp_path):
    """The first 100 rows are of the day before and passed over.

    Where most do not increase, nothing is read.
    """
    columns = columns_of(driven())
    columns["t"][100:] += 1e8
    record = read_record(write(tmp_path, columns), tmp_path / "made.yaml")
    assert "100 of 1201 samples passed over" in record.notes[0]
    columns["t"] = columns["t"][::-1]
    with pytest.raises(
        ParameterError, match=r"does not increase, .*: \d+ of 1201 samples are not later"
    ):
        read_record(write(tmp_path, columns), tmp_path / "made.yaml")


def test_times_of_another_unit_that_leave_no_period_are_refused(tmp_path):
    """Seconds that the mapping takes for microseconds."""
    columns = columns_of(driven())
    columns["t"] = 1e-3 * columns["t"]
    path, mapping = write(tmp_path, columns), tmp_path / "made.yaml"
    mapping.write_text(MAPPING.replace("unit: ms", "unit: us"))
    with pytest.raises(
        ParameterError, match=r"made\.csv: samples are 1e-08 s apart, .*: unit of the time\?"
    ):
        read_record(path, mapping)


@pytest.mark.parametrize(("first", "second"), [(1201, 900), (700, 1201)])
def test_of_two_drives_in_one_file_the_longer_one_is_read(tmp_path, first, second):
    """Each begins at 0 s.

    No instant of the one stands behind those of the other, as if the car had jumped there.
    """
    one = {name: values[:first] for name, values in columns_of(driven()).items()}
    other = {name: values[:second] for name, values in columns_of(driven(seed=1)).items()}
    both = {name: np.concatenate([one[name], other[name]]) for name in one}
    record = read_record(write(tmp_path, both), tmp_path / "made.yaml")
    longer = driven() if first > second else driven(seed=1)
    assert f"{min(first, second)} of {first + second} samples passed over" in record.notes[0]
    for channel in (YAW_RATE, LONGITUDINAL):
        assert record[channel] == pytest.approx(longer.channels[channel], abs=1e-7)


def test_a_stamp_of_a_bag_from_the_future_costs_one_message(tmp_path, monkeypatch):
    """Its topic loses that message; the others keep all of theirs."""
    bag = write_bag(tmp_path)
    column = "/imu:angular_velocity.z"
    read_all = bags.read_columns

    def spoilt(of: Path, wanted: list[str]) -> object:
        found = read_all(of, wanted)
        found.columns[column].time[200] += 3600.0
        return found

    monkeypatch.setattr(bags, "read_columns", spoilt)
    (tmp_path / "bag.yaml").write_text(
        f"channels:\n  twist.yaw_rate: '{column}'\n  twist.longitudinal: '/odom:twist.twist.linear.x'\n"
    )
    record = read_record(bag, tmp_path / "bag.yaml")
    assert record.notes[0].startswith("twist.yaw_rate: 1 of ")
    assert record.valid.all()
    assert record[YAW_RATE] == pytest.approx(
        driven().channels[YAW_RATE][: len(record.valid)], abs=1e-3
    )


@settings(deadline=None)
@given(
    wrong=st.dictionaries(
        st.integers(0, 199), st.floats(allow_nan=True, allow_infinity=True), max_size=40
    ),
    order=st.permutations(range(8)),
)
def test_believed_times_increase_and_are_most_of_them(wrong, order):
    """No more of 200 readings are lost than are spoilt, and the rest increases."""
    time = 0.01 * np.arange(200)
    time[list(wrong)] = list(wrong.values())
    kept = believed(time)
    assert (np.diff(time[kept]) > 0.0).all()
    assert kept.sum() >= 200 - len(wrong)
    time[100:108] = time[100:108][list(order)]
    assert (np.diff(time[believed(time)]) > 0.0).all()
