"""A mistake in a law that cannot be compiled is one line: file, line, mistake, remedy."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import ev_stack
from ev_core.lockstep.finding import find_method
from ev_core.methods.law_error import LawError
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.run_scenario import main as run_scenario

HEAD = '''
from dataclasses import dataclass
import numpy as np
from ev_core.law import Wheels, WheelTorqueCommand, WheelTorqueRequest, compilable, entry, method, parameter

@dataclass(frozen=True, slots=True)
class P:
    share: float = parameter(0.5, unit="1", low=0.0, high=1.0, about="of the requested torques")
    kind: str = parameter("eco", choices=("eco", "sport"), about="how it drives")

@dataclass(slots=True)
class S:
    x: float = entry(unit="1", about="a number")

def helper(x):
    return 2.0 * x

@compilable
def remembered(x, before=[]):
    return x

@compilable
def named(x, **more):
    return x

class K: pass
k, table, counter = K(), {"a": 1.0}, [0]

@method("asr", "mine")
@compilable
def mine(p: P, car, s: S, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """A law."""
    fl, fr, rl, rr = request.drive
'''
LINES = HEAD.count("\n")


def first_wheel(value: str) -> str:
    return f"return WheelTorqueCommand(Wheels({value}, fr, rl, rr), request.brake)"


MISTAKES = {
    "a function without the mark": (first_wheel("helper(fl)"), "helper is not marked @compilable"),
    "a function of numpy": (
        first_wheel("np.clip(fl, 0.0, 1.0)"),
        "clip is not compiled for what it is given",
    ),
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
    "no such parameter": (
        first_wheel("fl * p.shar"),
        "shar is not known here, perhaps share is meant",
    ),
    "no such field": (
        first_wheel("request.driv.front_left"),
        "driv is not known here, perhaps drive is meant",
    ),
    "no such state": (f"s.y = 1.0; {first_wheel('fl')}", "'S' object has no attribute 'y'"),
    "no such name": (first_wheel("fl * nothing"), "name 'nothing' is not defined"),
    "a dictionary": (
        first_wheel('fl * table["a"]'),
        "table is of type dict, expected numbers, tuples and functions",
    ),
    "a list of the module": (
        f"counter[0] += 1; {first_wheel('fl * counter[0]')}",
        "counter is a list, expected",
    ),
    "an object": (first_wheel("fl * k.x"), "x is not known here"),
    "a text": (first_wheel('len(f"{fl:.2f}")'), "a text is made, expected numbers"),
    "too few arguments": (first_wheel("max()"), "max expected at least 1 argument, got 0"),
    "no answer": ("s.x = fl", "it returns NoneType, expected WheelTorqueCommand"),
    "another answer": ("return fl", "it returns float, expected WheelTorqueCommand"),
    "no end": (
        f"while True:\n        fl = 0.5 * fl\n    {first_wheel('fl')}",
        "the loop never ends, give it a bound",
    ),
    "recursion": ("return mine(p, car, s, request)", "mine calls itself, write a loop"),
    "a caught exception": (
        f"try:\n        fl = fl / rl\n    except:\n        fl = 0.0\n    {first_wheel('fl')}",
        "an exception is caught, test the condition instead",
    ),
    "an import within": (
        f"import math; {first_wheel('math.sqrt(fl)')}",
        "a module is imported here, import it at the top",
    ),
    "a global variable": (
        f"global k; k = fl; {first_wheel('fl')}",
        "k is set for all objects of the law, declare it as",
    ),
    "a choice by its text": (
        first_wheel('fl if p.kind == "sport" else 0.0'),
        "a choice is compared with a text, expected a member of its Choice",
    ),
    "a text made of a number": (
        first_wheel("float(str(fl))"),
        "str makes a text, expected numbers",
    ),
    "a parameter that is written": (
        f"p.share = 1.0; {first_wheel('fl')}",
        "p.share is written, p is only read: what",
    ),
    "an input that is written": (
        "request.drive.front_left = 0.0; return WheelTorqueCommand(request.drive, request.brake)",
        "request.drive.front_left is written, request is only read: make a new signal",
    ),
    "an entry by its text": (f's["x"] = fl; {first_wheel("fl")}', 's["x"] is not known, write s.x'),
    "no number in the state": (
        f"s.x = request.drive; {first_wheel('fl')}",
        "s.x becomes Wheels, expected a number",
    ),
    "another signal": (
        "return WheelTorqueRequest(request.drive, request.brake)",
        "it returns WheelTorqueRequest, expected WheelTorqueCommand",
    ),
    "a list for wheels": (
        "return WheelTorqueCommand([fl, fr, rl, rr], request.brake)",
        "drive of its WheelTorqueCommand is list, expected Wheels: Wheels(a, b, c, d)",
    ),
    "a sum of wheels": (
        "return WheelTorqueCommand(request.drive + request.brake, request.brake)",
        "drive of its WheelTorqueCommand is tuple, expected Wheels",
    ),
    "a default that remembers": (
        first_wheel("remembered(fl)"),
        "this default is one for all calls, declare it as state",
    ),
    "arguments without a name": (
        first_wheel("named(fl, gain=2.0)"),
        "more stands for any number of arguments, name each",
    ),
}
# Those that are known only where the law ends, or of which the compiler names no line: named is its
# first line.
ENDS = (
    "no answer",
    "another answer",
    "another signal",
    "a signal without all fields",
    "a list for wheels",
    "a sum of wheels",
)
ELSEWHERE = {"a default that remembers": "def remembered", "arguments without a name": "def named"}


def line_of(name: str) -> int:
    """The line of the file that is named."""
    if name in ELSEWHERE:
        return HEAD[: HEAD.index(ELSEWHERE[name])].count("\n") + 1
    return LINES - 4 if name in ENDS else LINES + 1


def law_file(folder: Path, text: str) -> Path:
    file = folder / "my_law.py"
    file.write_text(f"{HEAD}    {text}\n")
    return file


@pytest.mark.sampled
@pytest.mark.slow
@pytest.mark.parametrize("name", MISTAKES)
def test_a_mistake_is_one_line(tmp_path: Path, name: str):
    text, message = MISTAKES[name]
    file = law_file(tmp_path, text)
    with pytest.raises(ParameterError) as refused:
        ev_stack.run("shchur2019", method={"asr": str(file)}, duration=0.1)
    begin = f"{file}, line {line_of(name)}: asr law mine: "
    assert str(refused.value).startswith(begin + message), refused.value
    assert "\n" not in str(refused.value)


@pytest.mark.sampled
@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            f"assert fl < 0.0, 'it drives'; {first_wheel('fl')}",
            f"line {LINES + 1}: asr law mine: AssertionError: it drives",
        ),
        (
            f"x = 1.0 if fl > 1e9 else None; {first_wheel('x')}",
            f"line {LINES - 4}: asr law mine: mine gives nothing",
        ),
        (
            f"if fl >= 0.0: raise ValueError(fl)\n    {first_wheel('fl')}",
            f"line {LINES + 1}: asr law mine: ValueError: 0.0",
        ),
        (
            f"x = fl / (fl - fl); {first_wheel('x')}",
            f"line {LINES + 1}: asr law mine: ZeroDivisionError: float division by zero; test the divisor first",
        ),
    ],
)
def test_what_a_compiled_law_raises_ends_the_run_with_its_line(
    tmp_path: Path, text: str, message: str
):
    """Plain Python takes the step again, and has the line.

    Of what divides by zero as well, which is NaN compiled.
    """
    file = law_file(tmp_path, text)
    with pytest.raises(LawError, match=re.escape(f"at 0 s: {file}, {message}")) as raised:
        ev_stack.run("shchur2019", method={"asr": str(file)}, duration=0.1)
    assert "\n" not in str(raised.value)


def test_the_command_line_shows_the_rest_on_demand(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    words = [
        "shchur2019",
        "--offline",
        "--method",
        f"asr={law_file(tmp_path, first_wheel('helper(fl)'))}",
    ]
    for more, rest in (([], False), (["--traceback"], True)):
        # A folder of results has to be new.
        out = ["--out", str(tmp_path / f"out{len(more)}")]
        with pytest.raises(SystemExit, match="helper is not marked @compilable"):
            run_scenario([*words, *out, *more])
        assert ("TypingError" in capsys.readouterr().err) == rest


DECLARATION = '''
from dataclasses import dataclass
from ev_core.law import FRONT_WHEELS_DRIVEN, WheelTorqueCommand, WheelTorqueRequest, compilable
from ev_core.law import entry, method, parameter

@dataclass(frozen=True, slots=True)
class P:
    share: float = parameter(0.5, unit="1", low=0.0, high=1.0, about="of the requested torques")

@dataclass(slots=True)
class S:
    x: float = entry(unit="1", about="a number")

@method("asr", "mine")
@compilable
def mine(p: P, s: S, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """A law."""
    return WheelTorqueCommand(request.drive, request.brake)
'''
# By mistake: the right text, the wrong one, and the message.
DECLARATIONS = {
    "a default out of range": (
        "0.5, unit",
        "1.5, unit",
        "the default of parameter share: 1.5 is refused, expected 0 to 1",
    ),
    "a plain number as parameter": (
        'parameter(0.5, unit="1", low=0.0, high=1.0, about="of the requested torques")',
        "0.5",
        "share is no declared parameter, write share: ... = parameter(...)",
    ),
    "parameters without dataclass": (
        "@dataclass(frozen=True, slots=True)\n",
        "",
        "parameters are class P, expected a",
    ),
    "one wish without a tuple": (
        '"mine"',
        '"mine", needs=FRONT_WHEELS_DRIVEN',
        "needs= is no tuple, write needs=(...,)",
    ),
    "an object as state": (
        "s: S",
        "s: S()",
        "state=S(x=0.0) is refused, expected a class marked @dataclass",
    ),
    "no start value": (
        ' = entry(unit="1", about="a number")',
        "",
        "S.x has no start value, declare it by entry(0.0, unit",
    ),
    "a text in the state": (
        'entry(unit="1", about="a number")',
        "'on'",
        "S.x begins as str, expected a number: entry(",
    ),
    "another word": ('"mine"', '"mine", sate=S', "unknown argument 'sate'; did you mean state"),
    "state without annotation": (
        "s: S",
        "s",
        "s has no annotation, expected the dataclass of its state",
    ),
    "parameters without annotation": (
        "p: P",
        "p",
        "p has no annotation, expected the dataclass of its parameters",
    ),
    "constants without prepare": (
        "(p: P, s",
        "(p: P, c, s",
        "c is asked for and not made, declare prepare=",
    ),
    "any number of signals": (
        "Request) ->",
        "Request, *more: WheelTorqueRequest) ->",
        "more stands for any number of",
    ),
    "a word of one's own": (
        "(p: P, s",
        "(params, s",
        "params is not known, expected p, car, c, s, period and signals",
    ),
    "signals first": (
        "p: P, s: S, request: WheelTorqueRequest",
        "request: WheelTorqueRequest, p: P, s: S",
        "request stands too early, p",
    ),
}


@pytest.mark.parametrize("name", DECLARATIONS)
def test_a_mistake_in_a_declaration_is_one_line(tmp_path: Path, name: str):
    """The line names the place of the law's declaration."""
    written, instead, message = DECLARATIONS[name]
    text = DECLARATION.replace(written, instead)
    assert text != DECLARATION
    file = tmp_path / "my_law.py"
    file.write_text(text)
    with pytest.raises(ParameterError) as refused:
        find_method("asr", str(file))
    first = text[: text.index("@method")].count("\n") + 1
    line, _, rest = (
        str(refused.value).removeprefix(f"asr method {file}: line ").partition(": TypeError: ")
    )
    assert int(line) in range(first, first + 3)
    assert rest.removeprefix("asr method ").removeprefix("mine: ").startswith(message), (
        refused.value
    )
    assert "\n" not in str(refused.value)


def test_what_prepare_gives_is_refused_in_one_line(tmp_path: Path):
    file = tmp_path / "my_law.py"
    file.write_text(
        DECLARATION.replace('"mine"', '"mine", prepare=lambda p, v, t: [1.0]').replace(
            "(p: P, s", "(p: P, c, s"
        )
    )
    with pytest.raises(
        ParameterError,
        match=r"my_law\.py, line 14: asr law mine: TypeError: prepare gives a list of float, exp",
    ):
        ev_stack.run("shchur2019", method={"asr": str(file)}, duration=0.1)
