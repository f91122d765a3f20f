"""Logs of CAN buses as other people's cars have them.

What is passed over is counted, what is ambiguous is refused.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from ev_msgs_py.refusal import ParameterError
from ev_study.measured.records.mapping import read_record
from ev_study.measured.records.record import (
    LONGITUDINAL,
    STEERING_WHEEL_ANGLE,
    YAW_RATE,
    MeasuredRecord,
)

STEPS, PERIOD = 200, 0.01
DBC = """VERSION ""
BU_: Car
BO_ 420 SPEED: 8 Car
 SG_ V : 0|16@1+ (0.01,0) [0|400] "km/h" Car
BO_ 544 YAW: 8 Car
 SG_ RATE : 0|16@1- (0.01,0) [-200|200] "deg/s" Car
 SG_ TEMP : 48|8@1+ (1,-40) [-40|200] "degC" Car
BO_ 37 ANGLE: 8 Car
 SG_ SWA : 7|16@0- (0.1,0) [-1000|1000] "deg" Car
"""
MAPPING = """
dbc: car.dbc
channels:
  twist.longitudinal: {column: SPEED.V, unit: km/h}
  twist.yaw_rate: {column: YAW.RATE, unit: deg/s}
  steering_column.state.angle: {column: ANGLE.SWA, unit: deg}
"""
Line = tuple[float, str, str, bytes]  # time [s], bus, id as candump writes it, data


def speed(n: int) -> int:
    return 5400 + 10 * abs(n % 100 - 50)


def rate(n: int) -> int:
    return int(1000.0 * np.sin(0.05 * n))


def lines() -> list[Line]:
    """Two seconds of three messages, 100 a second each."""
    found = []
    for n in range(STEPS):
        time = 100.0 + n * PERIOD
        found.append((time, "can0", "1A4", speed(n).to_bytes(2, "little") + bytes(6)))
        found.append(
            (time + 0.001, "can0", "220", rate(n).to_bytes(2, "little", signed=True) + bytes(6))
        )
        found.append(
            (time + 0.002, "can0", "025", (3 * n).to_bytes(2, "big", signed=True) + bytes(6))
        )
    return found


def text_of(frames: Iterable[Line]) -> str:
    return "".join(
        f"({time:.6f}) {bus} {name}#{data.hex().upper()}\n" for time, bus, name, data in frames
    )


def read(
    folder: Path,
    frames: Iterable[Line],
    dbc: bytes = DBC.encode(),
    mapping: str = MAPPING,
    name: str = "drive.log",
) -> MeasuredRecord:
    (folder / name).write_text(text_of(frames))
    (folder / "car.dbc").write_bytes(dbc)
    (folder / "drive.yaml").write_text(mapping)
    return read_record(folder / name, folder / "drive.yaml")


def refusal(folder: Path, frames: Iterable[Line], **of: object) -> str:
    with pytest.raises(ParameterError) as refused:
        read(folder, frames, **of)  # type: ignore[arg-type]
    assert "\n" not in str(refused.value)
    return str(refused.value)


def assert_same(record: MeasuredRecord, other: MeasuredRecord, tolerance: float = 0.0) -> None:
    assert record.channels.keys() == other.channels.keys()
    for channel, values in other.channels.items():
        assert record[channel] == pytest.approx(values, abs=tolerance), channel


@pytest.fixture
def clean(tmp_path: Path) -> MeasuredRecord:
    """The record of the log as it should be, which is as it was driven."""
    record = read(tmp_path, lines())
    assert record.notes == ()
    assert record.valid.all()
    # The clock is that of the yaw rate, and begins with the last message of the first instant.
    assert record[LONGITUDINAL][0] == pytest.approx(speed(0) / 360.0, abs=0.01)
    assert record[YAW_RATE].max() == pytest.approx(np.radians(10.0), abs=1e-3)
    return record


def changed(at: int, change: Callable[[Line], Line]) -> list[Line]:
    found = lines()
    found[at] = change(found[at])
    return found


def test_a_frame_that_is_too_short_is_passed_over_and_counted(tmp_path, clean):
    """1 of 200 is bridged by a line for 20 ms, where the speed turns by 0.1 km/h a step."""
    record = read(tmp_path, changed(300, lambda line: (*line[:3], b"\1")))
    assert any(
        note == "1 of 200 frames of SPEED passed over: too short for SPEED.V"
        for note in record.notes
    )
    assert record.valid.all()
    assert_same(record, clean, 0.04)


def test_frames_shorter_than_the_dbc_have_the_bits_that_they_have(tmp_path, clean):
    """Four bytes of eight hold the yaw rate, but not the unmapped temperature."""
    short = [(time, bus, name, data[:4]) for time, bus, name, data in lines()]
    record = read(tmp_path, short)
    assert record.notes == ()
    assert_same(record, clean)
    wanted = MAPPING + "  motor_temperatures.winding.front_left: YAW.TEMP\n"
    assert "200 of 200 frames of YAW passed over: too short for YAW.TEMP" in refusal(
        tmp_path, short, mapping=wanted
    )


PAGES = DBC.replace(
    ' SG_ V : 0|16@1+ (0.01,0) [0|400] "km/h" Car',
    ' SG_ PAGE M : 16|8@1+ (1,0) [0|255] "" Car\n'
    ' SG_ V m0 : 0|16@1+ (0.01,0) [0|400] "km/h" Car\n'
    ' SG_ OIL m1 : 0|8@1+ (1,-40) [-40|215] "degC" Car',
).encode()


def test_a_page_that_the_dbc_does_not_have_is_passed_over_and_counted(tmp_path, clean):
    frames = lines()
    for n in range(40):
        frames.append((100.005 + n * PERIOD, "can0", "1A4", bytes((1, 2, 7, 0, 0, 0, 0, 0))))
    record = read(tmp_path, sorted(frames), PAGES)
    assert record.notes == (
        "40 of 240 frames of SPEED passed over: expected multiplexer id 0 or 1, but got 7",
    )
    assert_same(record, clean)


def test_a_value_beyond_the_range_of_the_dbc_is_passed_over_and_counted(tmp_path, clean):
    """0x7FFF is 327.67 deg/s where 200 are declared.

    A control unit sends it for "not available".
    """
    record = read(tmp_path, changed(301, lambda line: (*line[:3], b"\xff\x7f" + bytes(6))))
    assert any(
        "YAW.RATE: 1 of 200 values passed over, expected in the DBC's range of -200" in n
        for n in record.notes
    )
    assert_same(record, clean, 0.04)  # a line for 20 ms where the speed turns, as above
    every = [(*line[:3], b"\xff\x7f" + bytes(6)) if line[2] == "220" else line for line in lines()]
    assert "no frame with YAW.RATE that can be read; YAW.RATE: 200 of 200 values" in refusal(
        tmp_path, every
    )


def test_a_range_of_zero_to_zero_is_none(tmp_path, clean):
    """DBC files have [0|0] as long as their author gave no range."""
    for other in ("[0|0]", "[200|-200]"):
        record = read(tmp_path, lines(), DBC.replace("[-200|200]", other).encode())
        assert record.notes == ()
        assert_same(record, clean)


@pytest.mark.parametrize(
    ("at", "data"), [(301, b"\xd0\x3f"), (300, b"\x10\x27")], ids=["yaw rate", "speed"]
)
def test_a_spike_within_the_range_is_bridged(tmp_path, clean, at, data):
    """The yaw rate jumps by 163 deg/s and back within 10 ms, the speed by 12 m/s: no car does."""
    record = read(tmp_path, changed(at, lambda line: (*line[:3], data + bytes(6))))
    assert any(
        "1 of 200 samples passed over, which jump as no car does" in note for note in record.notes
    )
    assert_same(record, clean, 0.06)


@pytest.mark.parametrize("frames", [1, 3, 8])
@pytest.mark.parametrize("place", ["beginning", "end"])
def test_values_of_a_sensor_that_has_not_begun_or_has_ended_are_passed_over(
    tmp_path, clean, frames, place
):
    """182 km/h more than the car drives, in the first or last frames.

    It is they that are wrong, not the one beside.
    """
    of_speed = range(0, 3 * STEPS, 3)
    spoilt = of_speed[:frames] if place == "beginning" else of_speed[-frames:]
    found = lines()
    for n in spoilt:
        found[n] = (*found[n][:3], (speed(n // 3) + 18200).to_bytes(2, "little") + bytes(6))
    record = read(tmp_path, found)
    assert (
        f"twist.longitudinal: {frames} of 200 samples passed over, which jump as no car does"
        in record.notes
    )
    apart = np.abs(record[LONGITUDINAL] - clean[LONGITUDINAL])
    assert apart.max() < 0.3  # 8 frames in which the speed changes by 0.1 km/h each
    assert record.valid.all() == (frames <= 5)  # 0.05 s are bridged


def test_the_same_id_on_two_buses_is_refused_or_chosen(tmp_path, clean):
    """Another sensor sends the yaw rate with an offset of 30 deg/s on a second bus."""
    frames = lines()
    for n in range(STEPS):
        frames.append(
            (
                100.006 + n * PERIOD,
                "can1",
                "220",
                (rate(n) + 3000).to_bytes(2, "little", signed=True) + bytes(6),
            )
        )
    frames.sort()
    assert "0x220 (YAW) is on can0 and can1, expected one of them as `channel`" in refusal(
        tmp_path, frames
    )
    assert_same(read(tmp_path, frames, mapping=MAPPING + "channel: can0\n"), clean)
    # speed and angle are on the first one alone
    other = read(tmp_path, frames, mapping=MAPPING + "channel: can1\n")
    assert other[YAW_RATE].min() == pytest.approx(np.radians(20.0), abs=1e-3)
    assert "can0 and can1" in refusal(tmp_path, frames, mapping=MAPPING + "channel: can7\n")


def test_only_messages_that_are_wanted_have_to_be_sound(tmp_path, clean):
    lamps = ' SG_ A : 0|8@1+ (1,0) [0|255] "" Car\n SG_ B : 3|1@1+ (1,0) [0|1] "" Car\n'
    assert_same(read(tmp_path, lines(), (DBC + "BO_ 1000 LAMPS: 8 Car\n" + lamps).encode()), clean)
    spoilt = DBC.replace(" SG_ TEMP", ' SG_ OTHER : 3|4@1+ (1,0) [0|0] "" Car\n SG_ TEMP')
    assert "car.dbc: " in refusal(tmp_path, lines(), dbc=spoilt.encode())


@pytest.mark.parametrize(
    ("comment", "encoding"),
    [("方向盘转角，向左为正", "utf-8"), ("方向盘转角，向左为正", "gbk"), ("0,1° und Öl", "cp1252")],
)
def test_comments_of_a_dbc_are_in_any_encoding(tmp_path, clean, comment, encoding):
    dbc = DBC + f'CM_ SG_ 37 SWA "{comment}";\n'
    assert_same(read(tmp_path, lines(), dbc.encode(encoding)), clean)


def test_a_unit_with_a_degree_sign_is_understood_in_any_encoding(tmp_path, clean):
    dbc, mapping = (
        DBC.replace('"deg"', '"°"').replace('"deg/s"', '"°/s"'),
        MAPPING.replace(", unit: deg/s", ""),
    )
    for encoding in ("utf-8", "cp1252"):
        assert_same(read(tmp_path, lines(), dbc.encode(encoding), mapping), clean)


def test_without_a_unit_in_the_mapping_that_of_the_dbc_counts(tmp_path, clean):
    plain = MAPPING
    for unit in ("km/h", "deg/s", "deg"):
        plain = plain.replace(f", unit: {unit}}}", "}")
    assert "unit" not in plain
    record = read(tmp_path, lines(), mapping=plain)
    assert record.notes == ()
    assert_same(record, clean)
    record = read(tmp_path, lines(), DBC.replace('"deg/s"', '""').encode(), plain)
    assert record.notes == (
        "YAW.RATE has no unit, neither in the file nor in the mapping, and is taken as rad/s",
    )


@pytest.mark.parametrize(
    ("change", "line"),
    [
        (
            ("unit: km/h", "unit: mph"),
            "SPEED.V is in mph by the mapping and in 'km/h' by the file, expected the same",
        ),
        (
            ("unit: km/h", "unit: degC"),
            "SPEED.V is in degC by the mapping and in 'km/h' by the file",
        ),
        (
            ("{column: YAW.RATE, unit: deg/s}", "SPEED.V"),
            "the unit is km/h, expected rad/s, deg/s, rpm",
        ),
        (
            ("{column: YAW.RATE, unit: deg/s}", "YAW.TEMP"),
            "the unit is degC, expected rad/s, deg/s, rpm",
        ),
        (("unit: deg/s", "unit: deg/s, radius: 0.3"), "radius is refused"),
    ],
)
def test_units_that_contradict_the_dbc_or_the_channel_are_refused(tmp_path, change, line):
    assert line in refusal(tmp_path, lines(), mapping=MAPPING.replace(*change))


def test_an_unknown_unit_of_the_dbc_needs_one_in_the_mapping(tmp_path, clean):
    dbc = DBC.replace('"km/h"', '"furlong/fortnight"').encode()
    assert_same(read(tmp_path, lines(), dbc), clean)
    without = MAPPING.replace("{column: SPEED.V, unit: km/h}", "SPEED.V")
    assert "has the unit 'furlong/fortnight' in the file, expected one of" in refusal(
        tmp_path, lines(), dbc=dbc, mapping=without
    )


def test_a_wheel_speed_in_km_h_needs_the_radius_of_the_wheel(tmp_path):
    wheel = "wheel_states.velocity.front_left"
    mapping = MAPPING + f"  {wheel}: SPEED.V\n"
    assert "expected rad/s, deg/s, rpm, or the radius of the wheel beside a speed" in refusal(
        tmp_path, lines(), mapping=mapping
    )
    record = read(
        tmp_path,
        lines(),
        mapping=mapping.replace(f"{wheel}: SPEED.V", f"{wheel}: {{column: SPEED.V, radius: 0.3}}"),
    )
    assert record[wheel] == pytest.approx(record[LONGITUDINAL] / 0.3)


J1939 = """VERSION ""
BU_: Abs
BO_ 2566847742 CCVS1: 8 Abs
 SG_ V : 8|16@1+ (0.00390625,0) [0|250.996] "km/h" Abs
BO_ 2565868030 VDC2: 8 Abs
 SG_ RATE : 24|16@1+ (0.00012207031,-3.92) [-3.92|3.92] "rad/s" Abs
"""
OF_J1939 = "dbc: car.dbc\nchannels: {twist.longitudinal: CCVS1.V, twist.yaw_rate: VDC2.RATE}\n"


def truck(source: int, start: int = 0) -> list[Line]:
    found = []
    for n in range(start, STEPS):
        found.append(
            (
                n * PERIOD,
                "can0",
                f"18FEFC{source:02X}",
                b"\xff" + (14000 + n).to_bytes(2, "little") + bytes(5),
            )
        )
        found.append(
            (
                n * PERIOD,
                "can0",
                f"18F009{source:02X}",
                bytes(3) + (32112 + n).to_bytes(2, "little") + bytes(3),
            )
        )
    return found


def test_the_null_address_of_a_j1939_dbc_means_any_source(tmp_path):
    """FE in the DBC, 0B on the bus: parameter groups, not ids, name the messages there."""
    record = read(tmp_path, truck(0x0B), J1939.encode(), OF_J1939)
    assert_same(record, read(tmp_path, truck(0xFE), J1939.encode(), OF_J1939))
    assert record[LONGITUDINAL][0] == pytest.approx(14000 / 256 / 3.6)
    line = refusal(
        tmp_path, sorted(truck(0x0B) + truck(0x21)), dbc=J1939.encode(), mapping=OF_J1939
    )
    assert "CCVS1 comes as 18FEFC0B and 18FEFC21, expected a DBC with one of these ids" in line


def test_another_source_than_that_of_the_dbc_is_named(tmp_path):
    """0x98FEFC21: a DBC that means one control unit."""
    dbc = J1939.replace("2566847742", str(0x98FEFC21)).encode()
    line = refusal(tmp_path, truck(0x0B), dbc=dbc, mapping=OF_J1939)
    assert (
        "no frame with CCVS1.V: the DBC has it as 18FEFC21, the log has 18FEFC0B; priority or source differ"
        in line
    )


@pytest.mark.parametrize("base", ["absolute", "relative"])
def test_times_of_an_asc_file_are_relative_or_negative_as_well(tmp_path, clean, base):
    """A trigger in the middle makes the times before it negative.

    Relative ones count from the line before.
    """
    first, last, rows = lines()[0][0], None, []
    for time, _, name, data in lines():
        written = time - first - 1.0 if base == "absolute" or last is None else time - last
        last = time
        rows.append(f"{written:11.6f} 1  {int(name, 16):X}             Rx   d 8 {data.hex(' ')}")
    head = f"date Mon May 4 10:00:00 2026\nbase hex  timestamps {base}\nno internal events logged\n"
    (tmp_path / "drive.ASC").write_text(head + "\n".join(rows) + "\n")
    record = read_record(tmp_path / "drive.ASC", tmp_path / "drive.yaml")
    assert_same(record, clean, 2e-4)  # times to 1e-6 s


def test_the_buses_of_an_asc_file_have_the_numbers_that_it_writes(tmp_path, clean):
    """The first one is 1, as its tools show it."""
    rows = []
    for time, _, name, data in lines():
        for bus, spoilt in ((1, False), (2, name == "220")):
            shown = (bytes(2) if spoilt else data[:2]) + data[2:]
            rows.append(
                f"{time - 100.0 + 0.0001 * bus:11.6f} {bus}  {int(name, 16):X}             Rx   d 8 {shown.hex(' ')}"
            )
    head = (
        "date Mon May 4 10:00:00 2026\nbase hex  timestamps absolute\nno internal events logged\n"
    )
    (tmp_path / "drive.asc").write_text(head + "\n".join(rows) + "\n")
    with pytest.raises(ParameterError, match="is on 1 and 2, expected one of them as `channel`"):
        read_record(tmp_path / "drive.asc", tmp_path / "drive.yaml")
    for bus, largest in ((1, float(clean[YAW_RATE].max())), (2, 0.0)):
        (tmp_path / "drive.yaml").write_text(MAPPING + f"channel: {bus}\n")
        record = read_record(tmp_path / "drive.asc", tmp_path / "drive.yaml")
        assert record[YAW_RATE].max() == pytest.approx(largest, abs=1e-3)


def test_what_is_no_log_is_refused_by_its_suffix_or_where_it_ends(tmp_path, clean):
    line = refusal(tmp_path, lines(), name="drive.dat")
    assert (
        "drive.dat: expected a file ending with .csv, .csv.xz, .log, .asc, .trc, .blf, .mf4, "
        in line
    )
    text = text_of(lines())
    (tmp_path / "drive.log").write_text(text[: len(text) // 2 - 30])
    with pytest.raises(ParameterError, match=r"cannot be read behind frame \d+ at 10\d\.\d+ s: "):
        read_record(tmp_path / "drive.log", tmp_path / "drive.yaml")


def goes_back(frames: list) -> bool:
    """Return True if times of one message do not increase.

    A first frame stamped too early lies before the record.
    """
    before: dict[str, float] = {}
    for time, _, name, data in frames:
        if len(data) > 1 and time <= before.get(name, -math.inf):
            return True
        if len(data) > 1:
            before[name] = time
    return False


@settings(
    max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@example(spoilt={0: "early"})
@example(spoilt={3 * STEPS - 1: "late"})
@given(
    spoilt=st.dictionaries(
        st.integers(0, 3 * STEPS - 1),
        st.sampled_from(["lost", "cut", "late", "early", "twice"]),
        max_size=12,
    )
)
def test_a_few_spoilt_frames_never_move_the_others(tmp_path, spoilt):
    """Lost, cut, stamped ahead or behind by hours, doubled.

    The rest stays within what 0.1 s of the drive changes.

    Instants that are believed differ by no more than a line over 12 frames in a row does; what was
    cut or stamped wrong is in the notes.
    """
    frames = []
    for place, line in enumerate(lines()):
        time, bus, name, data = line
        kind = spoilt.get(place)
        if kind == "cut":
            frames.append((time, bus, name, data[:1]))
        elif kind in ("late", "early"):
            frames.append((time + (7200.0 if kind == "late" else -90.0), bus, name, data))
        elif kind != "lost":
            frames += [line] * (2 if kind == "twice" else 1)
    record, clean = read(tmp_path, frames), read(tmp_path, lines())
    inner = range(15, STEPS - 15)
    if all(place // 3 in inner for place in spoilt):
        assert len(record.valid) == len(clean.valid)
        for channel, tolerance in (
            (YAW_RATE, 0.03),
            (LONGITUDINAL, 1.4),
            (STEERING_WHEEL_ANGLE, 1e-6),
        ):
            apart = np.abs(record[channel] - clean[channel])[record.valid]
            assert apart.max() <= tolerance, channel
    assert goes_back(frames) <= any("do not increase" in note for note in record.notes)
    assert any(kind == "cut" for kind in spoilt.values()) == any(
        "too short" in note for note in record.notes
    )
