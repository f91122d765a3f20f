"""What the compiler has made once: loaded without it, with the same bits, and not kept for ever."""

from __future__ import annotations

import inspect
import os
import subprocess
import sys
from types import SimpleNamespace

import pytest

from ev_core.compiled.part import CompiledPart
from ev_core.compiling import machine_code
from ev_core.lockstep.configuration import configure
from ev_core.lockstep.parts import part_of
from ev_core.methods.law import Given
from ev_core.methods.register import all_methods
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.frame import Frame
from ev_sim.commands import compile_all

# The longest law, and one that calls the compiler's own helpers (logarithms).
LAWS = (("asr", "fuzzy"), ("asr", "pi_slip"))


def stepped(role: str, method: str, compiled: bool) -> str:
    """The kind of the part, and what it makes of ten steps over a frame of odd numbers, to the bit."""
    part, here = part_of(configure(role, {"method": method}), compiled), Frame()
    for n in range(10):
        for place in range(len(here.numbers)):
            here.numbers[place] = 10.0 + 0.3 * place + 0.7 * n
        part.step(here, here)
    return " ".join([type(part).__name__, *(number.hex() for number in here.numbers)])


@pytest.mark.slow
def test_code_is_loaded_without_the_compiler_and_gives_the_bits_of_plain_python():
    """As a node of a light law does, which would start a second later if it loaded numba."""
    for role, method in LAWS:
        stepped(role, method, compiled=True)  # makes it, if nobody has
    calls = "".join(f"print(stepped({role!r}, {method!r}, True))\n" for role, method in LAWS)
    imports = (
        "import sys",
        "from ev_msgs_py.contract.frame import Frame",
        "from ev_core.lockstep.configuration import configure",
        "from ev_core.lockstep.parts import is_compiled, part_of",
    )
    asks = "".join(f"print(is_compiled(configure({role!r}, {{'method': {method!r}}})))\n" for role, method in LAWS)
    text = "\n".join((*imports, inspect.getsource(stepped), calls, asks, "print('numba' in sys.modules)"))
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True, env={**os.environ})
    said = done.stdout.splitlines()
    for line, (role, method) in zip(said, LAWS, strict=False):
        kind, *numbers = line.split()
        assert kind == CompiledPart.__name__
        assert numbers == stepped(role, method, compiled=False).split()[1:]
    assert said[len(LAWS) :] == ["True", "True", "False"]


def test_only_the_newest_texts_of_a_name_are_kept(tmp_path, monkeypatch):
    """With all that was compiled of a text; other names, one of which begins alike, are left alone."""
    monkeypatch.setattr(machine_code, "cache_folder", lambda: tmp_path)
    for n in range(10):
        for name in ("off", "off_asr"):
            for file in (f"{name}_{n:012x}.1234.code", f"{name}_{n:012x}.1234.5678.numba"):
                (tmp_path / file).touch()
                os.utime(tmp_path / file, (n, n))
    machine_code.forget_older(f"off_{9:012x}")
    kept = sorted(file.name for file in tmp_path.glob("off_*") if not file.name.startswith("off_asr"))
    assert {name.split(".")[0] for name in kept} == {f"off_{n:012x}" for n in range(2, 10)}
    assert len(kept) == 8 * 2
    assert len(list(tmp_path.glob("off_asr_*"))) == 10 * 2


def test_the_set_up_goes_on_when_a_law_cannot_be_compiled(monkeypatch):
    """It says so in one line, with role and name."""
    assert compile_all._compile(("asr", "off")) == ""
    broken = SimpleNamespace(parameters=lambda: 1 / 0)
    monkeypatch.setattr(compile_all, "find_method", lambda role, name: broken)
    assert compile_all._compile(("asr", "broken")) == "asr broken: ZeroDivisionError: division by zero"


def test_the_set_up_can_prepare_every_law():
    """With the vehicle and the period that it takes; what it leaves out would be compiled by the first run."""
    laws = [method for of_role in all_methods().values() for method in of_role.values() if method.law]
    assert {job for jobs in compile_all._sharing(laws) for job in jobs} == {(law.role, law.name) for law in laws}
    for method in laws:
        Given(method.law, method.parameters(), Vehicle(), compile_all._PERIOD)
