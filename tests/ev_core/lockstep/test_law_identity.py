"""A name is taken by one law, and a configuration keeps its law whatever its file becomes."""

from __future__ import annotations

import copy
import pickle
import sys
from pathlib import Path
from types import ModuleType

import pytest

from ev_core.lockstep.configuration import configure
from ev_core.lockstep.finding import find_method
from ev_core.methods import register
from ev_core.methods.register import all_methods, load_installed_methods, methods_of
from ev_msgs_py.refusal import ParameterError
from ev_nodes.master.real_time import MasterParameters

HEAD = """
from dataclasses import dataclass
from ev_core.law import BodyVelocity, NO_WHEELS, WheelTorqueCommand, WheelTorqueRequest, compilable, method, parameter
from ev_core.law import entry

@dataclass(frozen=True, slots=True)
class P:
    gain: float = parameter(1.0, unit="1", low=0.0, high=10.0, about="of nothing")
"""
LAW = '''
@method("asr", "{name}")
@compilable
def {function}(p: P, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """A law."""
    return WheelTorqueCommand(NO_WHEELS, request.brake)
'''
PLANT = '''
@dataclass(slots=True)
class S:
    speed: float = entry(unit="m/s")

def shown(s):
    return BodyVelocity(s.speed, 0.0, 0.0)

@method("plant", "cart", outputs=shown, writes=(BodyVelocity,))
@compilable
def cart(p: P, s: S, period, command: WheelTorqueCommand) -> None:
    """A plant."""
    s.speed += period * 1.0 * command.drive.front_left
'''


@pytest.fixture
def registered(monkeypatch: pytest.MonkeyPatch):
    """A register of its own with what it has by now, and with all that is installed."""
    all_methods()
    kept = {role: dict(methods) for role, methods in register._REGISTER.items()}
    monkeypatch.setattr(register, "_REGISTER", kept)
    return kept


def run(text: str, name: str = "somebodys_laws") -> None:
    """Execute a text as a module or a cell of a notebook."""
    module = ModuleType(name)
    sys.modules[name] = module
    try:
        exec(HEAD + text, vars(module))
    finally:
        del sys.modules[name]


@pytest.mark.parametrize("is_loaded", [False, True])
def test_the_name_of_a_law_of_ours_is_taken(
    registered, is_loaded: bool, monkeypatch: pytest.MonkeyPatch
):
    """Our law keeps its name, imported by then or not."""
    ours = methods_of("asr")["pi_slip"]
    if not is_loaded:
        del registered["asr"]
        monkeypatch.setattr(
            register,
            "load_installed_methods",
            lambda role: registered.setdefault(role, {"pi_slip": ours}),
        )
    with pytest.raises(
        TypeError,
        match=r"^asr method pi_slip is there already, ev_control\S+: take another name for som",
    ):
        run(LAW.format(name="pi_slip", function="pi_slip"))
    assert registered["asr"]["pi_slip"] is ours


def test_the_name_of_another_module_is_taken_and_a_cell_may_be_run_again(registered):
    """The same function of the same module is the same law, edited."""
    text = LAW.format(name="somebodys", function="mine")
    run(text)
    run(text)
    with pytest.raises(
        TypeError,
        match=r"asr method somebodys is there already, somebodys_laws\.mine: take another name",
    ):
        run(text, "others_laws")
    with pytest.raises(TypeError, match=r"take another name for somebodys_laws\.other"):
        run(LAW.format(name="somebodys", function="other"))


def test_a_module_that_runs_as_a_program_has_its_laws(registered, monkeypatch: pytest.MonkeyPatch):
    """Under python -m a module of a package is there twice.

    As a program, and as what the package offers.
    """
    for name in ("package.laws", "as_a_program"):
        module = ModuleType(name)
        module.__file__ = "laws.py"
        monkeypatch.setitem(sys.modules, name, module)
        exec(HEAD + LAW.format(name="somebodys", function="mine"), vars(module))
    assert registered["asr"]["somebodys"].place == ("as_a_program", "mine")


def test_two_laws_of_one_name_in_a_file_are_one_line(tmp_path: Path):
    """A file may give a law the name of one of ours: it is chosen by its path."""
    file = tmp_path / "laws.py"
    file.write_text(HEAD + LAW.format(name="pi_slip", function="one"))
    assert find_method("asr", str(file)).place[1] == "one"
    file.write_text(file.read_text() + LAW.format(name="pi_slip", function="two"))
    with pytest.raises(
        ParameterError,
        match=r"laws\.py: line \d+: TypeError: asr method pi_slip is there already, .*one",
    ):
        find_method("asr", str(file))
    assert load_installed_methods("asr") == ()


def test_all_methods_have_places_of_their_own():
    """One of them cannot be taken for another one, edited."""
    for methods in all_methods().values():
        assert len({each.place for each in methods.values()}) == len(methods)


def test_a_configuration_keeps_its_law(tmp_path: Path):
    """A pace, a parameter and a deep copy keep it, with the file edited, spoiled and gone.

    A pickle is refused then.
    """
    file = tmp_path / "cart.py"
    file.write_text(HEAD + PLANT)
    one = configure("plant", {"method": str(file)}, MasterParameters)
    saved = pickle.dumps(one)
    assert pickle.loads(saved).method.law == one.method.law
    for text in (HEAD + PLANT.replace("1.0 * command", "-5.0 * command"), "no Python at all", None):
        file.write_text(text) if text is not None else file.unlink()
        for changes in (
            {"real_time_factor": 2.0},
            {"gain": 2.0},
            {"real_time_factor": 3.0, "gain": 3.0},
        ):
            assert one.changed(changes).method.law is one.method.law
        assert one.changed({"real_time_factor": 2.0}).extra.real_time_factor == 2.0
        assert copy.deepcopy(one).method.law is one.method.law
        with pytest.raises(ParameterError, match=rf"plant method {file}"):
            pickle.loads(saved)
