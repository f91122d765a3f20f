"""A law in a Python file of one's own, by its path: no package, no installation."""

from __future__ import annotations

import pickle
import subprocess
from pathlib import Path

import pytest
from helpers.run_script import ENVIRONMENT, RUN

import ev_stack
from ev_core.check.method import ContractError, check_method
from ev_core.lockstep.configuration import configure
from ev_core.lockstep.finding import find_method
from ev_core.methods.register import methods_of
from ev_msgs_py.refusal import ParameterError

EXAMPLES = Path(__file__).parents[3] / "docs" / "examples"
LIMIT = """
from dataclasses import dataclass

from ev_control.asr.off import off
from ev_core.law import Wheels, WheelTorqueCommand, WheelTorqueRequest, compilable, method, parameter


@dataclass(frozen=True, slots=True)
class LimitParameters:
    share: float = parameter(0.5, unit="1", low=0.0, high=1.0, about="of the requested torques")


@method("asr", "NAME")
@compilable
def share(p: LimitParameters, request: WheelTorqueRequest) -> WheelTorqueCommand:
    \"\"\"Let a share of the torques through.\"\"\"
    fl, fr, rl, rr = request.drive
    return WheelTorqueCommand(Wheels(SHARE * fl, SHARE * fr, SHARE * rl, SHARE * rr), request.brake)
"""


def law_file(folder: Path, name: str = "share", share: str = "p.share") -> Path:
    file = folder / "my_law.py"
    file.write_text(LIMIT.replace("NAME", name).replace("SHARE", share))
    return file


def driven(file: Path, **how) -> ev_stack.Result:
    return ev_stack.run("shchur2019", method={"asr": str(file)}, duration=1.0, **how)


@pytest.mark.slow
@pytest.mark.weekly
def test_a_law_is_chosen_by_the_path_of_its_file_offline_and_over_dds(tmp_path):
    """Its parameters come with it; a share of 1 is `off`, to the bit."""
    file = law_file(tmp_path)
    signals = driven(file, set={"asr.share": 0.25}).signals
    assert (
        signals["torque_command.drive.front_left"]
        == 0.25 * signals["torque_request.drive.front_left"]
    ).all()
    off = ev_stack.run("shchur2019", duration=1.0).hash
    assert driven(file, set={"asr.share": 1.0}).hash == off
    words = [
        RUN,
        "shchur2019",
        "--no-record",
        "--no-report",
        "--duration",
        "1",
        "--method",
        f"asr={file}",
    ]
    words += ["--set", "asr.share=1", "--out", str(tmp_path / "out")]
    output = subprocess.run(
        words, env=ENVIRONMENT, check=True, capture_output=True, text=True
    ).stdout
    assert f"signal hash {off}" in output


def test_what_is_edited_acts_at_once(tmp_path):
    """An edit acts in the same process under the same names.

    The text before gives its bits again.
    """
    found = {}
    for share in ("0.5", "0.3", "0.5"):
        signals = driven(law_file(tmp_path, share=share)).signals
        command = signals["torque_command.drive.front_left"]
        assert (command == float(share) * signals["torque_request.drive.front_left"]).all()
        assert found.setdefault(share, command).tobytes() == command.tobytes()


def test_it_hides_no_built_in_law_of_its_name(tmp_path):
    """The imports of the file are there for all as before."""
    known = methods_of("asr")
    assert (
        driven(law_file(tmp_path, "pi_slip")).hash != ev_stack.run("shchur2019", duration=1.0).hash
    )
    assert methods_of("asr") == known


def test_one_of_several_is_named_behind_the_path():
    """The two laws of the example are one law."""
    file = EXAMPLES / "own_law.py"
    with pytest.raises(
        ParameterError,
        match=r"several laws: limit_in_python, limit_compiled; choose one by own_law\.py:",
    ):
        find_method("asr", str(file))
    with pytest.raises(
        ParameterError, match="no law 'limit', expected one of limit_in_python, limit_compiled"
    ):
        find_method("asr", f"{file}:limit")
    hashes = {driven(f"{file}:{name}").hash for name in ("limit_in_python", "limit_compiled")}
    assert len(hashes) == 1


def test_it_keeps_the_contract_and_goes_to_other_processes(tmp_path):
    file = str(law_file(tmp_path))
    check_method("asr", file)
    configuration = configure("asr", {"method": file, "share": 0.25})
    again = pickle.loads(pickle.dumps(configuration))
    assert again.method == configuration.method and again.parameters == configuration.parameters


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = 1\n", r'the file has no law of this node, marked @method\("asr", \.\.\.\)'),
        ("x = 1\nx = = 2\n", "line 2: SyntaxError: invalid syntax"),
        ("\nimport nowhere\n", "line 2: ModuleNotFoundError: No module named 'nowhere'"),
        ("def f():\n    raise ValueError('no')\n\nf()\n", "line 2: ValueError: no"),
        (
            LIMIT.replace("request: WheelTorqueRequest", "request"),
            "line 13: TypeError: asr method NAME: argument request has no annotation",
        ),
    ],
)
def test_a_mistake_in_the_file_is_one_line(tmp_path, text, message):
    file = tmp_path / "my_law.py"
    file.write_text(text)
    with pytest.raises(ParameterError, match=rf"^asr method {file}: {message}") as refused:
        find_method("asr", str(file))
    assert "\n" not in str(refused.value)


def test_no_file_of_data_may_name_one(tmp_path):
    """It is code: only the command line and Python choose it."""
    law, more = law_file(tmp_path), tmp_path / "more.yaml"
    for name in (law, f"{law}:share"):
        more.write_text(f"/**/asr:\n  ros__parameters:\n    method: {name}\n")
        with pytest.raises(
            ParameterError, match=r"is refused, expected from a file a name: .*code is named on the"
        ):
            ev_stack.run("shchur2019", params=[more], duration=0.1)


def test_what_is_not_there_is_refused(tmp_path):
    with pytest.raises(ParameterError, match=r"nowhere\.py: No such file"):
        find_method("asr", str(tmp_path / "nowhere.py"))


@pytest.mark.weekly
def test_the_check_refuses_what_another_c_library_rounds_otherwise(tmp_path):
    """Functions are found by module, by name and in numpy; the exact ones of math pass."""
    for take, used in (
        ("import math", "math.tan"),
        ("from math import tan", "tan"),
        ("import numpy as np", "np.sin"),
    ):
        file = law_file(tmp_path, share=f"{used}(p.share)")
        file.write_text(f"{take}\n{file.read_text()}")
        name = used.replace("np.", "numpy.")
        with pytest.raises(
            ContractError,
            match=rf"{file}, line 19: {name} is rounded otherwise elsewhere, take it from",
        ):
            check_method("asr", str(file))
    file = law_file(tmp_path, share="math.sqrt(TABLE[0] * p.share)")
    file.write_text(
        f"import math\nimport numpy as np\nTABLE = np.array([1.0, 2.0])\n{file.read_text()}"
    )
    check_method("asr", str(file))
