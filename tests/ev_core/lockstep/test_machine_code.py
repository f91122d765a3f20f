"""Compiled code is loaded without the compiler, with the same bits, and not kept for ever."""

from __future__ import annotations

import inspect
import os
import subprocess
import sys
from itertools import chain

import pytest

from ev_core.compiled.part import CompiledPart
from ev_core.compiling import code_store
from ev_core.lockstep import parts
from ev_core.lockstep.configuration import configure
from ev_core.lockstep.parts import is_compiled, part_of
from ev_core.methods.register import all_methods
from ev_msgs_py.contract.frame import Frame
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands import compiling

# The longest law, and one that calls the compiler's own helpers (logarithms).
LAWS = (("asr", "fuzzy"), ("asr", "pi_slip"))


def stepped(role: str, method: str, compiled: bool) -> str:
    """Kind of the part, and its result of ten steps over a frame of odd numbers, to the bit."""
    part, here = part_of(configure(role, {"method": method}), compiled), Frame()
    for n in range(10):
        for place in range(len(here.numbers)):
            here.numbers[place] = 10.0 + 0.3 * place + 0.7 * n
        part.step(here, here)
    return " ".join([type(part).__name__, *(number.hex() for number in here.numbers)])


@pytest.mark.slow
def test_code_is_loaded_without_the_compiler_and_gives_the_bits_of_plain_python():
    """The node of a light law does without numba, which takes a second to load."""
    for role, method in LAWS:
        stepped(role, method, compiled=True)  # makes it if it is missing
    calls = "".join(f"print(stepped({role!r}, {method!r}, True))\n" for role, method in LAWS)
    imports = (
        "import sys",
        "from ev_msgs_py.contract.frame import Frame",
        "from ev_core.lockstep.configuration import configure",
        "from ev_core.lockstep.parts import is_compiled, part_of",
    )
    asks = "".join(
        f"print(is_compiled(configure({role!r}, {{'method': {method!r}}})))\n"
        for role, method in LAWS
    )
    text = "\n".join(
        (*imports, inspect.getsource(stepped), calls, asks, "print('numba' in sys.modules)")
    )
    done = subprocess.run(
        [sys.executable, "-c", text], capture_output=True, text=True, check=True, env={**os.environ}
    )
    lines = done.stdout.splitlines()
    for line, (role, method) in zip(lines, LAWS, strict=False):
        kind, *numbers = line.split()
        assert kind == CompiledPart.__name__
        assert numbers == stepped(role, method, compiled=False).split()[1:]
    assert lines[len(LAWS) :] == ["True", "True", "False"]


def test_only_the_newest_texts_of_a_name_are_kept(tmp_path, monkeypatch):
    """All code of a text goes together; other names stay, also one that begins alike."""
    monkeypatch.setattr(code_store, "cache_folder", lambda: tmp_path)
    for n in range(10):
        for name in ("off", "off_asr"):
            for file in (f"{name}_{n:012x}.1234.code", f"{name}_{n:012x}.1234.5678.numba"):
                (tmp_path / file).touch()
                os.utime(tmp_path / file, (n, n))
    code_store.forget_older(f"off_{9:012x}")
    kept = sorted(
        file.name for file in tmp_path.glob("off_*") if not file.name.startswith("off_asr")
    )
    assert {name.split(".")[0] for name in kept} == {f"off_{n:012x}" for n in range(2, 10)}
    assert len(kept) == 8 * 2
    assert len(list(tmp_path.glob("off_asr_*"))) == 10 * 2


def test_all_methods_can_be_compiled_beforehand():
    """The command compiles each with its vehicle and period.

    The rest would fall to the first run.
    """
    laws = [
        method for of_role in all_methods().values() for method in of_role.values() if method.law
    ]
    assert {id(method) for method in chain.from_iterable(compiling.sharing(laws))} == {
        *map(id, laws)
    }
    assert all(compiling._by_default(method) is not None for method in laws)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("asr=nix", "unknown asr method 'nix'"),
        ("engine=off", "unknown node 'engine'; known: asr"),
        ("nowhere", "unknown scenario 'nowhere'"),
    ],
)
def test_what_cannot_be_compiled_is_one_line(name, message, capsys):
    with pytest.raises(SystemExit, match=f"^error: {message}"):
        compiling.main([name])
    assert capsys.readouterr().err == ""


def test_a_node_compiles_what_it_plays_but_not_while_real_time_waits(monkeypatch):
    """A law switched to in a run is stepped in plain Python, or refused if too heavy."""
    made = []
    monkeypatch.setattr(parts, "is_kept", lambda _: False)
    monkeypatch.setattr(
        parts, "method_part", lambda configuration, compiled: made.append(configuration.method.name)
    )
    law, plant = configure("asr", {"method": "off"}), configure("plant", {"method": "kinematic"})
    assert is_compiled(law) and is_compiled(plant)
    assert made == ["off", "kinematic"]
    assert not is_compiled(law, may_wait=False)
    with pytest.raises(
        ParameterError,
        match=r"^plant=kinematic is not compiled.*: ev-stack compile plant=kinematic$",
    ):
        is_compiled(plant, may_wait=False)
    assert made == ["off", "kinematic"]
