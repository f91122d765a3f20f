"""Laws that the command line adds to a board.

Driven and ranked beside the others, or refused in one line.
"""

from __future__ import annotations

import argparse
import json
import re
import shlex
from dataclasses import replace
from pathlib import Path

import pytest

from ev_core.parameters.data_file import files_in_config
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.run_scenario import main
from ev_study.benchmark.added import check_laws, with_added
from ev_study.benchmark.board import read_board
from ev_study.commands.benchmark import _words, run_benchmark

EXAMPLE = str(Path(__file__).parents[3] / "docs" / "examples" / "yaw_moment.py")
CELL = "layout_1_8_c:all:step_steer:wet:*"
LAW = '''
from dataclasses import dataclass

from ev_core.law import DriverCommand, Wheels, WheelTorqueRequest, compilable, method, parameter


@dataclass(frozen=True, slots=True)
class Parameters:
    """Of a law that pulls."""

    pull: float = parameter(0.0, unit="N m", low=-100.0, high=100.0, about="to the left")


@method("electronic_differential", "pulls", mirrored=True)
@compilable
def pulls(p: Parameters, driver: DriverCommand) -> WheelTorqueRequest:
    """Pull to one side."""
    quarter = driver.drive_torque / 4.0
    brake = driver.brake_torque / 4.0
    return WheelTorqueRequest(Wheels(quarter, quarter + p.pull, quarter, quarter), Wheels(brake, brake, brake, brake))
'''


def parameter_file(folder: Path, values: str) -> Path:
    """A file of parameters of the electronic differential."""
    path = folder / "tuned.yaml"
    path.write_text(f"/**/electronic_differential:\n  ros__parameters: {values}\n")
    return path


def test_a_law_file_and_a_law_with_its_parameter_file_are_ranked_beside_the_others(tmp_path: Path):
    """An allowed moment of 1 N m is no control: it costs what equal torques do, to 1 %.

    The law itself 2 % off.
    """
    weak = parameter_file(tmp_path, "{largest: 1.0}")
    out = tmp_path / "out"
    adding = ["--add", EXAMPLE, "--add", f"{EXAMPLE}={weak}"]
    run_benchmark(
        [*adding, "--cells", CELL, "--laws", "equal_torque", "--draws", "2", "--out", str(out)]
    )
    scores = json.loads((out / "board.json").read_text())["scores"]
    assert list(scores) == ["equal_torque", "yaw_moment", "tuned"]
    assert scores["tuned"]["handling"]["value"] == pytest.approx(1.0, abs=0.01)
    assert abs(scores["yaw_moment"]["handling"]["value"] - 1.0) > 0.02


@pytest.mark.weekly
def test_a_law_may_name_the_traction_control_as_well(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    """Brakes on snow lock all wheels; an ABS by the drives takes most of the slip away.

    The line beside the run drives it as a scenario, with its signal hash.
    """
    cell, out, file = "compact_ev:rear:brake:snow:*", tmp_path / "out", tmp_path / "firm.yaml"
    file.write_text("/**/asr:\n  ros__parameters: {method: blended_brakes, slip.target: 0.05}\n")
    words = [
        "--add",
        f"equal_torque={file}",
        "--cells",
        cell,
        "--laws",
        "equal_torque",
        "--draws",
        "1",
        "--no-report",
    ]
    run_benchmark([*words, "--out", str(out)])
    equal, firm = json.loads((out / "runs.json").read_text())["runs"]
    assert firm["slip_energy"] < 0.2 * equal["slip_energy"]
    main(
        [
            *shlex.split(firm["command"])[1:],
            "--offline",
            "--no-report",
            "--out",
            str(tmp_path / "alone"),
        ]
    )
    assert f"signal hash {firm['signal_hash']}\n" in capsys.readouterr().out
    board, names = with_added(read_board("small"), ["least_squares"])
    assert board.laws["least_squares"] == {"method": "equal_torque", "asr.method": "least_squares"}
    assert names == ["least_squares"]


def test_what_cannot_be_added_is_one_line(tmp_path: Path):
    board, law = read_board("small"), tmp_path / "my_law.py"
    law.write_text(LAW.replace("@compilable\n", ""))
    found, names = with_added(board, [str(law)])
    with pytest.raises(
        ParameterError,
        match="law my_law runs in plain Python, expected on a board are laws that run",
    ):
        check_laws(found, names, names)
    law.write_text(LAW)
    found, names = with_added(board, [f"{law}={parameter_file(tmp_path, '{pull: 5.0}')}"])
    with pytest.raises(
        ParameterError, match=r"law tuned with compact_ev:rear: .*not alike"
    ) as refused:
        check_laws(found, names, names)
    assert "\n" not in str(refused.value)
    found, names = with_added(board, [f"pi={parameter_file(tmp_path, '{smallest_speed: 5.0}')}"])
    with pytest.raises(
        ParameterError, match="law tuned: unknown parameter of electronic_differential"
    ):
        check_laws(found, names, names)
    of_asr = {
        "equal_torque": {"method": "equal_torque", "asr.method": "off", "asr.least_slip": 0.1}
    }
    with pytest.raises(
        ParameterError, match="parameter least_slip is refused: asr method off does not have it"
    ):
        check_laws(replace(board, laws=of_asr), ["equal_torque"], [])
    with pytest.raises(
        ParameterError, match="--add 'pi': the board has a law 'pi', expected another name"
    ):
        with_added(board, ["pi"])


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("{method: load_proportional}", "{method: ./my_law.py}"),
        ("steering_column.scale: 1.0", "electronic_differential.method: ./my_law.py"),
    ],
)
def test_no_board_makes_a_law_file_run(tmp_path: Path, old: str, new: str):
    """Neither in its laws nor in the values of a manoeuvre.

    The file would leave a mark if it ran.
    """
    mark = tmp_path / "mark"
    (tmp_path / "my_law.py").write_text(f"open({str(mark)!r}, 'w').close()\n")
    path = tmp_path / "own.yaml"
    path.write_text(files_in_config("benchmarks")["small"].read_text().replace(old, new, 1))
    with pytest.raises(ParameterError, match=re.escape("is refused, expected from a file a name")):
        run_benchmark([str(path), "--draws", "1", "--out", str(tmp_path / "out")])
    assert not mark.exists()


def test_the_line_that_drives_a_run_again_has_whole_paths(tmp_path, monkeypatch):
    """It is copied into another folder, or another day."""
    monkeypatch.chdir(tmp_path)
    added = ["law.py:NAME=a.yaml", "law.py", "pi=a.yaml", "pi_slip"]
    words = _words(argparse.Namespace(draws=2, seed=None, add=added, held_out=None, board=None))
    found = [word for word, before in zip(words[1:], words, strict=False) if before == "--add"]
    law, values = tmp_path / "law.py", tmp_path / "a.yaml"
    assert found == [f"{law}:NAME={values}", str(law), f"pi={values}", "pi_slip"]
