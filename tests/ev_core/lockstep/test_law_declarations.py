"""Declarations of a law: writes, parameters, state, notes.

A wrong one is refused in its own line.
"""

from __future__ import annotations

import pytest
from lockstep.law_texts import FUNCTIONS, HEAD

import ev_stack
from ev_core.check.method import ContractError, check_method
from ev_core.law import WheelTorqueCommand, WheelTorqueRequest
from ev_core.lockstep.configuration import configure
from ev_core.lockstep.finding import find_method
from ev_core.lockstep.parts import hand_over, part_of
from ev_msgs_py.contract.frame import PLACES, Frame
from ev_msgs_py.refusal import ParameterError

DECLARATIONS = {
    "writes=(WheelTorqueCommand, BodyVelocity)": "a asr does not write BodyVelocity, expected WheelTorqueCommand",
    "writes=[WheelTorqueCommand]": "is refused, expected a tuple of WheelTorqueCommand",
    "writes=()": r"writes=\(\) is refused, expected a tuple of WheelTorqueCommand",
    "requires='planar'": "requires=planar is refused, expected a mapping by role",
    "in_real_time=('plant',)": "in_real_time=.* is refused, expected a mapping by role",
    "start=lambda s: s": "asks for s, expected are only p, car, c, period",
    "notes=lambda s, request: ()": "asks for request, expected are only p, car, c, s, period",
}


@pytest.mark.parametrize("declared", DECLARATIONS)
def test_a_law_declares_what_its_role_may_do(declared, tmp_path):
    """Signals of other roles are refused: they would overwrite the plant's, or be a stranger's."""
    file = tmp_path / "my_law.py"
    begin = FUNCTIONS.index('"mine"') + len('"mine"')
    end = FUNCTIONS.index(")\ndef mine")
    file.write_text(HEAD + FUNCTIONS[:begin] + ", " + declared + FUNCTIONS[end:])
    with pytest.raises(ParameterError, match=DECLARATIONS[declared]) as refused:
        find_method("asr", str(file))
    assert "\n" not in str(refused.value) and "line " in str(refused.value)


PARAMETERS = {
    "seed: float = parameter(1.0, unit='1', about='of noise')": "noise.seed is no whole number, expected int",
    "gain: float | None = parameter(1.0, unit='1', about='g')": r"noise.gain is declared as float \| None, exp",
    "gain: object = parameter(1.0, unit='1', about='g')": "noise.gain is declared as object, expected float",
}


@pytest.mark.parametrize("declared", PARAMETERS)
def test_a_parameter_has_a_type_that_a_file_can_give(declared, tmp_path):
    file = tmp_path / "my_law.py"
    group = f"@dataclass(frozen=True, slots=True)\nclass Noise:\n    {declared}\n\n\n@dataclass(frozen=True, slots=True)"
    text = (HEAD + FUNCTIONS).replace("@dataclass(frozen=True, slots=True)", group, 1)
    file.write_text(text.replace("class P:\n", "class P:\n    noise: Noise = group(Noise)\n"))
    with pytest.raises(ParameterError, match=PARAMETERS[declared]):
        find_method("asr", str(file))


def test_a_parameter_of_ros_is_no_name_for_ones_own(tmp_path):
    """A node would take it for that of ROS, and the law would never get it."""
    file = tmp_path / "my_law.py"
    file.write_text((HEAD + FUNCTIONS).replace("    window:", "    use_sim_time:"))
    with pytest.raises(
        ParameterError, match="parameter use_sim_time is refused: every node has one of this name"
    ):
        find_method("asr", str(file))


def test_a_file_that_ends_the_program_is_refused(tmp_path):
    file = tmp_path / "my_law.py"
    file.write_text("import sys\nsys.exit(0)\n")
    with pytest.raises(ParameterError, match="line 2: SystemExit: 0"):
        find_method("asr", str(file))


STATELESS = (
    HEAD
    + """
def notes(p):
    return (f"window {p.window:g}",)


@method("asr", "mine", notes=notes)
@compilable
def mine(p: P, request: WheelTorqueRequest) -> WheelTorqueCommand:
    return WheelTorqueCommand(request.drive, request.brake)
"""
)


def test_a_law_without_state_notes_and_changes_its_form(tmp_path):
    """Its compiled form has memory of one number, which is no state."""
    file = tmp_path / "my_law.py"
    file.write_text(STATELESS)
    check_method("asr", str(file))
    configuration = configure("asr", {"method": str(file)})
    forms = [part_of(configuration, compiled) for compiled in (False, True)]
    assert [part.notes() for part in forms] == [("window 2",)] * 2
    hand_over(forms[0], forms[1])
    hand_over(forms[1], forms[0])
    assert [len(part.state) for part in forms] == [0, 0]
    assert len(ev_stack.run("shchur2019", method={"asr": str(file)}, duration=0.1).signals)


WINDOW = (
    HEAD
    + """
@dataclass(slots=True)
class Window:
    samples: list[float] = series(2, unit="N m")


def start(p):
    return Window([0.0] * int(p.window))


@method("asr", "mine", start=start)
@compilable
def mine(p: P, s: Window, request: WheelTorqueRequest) -> WheelTorqueCommand:
    s.samples[0] = request.drive.front_left
    return WheelTorqueCommand(request.drive, request.brake)
"""
)


@pytest.mark.sampled
@pytest.mark.parametrize("compiled", [False, True])
@pytest.mark.parametrize(("before", "after"), [(1.0, 4.0), (2.0, 4.0), (4.0, 1.0)])
def test_a_live_change_of_the_length_of_the_state_is_refused(compiled, before, after, tmp_path):
    """One number is not spread over all of a longer state."""
    file = tmp_path / "my_law.py"
    file.write_text(WINDOW)
    configuration = configure("asr", {"method": str(file), "window": before})
    parts = [
        part_of(each, compiled)
        for each in (configuration, configuration.changed({"window": after}))
    ]
    message = f"^window: a state of {before:g} numbers would have {after:g}, expected as many; .* declared read_only"
    with pytest.raises(ParameterError, match=message):
        hand_over(parts[0], parts[1], ["window"])
    assert not any(parts[1].state)


def test_the_check_finds_a_live_parameter_that_sets_the_length_of_the_state(tmp_path):
    file = tmp_path / "my_law.py"
    file.write_text(WINDOW)
    with pytest.raises(
        ContractError,
        match=r"window = 2\.0 has 2 numbers, 1\.0 has 1: what sets its length is to be",
    ):
        check_method("asr", str(file))
    file.write_text(WINDOW.replace('about="samples"', 'about="samples", read_only=True'))
    check_method("asr", str(file))


def test_a_long_name_of_a_file_is_compiled(tmp_path):
    """225 characters would make a name in the cache longer than a file system takes."""
    file = tmp_path / f"{'l' * 225}.py"
    file.write_text(STATELESS)
    frame = Frame()
    frame.numbers[PLACES[WheelTorqueRequest].start] = 5.0
    part_of(configure("asr", {"method": str(file)}), compiled=True).step(frame, frame)
    assert frame.numbers[PLACES[WheelTorqueCommand].start] == 5.0


SWITCHES = {
    "many: bool = parameter(False, about='of it')": "which may change in a run, declare it read_only=True",
    "many: float = parameter(1.0, unit='1', about='of it')": "options= asks for many, expected a switch of P",
    "few: bool = parameter(False, about='of it')": "options= asks for many, expected a switch of P",
}


@pytest.mark.parametrize("declared", SWITCHES)
def test_an_option_goes_by_a_switch_that_is_fixed_when_a_node_starts(declared, tmp_path):
    """An option may read another signal, to which a node that runs has not subscribed.

    The law would read zeros from the change on.
    """
    file = tmp_path / "my_law.py"
    text = (HEAD + FUNCTIONS).replace("class P:\n", f"class P:\n    {declared}\n")
    file.write_text(text.replace('"mine"', '"mine", options={("many",): {}}'))
    with pytest.raises(ParameterError, match=SWITCHES[declared]):
        find_method("asr", str(file))
    fixed = file.read_text().replace(
        declared, "many: bool = parameter(False, about='', read_only=True)"
    )
    file.write_text(fixed)
    assert find_method("asr", str(file)).switches == ("many",)
