"""What is wrong with a law that cannot be compiled is one line: file, line, what it is, what to write instead."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import ev_sim
from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.refusal import ParameterError
from ev_sim.commands.run_scenario import main as run_scenario

HEAD = '''
from dataclasses import dataclass
import numpy as np
from ev_core.law import Wheels, WheelTorqueCommand, WheelTorqueRequest, compilable, entry, method, parameter

@dataclass(frozen=True, slots=True)
class P:
    share: float = parameter(0.5, unit="1", low=0.0, high=1.0, about="of the requested torques")

@dataclass(slots=True)
class S:
    x: float = entry(unit="1", about="a number")

def helper(x):
    return 2.0 * x

class K: pass
k, table, counter = K(), {"a": 1.0}, [0]

@method("asr", "mine", P, state=S)
@compilable
def mine(p, car, s, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """A law."""
    fl, fr, rl, rr = request.drive
'''
LINES = HEAD.count("\n")


def first_wheel(value: str) -> str:
    return f"return WheelTorqueCommand(Wheels({value}, fr, rl, rr), request.brake)"


MISTAKES = {
    "a function without the mark": (first_wheel("helper(fl)"), "helper is not marked @compilable"),
    "a function of numpy": (first_wheel("np.clip(fl, 0.0, 1.0)"), "clip is not compiled for what it is given"),
    "a generator": (
        "return WheelTorqueCommand(Wheels(*(min(t, 1.0) for t in request.drive)), request.brake)",
        "a generator or inner function is used, write its terms out",
    ),
    "a signal without all fields": (
        "return WheelTorqueCommand(Wheels(fl, fr, rl, rr))",
        "a signal or Wheels lacks some of its fields, give all of them",
    ),
    "no such number of the car": (
        first_wheel("fl * car.wheel_base"),
        "wheel_base is not known here, perhaps wheelbase",
    ),
    "no such parameter": (first_wheel("fl * p.shar"), "shar is not known here, perhaps share is meant"),
    "no such field": (first_wheel("request.driv.front_left"), "driv is not known here, perhaps drive is meant"),
    "no such state": (f"s.y = 1.0; {first_wheel('fl')}", "'S' object has no attribute 'y'"),
    "no such name": (first_wheel("fl * nothing"), "name 'nothing' is not defined"),
    "a dictionary": (
        first_wheel('fl * table["a"]'),
        "table is of type dict, allowed are numbers, tuples and functions",
    ),
    "a list of the module": (f"counter[0] += 1; {first_wheel('fl * counter[0]')}", "counter is a list, allowed are"),
    "an object": (first_wheel("fl * k.x"), "x is not known here"),
    "a text": (f'print(f"{{fl:.2f}}"); {first_wheel("fl")}', "a text is made, allowed are numbers"),
    "too few arguments": (first_wheel("max()"), "max expected at least 1 argument, got 0"),
    "no answer": ("s.x = fl", "it returns NoneType, allowed is WheelTorqueCommand"),
    "another answer": ("return fl", "it returns float, allowed is WheelTorqueCommand"),
}
ANSWERS = ("no answer", "another answer")  # known only where the law ends: named is its first line
FIELDS = ("a signal without all fields",)  # of which the compiler names no line


def law_file(folder: Path, text: str) -> Path:
    file = folder / "my_law.py"
    file.write_text(f"{HEAD}    {text}\n")
    return file


@pytest.mark.slow
@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_one_line(tmp_path: Path, name: str):
    text, said = MISTAKES[name]
    file = law_file(tmp_path, text)
    line = LINES - 4 if name in (*ANSWERS, *FIELDS) else LINES + 1
    with pytest.raises(ParameterError) as refused:
        ev_sim.run("shchur2019", method={"asr": str(file)}, duration=0.1)
    assert re.match(rf"{file}, line {line}: asr law mine: {re.escape(said)}", str(refused.value)), refused.value
    assert "\n" not in str(refused.value) and refused.value.__cause__ is not None


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize(
    "text",
    [
        f"assert fl < 0.0; {first_wheel('fl')}",
        f"x = 1.0 if fl > 1e9 else None; {first_wheel('x')}",
        f"if fl >= 0.0: raise ValueError; {first_wheel('fl')}",
    ],
)
def test_what_a_compiled_law_raises_ends_the_run(tmp_path: Path, text: str):
    """Nobody can catch it in compiled code, which went on with zeros once, and status 0."""
    text = text.replace("ValueError; ", "ValueError\n    ")
    with pytest.raises(SignalError, match=r"asr: WheelTorqueCommand\.drive\.front_left is nan"):
        ev_sim.run("shchur2019", method={"asr": str(law_file(tmp_path, text))}, duration=0.1)


def test_the_command_line_shows_the_rest_on_demand(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    words = [
        "shchur2019",
        "--offline",
        "--method",
        f"asr={law_file(tmp_path, 'return fl')}",
        "--out",
        str(tmp_path / "out"),
    ]
    for more, rest in (([], False), (["--traceback"], True)):
        with pytest.raises(SystemExit, match="it returns float, allowed is WheelTorqueCommand"):
            run_scenario([*words, *more])
        assert ("TypingError" in capsys.readouterr().err) == rest
