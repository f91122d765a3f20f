"""A database that we cannot speak is refused in one line with file and place."""

from __future__ import annotations

from pathlib import Path

import pytest
from can_bus.databases import FILE, ours

from ev_msgs_py.can.database import load_database
from ev_msgs_py.parameters.declaration import ParameterError

TEXT = FILE.read_text()


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        (" 139 ", " 2147483787 ", "frame Drive11_Faults: only classic frames with 11 bits"),
        ("24|16@1- (0.03125", "31|16@0- (0.03125", "Drive11_SetPoint, signal Torque: only whole numbers in Intel"),
        ("Crc", "Sum", "Drive11_Faults: Crc must be at bit 0"),
        ("BA_DEF_ BO_", "BA_DEFINE_ BO_", "Invalid syntax"),
    ],
)  # fmt: skip
def test_refused_databases(tmp_path: Path, before: str, after: str, said: str):
    assert before in TEXT
    file = tmp_path / "own.dbc"
    file.write_text(TEXT.replace(before, after))
    with pytest.raises(ParameterError) as refused:
        load_database(str(file))
    assert str(file) in str(refused.value)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_file_that_is_not_there(tmp_path: Path):
    with pytest.raises(ParameterError, match=r"CAN database .*none.dbc: No such file or directory$"):
        load_database(str(tmp_path / "none.dbc"))


def test_binary_rubbish(tmp_path: Path):
    file = tmp_path / "rubbish.dbc"
    file.write_bytes(bytes(range(256)))
    with pytest.raises(ParameterError, match="CAN database"):
        load_database(str(file))


def test_an_unknown_frame_is_named_with_the_known_ones():
    with pytest.raises(ParameterError, match="unknown CAN frame 'Drive13_Motion'; known: Drive1"):
        ours()["Drive13_Motion"]


def test_frames_of_a_device():
    names = {frame.name for frame in ours().of_device("Drive11")}
    assert names == {"Ecu_Heartbeat"} | {
        f"Drive11_{kind}" for kind in ("SetPoint", "Motion", "Electrical", "Temperatures", "Faults")
    }
