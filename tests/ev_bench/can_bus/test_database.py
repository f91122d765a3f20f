"""A database that we cannot speak is refused in one line with file and place."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from can_bus.databases import FILE, ours
from fuzz.fuzzing import assert_one_line, fuzzed
from hypothesis import example, given
from hypothesis import strategies as st

from ev_bench.bus.parameters import load_database
from ev_msgs_py.can.payload import extracted, inserted
from ev_msgs_py.refusal import ParameterError

TEXT = FILE.read_text()


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        (" 139 ", " 2147483787 ", "frame Drive11_Faults: only classic frames with 11 bits"),
        ("24|16@1- (0.03125", "31|16@0- (0.03125", "Drive11_SetPoint, signal Torque: only whole numbers in Intel"),
        ("Crc", "Sum", "Drive11_Faults: Crc must be at bit 0"),
        ("Drive11_SetPoint: 8", "Drive12_SetPoint: 8", "two frames with the name Drive12_SetPoint"),
        (" 140 ", " 139 ", "two frames with the identifier 139"),
        ("(0.03125,0) [-1000|1000]", "(0,0) [-1000|1000]", "Torque: scale 0 and offset 0 are refused, expected"),
        ("24|16@1- (0.03125,0) [-1000", "24|16@1- (0.03125,0) [-2000", "-2000 to 1000 is refused, its 16 bits hold"),
        ("BA_DEF_ BO_", "BA_DEFINE_ BO_", "Invalid syntax"),
        ("Drive11_SetPoint: 8", "Drive11_SetPoint: 100000000", "expected frames of 8 bytes and the bits in them"),
        ("24|16@1- (0.03125", "24|300000000@1- (0.03125", "'24|300000000@' is refused"),
        ("24|16@1- (0.03125", "300000000 //\n | 16@1- (0.03125", "expected frames of 8 bytes and the bits in them"),
        ("24|16@1- (0.03125", "2.4|16@1- (0.03125", "2.4"),
        ("BA_DEF_ BO_", "SG_MUL_VAL_ //\n 139 Torque Torque 0-5000000000; BA_DEF_ BO_", "no multiplexing are spoken"),
    ],
)  # fmt: skip
def test_refused_databases(tmp_path: Path, before: str, after: str, message: str):
    assert before in TEXT
    file = tmp_path / "own.dbc"
    file.write_text(TEXT.replace(before, after))
    with pytest.raises(ParameterError) as refused:
        load_database(str(file))
    assert str(file) in str(refused.value)
    assert message in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_file_that_is_not_there(tmp_path: Path):
    with pytest.raises(
        ParameterError, match=r"CAN database .*none.dbc: No such file or directory$"
    ):
        load_database(str(tmp_path / "none.dbc"))


def test_binary_rubbish(tmp_path: Path):
    file = tmp_path / "rubbish.dbc"
    file.write_bytes(bytes(range(256)))
    with pytest.raises(ParameterError, match="CAN database"):
        load_database(str(file))


def test_an_unknown_frame_is_named_with_the_known_ones():
    with pytest.raises(
        ParameterError, match="unknown CAN frame 'Drive13_Motion'; did you mean Drive1"
    ):
        ours()["Drive13_Motion"]


def test_frames_of_a_device():
    names = {
        frame.name for frame in ours() if frame.sender == "Drive11" or "Drive11" in frame.receivers
    }
    assert names == {"Ecu_Heartbeat"} | {
        f"Drive11_{kind}" for kind in ("SetPoint", "Motion", "Electrical", "Temperatures", "Faults")
    }


NUMBERS = st.sampled_from(
    ["0", "-0.03125", "1e-320", "1e308", "1e400", "-1e400", "nan", "1E-9", "1000", "-1000", "65536"]
)
PLACES = st.integers(0, 70)


@fuzzed(40, 0.05)
@given(PLACES, PLACES, st.sampled_from("+-"), *[NUMBERS | st.floats(-1e6, 1e6).map(repr)] * 4)
@example(24, 16, "-", "0", "0", "0", "1000")
@example(24, 16, "-", "0.03125", "0", "nan", "1000")
@example(24, 8, "-", "0.03125", "0", "-1000", "1000")
@example(24, 16, "-", "0.03125", "1e400", "-1000", "1000")
@example(24, 16, "-", "0.03125", "0", "1000", "-1000")
@example(24, 0, "-", "0.03125", "0", "-1000", "1000")
@example(4, 16, "-", "0.03125", "0", "-1000", "1000")
def test_a_signal_that_is_taken_says_what_it_can_and_no_more(
    tmp_path_factory, start, length, sign, scale, offset, low, high
):
    """Any place and any numbers.

    One line, or each value of the range arrives within half a step.
    """
    before = "24|16@1- (0.03125,0) [-1000|1000]"
    assert before in TEXT
    file = tmp_path_factory.mktemp("dbc") / "own.dbc"
    file.write_text(
        TEXT.replace(before, f"{start}|{length}@1{sign} ({scale},{offset}) [{low}|{high}]")
    )
    try:
        field = load_database(str(file))["Drive11_SetPoint"].signals["Torque"]
    except ParameterError as refused:
        assert_one_line(refused)
        return
    for value in (field.low, field.high, 0.5 * (field.low + field.high), -math.inf, math.inf):
        arrived = extracted(inserted(0, field, value), field)
        limited = min(max(value, field.low), field.high)
        assert arrived == pytest.approx(limited, abs=0.5001 * field.scale)
