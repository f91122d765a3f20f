"""Debugging aids in a law run in plain Python, with one note and the same numbers."""

from __future__ import annotations

from pathlib import Path

import pytest

import ev_stack
from ev_core.compiled.part import CompiledPart, NeedsPython
from ev_core.lockstep.configuration import Configuration, configure
from ev_core.lockstep.parts import is_compiled, part_of
from ev_core.methods.part import PythonPart
from ev_msgs_py.refusal import ParameterError

HEAD = '''
from dataclasses import dataclass
from numba import njit, objmode
from ev_core.law import Wheels, WheelTorqueCommand, WheelTorqueRequest, compilable, method, parameter

@dataclass(frozen=True, slots=True)
class P:
    share: float = parameter(0.5, unit="1", low=0.0, high=1.0, about="of the requested torques")

def passed_on(x):
    return x

@compilable
def helper(x):
    print("helper", x)
    return x

@njit
def jitted(x):
    print(x)
    return x

@method("asr", "mine")
@compilable
def mine(p: P, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """A law."""
    share = p.share
'''
LINES = HEAD.count("\n")
RETURN = "    return WheelTorqueCommand(Wheels(share, 2.0 * share, 0.0, 0.0), request.brake)\n"
# By what a law does: its line, the line of the file that is named, what it needs.
LOOKS = {
    "prints a number": ("print(share)", LINES + 1, "print needs Python"),
    "prints a text and a number": ('print("share", share)', LINES + 1, "print needs Python"),
    "prints nothing": ("print()", LINES + 1, "print needs Python"),
    "prints a format": ('print(f"{share:.2f}")', LINES + 1, "print needs Python"),
    "prints to an end": ('print(share, end="")', LINES + 1, "print needs Python"),
    "prints sometimes": ("if share > 2.0:\n        print(share)", LINES + 2, "print needs Python"),
    "stands at a breakpoint": (
        "if share > 2.0:\n        breakpoint()",
        LINES + 2,
        "breakpoint needs Python",
    ),
    "calls what prints": (
        "share = helper(share)",
        HEAD[: HEAD.index("print(")].count("\n") + 1,
        "print needs",
    ),
    "calls what numba made and prints": (
        "share = jitted(share)",
        HEAD[: HEAD.index("print(x)")].count("\n") + 1,
        "print needs Python",
    ),
    "leaves compiled code": (
        'with objmode(share="float64"):\n        share = passed_on(share)',
        LINES - 4,
        "it needs Python",
    ),
}


def configuration_of(folder: Path, text: str) -> Configuration:
    file = folder / "my_law.py"
    file.write_text(f"{HEAD}    {text}\n{RETURN}")
    return configure("asr", {"method": str(file)})


@pytest.mark.sampled
@pytest.mark.slow
@pytest.mark.parametrize("look", LOOKS)
def test_such_a_law_runs_in_plain_python_with_a_note(
    tmp_path: Path, look: str, capfd: pytest.CaptureFixture[str]
):
    """Nodes and offline runs make their part by the same function.

    A batch, which is for compiled laws, is refused.
    """
    text, line, what = LOOKS[look]
    configuration = configuration_of(tmp_path, text)
    assert is_compiled(configuration)
    part = part_of(configuration, compiled=True)
    assert isinstance(part, PythonPart)
    (note,) = part.notes()
    assert note.startswith(f"{configuration.method.name}, line {line}: asr law mine: {what}"), note
    assert capfd.readouterr().out == ""  # it has not been stepped for anybody to see
    common = configuration.common
    with pytest.raises(NeedsPython):
        CompiledPart(
            configuration.method, configuration.given, common.vehicle, common.control_period
        )


@pytest.mark.slow
def test_offline_it_prints_and_has_the_bits_of_the_law_without(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
):
    """A run of 0.1 s prints at each of 11 instants."""
    printing = configuration_of(tmp_path, 'print("share", share)').method.name
    one = ev_stack.run("shchur2019", method={"asr": printing}, duration=0.1)
    assert capfd.readouterr().out.count("share 0.5") == 11
    other = ev_stack.run(
        "shchur2019", method={"asr": configuration_of(tmp_path, "pass").method.name}, duration=0.1
    )
    assert one.hash == other.hash


@pytest.mark.slow
def test_in_a_batch_it_is_refused_in_one_line(tmp_path: Path):
    name = configuration_of(tmp_path, "print(share)").method.name
    with pytest.raises(
        ParameterError, match=rf"^{name}, line {LINES + 1}: asr law mine: print needs Python.*$"
    ):
        ev_stack.batch(
            "shchur2019", method={"asr": name}, vary={"asr.share": [0.1, 0.2]}, duration=0.1
        )
