"""An exported law on this and other processors: the bits of the law here, and what its interface refuses."""

from __future__ import annotations

import math
import shutil
from pathlib import Path

import numpy as np
import pytest

from ev_msgs_py.contract import stamps
from ev_msgs_py.refusal import ParameterError
from ev_sim.export import program as exported
from ev_sim.export.content import Content
from ev_sim.export.program import Program, build_program
from ev_sim.export.targets import TARGETS
from ev_sim.interface.driving import only_run, overrides
from ev_sim.interface.simulation import SteppedLaw

ROLE = "driver"  # with a state, and quick to compile
STEPS = 60
# One of each that a seed, an instant of restart or a state can go wrong in.
FAULTS = ["noisy driver.command.drive_torque 5.0", "restarted driver.command from 0.2 until 0.3"]

PARAMETER, VALUE = f"{ROLE}.speed_control.proportional_gain", 10.0


def missing(target: str) -> str:
    """What this machine lacks to run programs of a target; empty if nothing."""
    words = (TARGETS[target].compiler, *TARGETS[target].emulator[:1])
    return next((word for word in words if not shutil.which(word)), "")


def law(**changed):
    changed["set"] = {f"{ROLE}.faults": FAULTS, **changed.get("set", {})}
    return only_run("shchur2019", "", overrides(**changed))


@pytest.fixture(scope="module")
def content():
    return Content(law(), only=[ROLE])


@pytest.fixture(scope="module")
def command(content, tmp_path_factory):
    return build_program(content, TARGETS["x86_64-linux"], tmp_path_factory.mktemp("law"))


@pytest.fixture
def program(content, command):
    with Program(content, command) as running:
        assert running.create()[0] == 0
        yield running


def given(content, n: int) -> list[float]:
    """Inputs of the n-th step: a car that is hardly moving, so that the driver pulls away."""
    return [0.1 * math.sin(0.1 * n + i) for i in range(len(content.inputs))]


def answers_here(content, run, steps=STEPS) -> np.ndarray:
    """What the compiled law answers here to the same inputs."""
    stepped = SteppedLaw(run.configurations[ROLE])
    names = [channel.name for channel in content.inputs]
    rows = []
    for n in range(steps):
        answer = stepped.answer(stamps.to_seconds(n * content.period), dict(zip(names, given(content, n), strict=True)))
        rows.append([answer[channel.name] for channel in content.outputs])
    return np.array(rows)


def answers_of(content, program: Program, steps=STEPS, begin=0) -> np.ndarray:
    found = [program.step(given(content, n)) for n in range(begin, begin + steps)]
    assert not any(status for status, _ in found)
    return np.array([outputs for _, outputs in found])


def same_bits(one: np.ndarray, other: np.ndarray) -> bool:
    return one.tobytes() == other.tobytes()


@pytest.mark.parametrize("target", ["x86_64-linux", "aarch64-linux", "arm-linux"])
def test_a_law_answers_with_the_same_bits(target, content, tmp_path):
    if lacking := missing(target):
        pytest.skip(f"{lacking} is not installed")
    with Program(content, build_program(content, TARGETS[target], tmp_path)) as program:
        program.create()
        assert same_bits(answers_of(content, program), answers_here(content, law()))


def test_another_seed_is_that_of_the_stack(content, program):
    one = answers_of(content, program)
    assert program.reset(7)[0] == 0
    other = answers_of(content, program)
    assert not same_bits(one, other)  # else the seed would go nowhere
    assert same_bits(other, answers_here(content, law(seed=7)))


def test_a_parameter_that_is_set_is_that_of_the_stack(content, program):
    names = [tunable.name for part in content.parts for tunable in part.tunables]
    before = answers_of(content, program)
    program.create()
    assert program.set_parameter(names.index(PARAMETER), VALUE) == 0
    after = answers_of(content, program)
    assert not same_bits(before, after)
    assert same_bits(after, answers_here(content, law(set={PARAMETER: VALUE})))


def test_a_state_goes_on_to_the_bit(content, command, program):
    answers_of(content, program, 25)
    with Program(content, command) as other:
        assert other.restore(program.state)[0] == 0
        assert same_bits(answers_of(content, other, begin=25), answers_of(content, program, begin=25))


def test_what_is_refused_changes_nothing(content, program):
    before, tunables = program.state, [tunable for part in content.parts for tunable in part.tunables]
    index, high = next((n, tunable.high) for n, tunable in enumerate(tunables) if math.isfinite(tunable.high))
    assert program.step([*given(content, 0)[:-1], math.nan])[0] == -2
    assert program.set_parameter(0, math.inf) == -2
    assert program.set_parameter(10_000, 1.0) == -1
    assert program.set_parameter(index, high * 1.01) == -3
    assert program.restore(b"\1" * len(before))[0] == -5
    assert program.state == before


def test_a_program_that_is_refused_is_ended(content, tmp_path, monkeypatch):
    monkeypatch.setattr(exported, "PATIENCE", 0.2)
    with pytest.raises(ParameterError, match=r"no answer within 0\.2 s"):
        Program(content, ["sh", "-c", f"echo $$ > {tmp_path}/id; exec sleep 1000"])
    assert not Path(f"/proc/{int((tmp_path / 'id').read_text())}").exists()


def test_a_request_that_is_not_read_has_a_limit(content, command, monkeypatch):
    """It is longer than a pipe is, and the program reads no further than its identity."""
    with Program(content, ["sh", "-c", f"head -c 1 | {command[0]}; exec sleep 1000"]) as deaf:
        monkeypatch.setattr(exported, "PATIENCE", 0.2)
        with pytest.raises(ParameterError, match=r"no answer within 0\.2 s"):
            deaf.drive(1 << 20)


def test_a_program_that_does_not_end_with_its_input_is_ended(content, command):
    silent = ["sh", "-c", f"head -c 1 | {command[0]}; exec sleep 30"]  # its identity, and nothing more
    running = Program(content, silent)
    running.close()
    assert running._process.returncode == -9
