"""Speed profiles from CSV files."""

from __future__ import annotations

import pytest

from ev_msgs_py.refusal import ParameterError
from ev_sim.profiles.profile import SpeedProfileParameters, wanted_speed, with_profile_from_file


def write(folder, text: str) -> SpeedProfileParameters:
    (folder / "cycle.csv").write_text(text)
    return SpeedProfileParameters(file=str(folder / "cycle.csv"))


@pytest.mark.parametrize(
    ("header", "speeds"), [("t_s,v_kmh", "36.0,-18"), ("v_mps, t_s,note", "10, -5.0")]
)
def test_profile_file_in_either_unit(tmp_path, header, speeds):
    first, second = speeds.split(",")
    rows = (
        f"0,{first}\n2.5,{second}\n"
        if header.startswith("t_s")
        else f"{first},0,a\n{second},2.5,b\n"
    )
    got = with_profile_from_file(write(tmp_path, f"{header}\n{rows}"))
    assert got.time == (0.0, 2.5)
    assert got.speed == pytest.approx((10.0, -5.0), rel=1e-15)
    assert got.file == ""


def test_without_a_file_nothing_is_read():
    parameters = SpeedProfileParameters()
    assert with_profile_from_file(parameters) is parameters


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time,v_mps\n0,0\n", "line 1: no header with the columns t_s and one of v_mps and v_kmh"),
        ("t_s,speed\n0,0\n", "line 1: no header with the columns t_s and one of v_mps and v_kmh"),
        ("", "line 1: no header with the columns"),
        (
            "t_s,v_mps,v_kmh\n0,0,0\n",
            "line 1: v_mps and v_kmh are both there, expected one of them",
        ),
        (
            "t_s;v_kmh\n0;0,0\n",
            "line 1: columns are separated by ';', expected ',', and a point in decimals",
        ),
        (
            "t_s,v_mps,grade\n0,0,0\n1,1,0.06\n",
            "line 1: column grade is not read, expected zeros in it",
        ),
        ("t_s,v_mps\n", "time and speed have 0 and 0 elements"),
        ("t_s,v_mps\n0,0\n2,1\n1,2\n", "time: 1 s after 2 s is refused, expected increasing time"),
        ("t_s,v_mps\n0,0\n1,nan\n", "line 3: v_mps is no finite number"),
        ("t_s,v_mps\n0,0\ninf,1\n", "line 3: t_s is no finite number"),
        ("t_s,v_mps\n0,fast\n", "line 2: v_mps is no finite number"),
        ("t_s,v_mps\n0\n", "line 2: v_mps is no finite number"),
        ("t_s,v_kmh\n0,3600\n", "speed: 1000.0 is refused, expected -100 to 100 m/s"),
    ],
)
def test_bad_profile_files_are_refused_in_one_line(tmp_path, text, message):
    with pytest.raises(ParameterError, match=message) as error:
        with_profile_from_file(write(tmp_path, text))
    assert str(error.value).startswith(f"speed_profile.file: {tmp_path / 'cycle.csv'}: ")
    assert "\n" not in str(error.value)


def test_missing_and_binary_profile_files_are_named(tmp_path):
    with pytest.raises(
        ParameterError, match=r"^speed_profile.file: .*none.csv: No such file or directory$"
    ):
        with_profile_from_file(SpeedProfileParameters(file="none.csv"))
    (tmp_path / "binary.csv").write_bytes(b"\xff\xfe\x00t_s")
    with pytest.raises(ParameterError, match=r"^speed_profile.file: .*binary.csv: no CSV text$"):
        with_profile_from_file(SpeedProfileParameters(file=str(tmp_path / "binary.csv")))


def test_profile_of_an_unread_file_is_refused_by_the_name_of_its_parameters():
    unread = SpeedProfileParameters(file="cycle.csv")
    with pytest.raises(
        ParameterError,
        match=r"^imposed_speed.file: cycle.csv has not been read into time and speed$",
    ):
        wanted_speed(unread, "imposed_speed")
