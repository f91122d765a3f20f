"""Mistakes of a law's author.

Each is one line with the law, its file and its line, plain and compiled.
"""

from __future__ import annotations

import pickle
import tempfile
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lockstep.law_texts import CLASS, COMPILED, FORMS, FUNCTIONS, HEAD, HOOKS, driven

import ev_stack
from ev_core.check.method import ContractError, check_method
from ev_core.methods.law_error import LawError

FAULTS = (
    "1.0 / 0.0",
    "{}['gain']",
    "[][3]",
    "None.gain",
    "math.exp(1e9)",
    "float('1,5')",
    "no_such_name",
    "open('/nowhere/map.csv')",
    "assert False",
    "raise RuntimeError('of two\\nlines')",
    "raise StopIteration",
    "raise SystemExit(0)",
    "raise KeyError",
)


@settings(deadline=None, max_examples=60)
@given(hook=st.sampled_from(HOOKS), fault=st.sampled_from(FAULTS))
def test_whatever_an_author_raises_is_one_line(hook, fault):
    """It names the law, and the very line of the file; what was raised is the cause."""
    form, name = hook
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "my_law.py"
        file.write_text(HEAD + FORMS[form].replace(f"pass  # {name}\n", f"{fault}  # {name}\n"))
        line = next(
            n
            for n, text in enumerate(file.read_text().splitlines(), 1)
            if text.endswith(f"# {name}")
        )
        with pytest.raises(LawError) as refused:
            driven(file, form == "compiled")
    text, cause = str(refused.value), refused.value.__cause__
    what = (
        "[][3] is out of range: index 3" if isinstance(cause, IndexError) else type(cause).__name__
    )
    assert f"{file}, line {line}: asr law mine: {what}" in text
    assert text.isprintable()
    assert "site-packages" not in text


@pytest.mark.parametrize("form", FORMS)
def test_a_law_without_a_mistake_is_driven(form, tmp_path):
    """The law of the property above drives without its mistakes."""
    file = tmp_path / "my_law.py"
    file.write_text(HEAD + FORMS[form])
    driven(file, form == "compiled")


ANSWERS = {
    "pass": "gives nothing, expected WheelTorqueCommand",
    "return WheelTorqueRequest(request.drive, request.brake)": "gives WheelTorqueRequest, expected WheelTorqueCommand",
    "return (request.drive, request.brake)": "gives a tuple of Wheels, Wheels, expected WheelTorqueCommand",
    "return WheelTorqueCommand(request.drive[:3], (0.0,) * 5)": "gives a tuple of float, float, float, expected Wheels",
    "return WheelTorqueCommand(list(request.drive), request.brake)": "gives a list of float, float, float, float, exp",
    "return WheelTorqueCommand(1.0, request.brake)": r"gives float, expected Wheels\(a, b, c, d\) as drive",
    "return WheelTorqueCommand(Wheels(1j, 0.0, 0.0, 0.0), request.brake)": "gives complex, expected a number as drive",
    "return WheelTorqueCommand(Wheels('1', 0.0, 0.0, 0.0), request.brake)": "gives str, expected a number as drive",
}


@pytest.mark.sampled
@pytest.mark.parametrize("answer", ANSWERS)
def test_an_answer_in_another_shape_than_the_signal_is_refused(answer, tmp_path):
    """Three drive and five brake torques are eight numbers too, for the wrong wheels."""
    file = tmp_path / "my_law.py"
    right = "return WheelTorqueCommand(request.drive, request.brake)"
    file.write_text(HEAD + FUNCTIONS.replace(right, answer))
    message = rf"^at 0 s: {file}, line \d+: asr law mine: mine {ANSWERS[answer]}"
    with pytest.raises(LawError, match=message):
        driven(file, compiled=False)
    with pytest.raises(ContractError, match=f"asr law mine: mine {ANSWERS[answer]}"):
        check_method("asr", str(file))


def test_wheels_may_be_a_plain_tuple_of_four_in_plain_python(tmp_path):
    file = tmp_path / "my_law.py"
    file.write_text(
        HEAD + FUNCTIONS.replace("Command(request.drive,", "Command(tuple(request.drive),")
    )
    driven(file, compiled=False)


RESULTS = {
    "return S()": ("start", "return {'now': 1.0}", r"start gives dict, expected S\(\.\.\.\)"),
    'return ""': ("need", "return True", "a need gives bool, expected a text"),
    "return parameters\n": (
        "load_files",
        "pass\n",
        "load_files gives nothing, expected P: return the parameters",
    ),
    'return (f"{s.now[0]:g} N m",)': (
        "notes",
        "return 'lost'",
        "notes gives str, expected a tuple of texts",
    ),
    "pass  # prepare": (
        "prepare",
        "return ((2.0, (3.0,)),)",
        "prepare gives a tuple of tuple, expected",
    ),
}


@pytest.mark.sampled
@pytest.mark.parametrize("right", RESULTS)
def test_a_hook_that_gives_something_else_is_refused(right, tmp_path):
    hook, wrong, message = RESULTS[right]
    file = tmp_path / "my_law.py"
    file.write_text(HEAD + COMPILED.replace(right, wrong))
    with pytest.raises(LawError, match=rf"^{file}, line \d+: asr law mine: .*{message}") as refused:
        driven(file, compiled=True)
    if hook != "need":  # its line is that of the law
        begin = next(
            n
            for n, text in enumerate(file.read_text().splitlines(), 1)
            if text.startswith(f"def {hook}(")
        )
        assert f"line {begin}:" in str(refused.value)


SHARED = {
    "s.before = s.now": r"by s\.before\[:\] = s\.now",
    "s.before, s.now[0] = s.now, 1.0": r"by s\.before\[:\] = s\.now",
    "s.before[:] = s.now": "",
    "s.before = s.now[:]": r"by s\.before\[:\] = s\.now\[:\]",
    "s.before = a = s.now": r"by s\.before\[:\] = s\.now",
    "s.before = request.drive": r"by s\.before\[:\] = request\.drive",
}


@pytest.mark.sampled
@pytest.mark.parametrize("assigned", SHARED)
def test_lists_of_the_state_are_copied_not_shared(assigned, tmp_path):
    """Compiled the numbers are copied.

    In plain Python both names would be one list from then on.
    """
    file = tmp_path / "my_law.py"
    text = HEAD + COMPILED.replace(
        "    return WheelTorqueCommand(request.",
        f"    {assigned}\n    return WheelTorqueCommand(request.",
    )
    file.write_text(text)
    if not SHARED[assigned]:
        driven(file, compiled=True)
        return
    line = next(n for n, each in enumerate(text.splitlines(), 1) if each.strip() == assigned)
    with pytest.raises(
        LawError, match=f"line {line}: asr law mine: s.before.*.* one list, .* {SHARED[assigned]}"
    ):
        driven(file, compiled=True)


ONCE = ("[1.0][(n := n + 1)]", "[1.0][todo.pop()]", "[1.0][taken(todo)]")


@pytest.mark.parametrize("index", ONCE)
def test_an_index_that_another_look_would_change_is_not_looked_at(index, tmp_path):
    """The line has its text alone: another look would show a wrong number, or fail itself."""
    file = tmp_path / "my_law.py"
    step = f"n, todo = 1, [7]\n    x = {index}"
    file.write_text(HEAD + "taken = list.pop\n" + FUNCTIONS.replace("pass  # step", step))
    with pytest.raises(LawError, match=r"asr law mine: \[1\.0\]\[.*\] is out of range$"):
        driven(file, compiled=False)


RESTARTED = {"asr.faults": ["restarted torque_command from 0.1 until 0.2"]}


def test_a_restart_of_a_class_without_a_setter_is_one_line(tmp_path):
    file = tmp_path / "my_law.py"
    begin, end = CLASS.index("    @state.setter"), CLASS.index("    def step")
    file.write_text(HEAD + CLASS[:begin] + CLASS[end:])
    with pytest.raises(LawError, match=r"asr law mine: AttributeError: .*no setter"):
        ev_stack.run("shchur2019", method={"asr": str(file)}, duration=0.3, set=RESTARTED)


def test_an_error_of_a_law_goes_to_other_processes(tmp_path):
    """The error survives pickling, as the workers of a study send it."""
    file = tmp_path / "my_law.py"
    file.write_text(HEAD + FUNCTIONS.replace("pass  # step", "1.0 / 0.0"))
    with pytest.raises(LawError) as refused:
        ev_stack.run("shchur2019", method={"asr": str(file)}, duration=0.1)
    assert str(pickle.loads(pickle.dumps(refused.value))) == str(refused.value)
    assert isinstance(refused.value.__cause__, ZeroDivisionError)
