"""An exported law on this and other processors.

The bits of the law here, its cost, and what its interface refuses.
"""

from __future__ import annotations

import errno
import math
import shutil
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest
from helpers.patience import wait_until

from ev_doors.export import program as exported
from ev_doors.export.content import Content
from ev_doors.export.counting import counted
from ev_doors.export.library import Library
from ev_doors.export.program import Program, build_program
from ev_doors.export.targets import TARGETS
from ev_msgs_py.contract import stamps
from ev_msgs_py.refusal import ParameterError
from ev_stack.interface.driving import only_run, overrides
from ev_stack.interface.simulation import SteppedLaw

ROLE = "driver"  # with a state, and quick to compile
STEPS = 60
# One of each that a seed, an instant of restart or a state can go wrong in.
FAULTS = ["noisy driver.command.drive_torque 5.0", "restarted driver.command from 0.2 until 0.3"]

PARAMETER, VALUE = f"{ROLE}.speed_control.proportional_gain", 10.0


def missing(target: str) -> str:
    """Return a program that this machine lacks to run those of a target; empty if none."""
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
    """Answers of the compiled law here to the same inputs."""
    stepped = SteppedLaw(run.configurations[ROLE])
    names = [channel.name for channel in content.inputs]
    rows = []
    for n in range(steps):
        answer = stepped.answer(
            stamps.to_seconds(n * content.period), dict(zip(names, given(content, n), strict=True))
        )
        rows.append([answer[channel.name] for channel in content.outputs])
    return np.array(rows)


def answers_of(content, program: Program, steps=STEPS, begin=0) -> np.ndarray:
    found = [program.step(given(content, n)) for n in range(begin, begin + steps)]
    assert not any(status for status, _ in found)
    return np.array([outputs for _, outputs in found])


def same_bits(one: np.ndarray, other: np.ndarray) -> bool:
    return one.tobytes() == other.tobytes()


@pytest.mark.parametrize("target", ["x86_64-linux", "aarch64-linux", "arm-linux", "thumbv7em"])
def test_a_law_answers_with_the_same_bits(target, content, tmp_path):
    if lacking := missing(target):
        pytest.skip(f"{lacking} is not installed")
    with Program(content, build_program(content, TARGETS[target], tmp_path)) as program:
        program.create()
        assert same_bits(answers_of(content, program), answers_here(content, law()))


def test_a_law_on_a_cortex_m7_has_the_bits_and_the_instructions_of_that_on_an_m4(content, tmp_path):
    """Both run the same code without a system, so it takes as many instructions; twice in a row."""
    if lacking := missing("thumbv7em"):
        pytest.skip(f"{lacking} is not installed")
    words, took = build_program(content, TARGETS["thumbv7em"], tmp_path), []
    for board in ("mps2-an386", "mps2-an500", "mps2-an500"):
        with Program(
            content, [board if word == "mps2-an386" else word for word in words]
        ) as program:
            program.create()
            assert same_bits(answers_of(content, program), answers_here(content, law()))
            took.append(program.measured)
    assert took[0] == took[1] == took[2]
    assert took[0].error == 0
    # float64 is arithmetic of the C compiler there
    assert 1000 < took[0].instructions_a_step < 100_000
    assert 0 < took[0].stack < 8192


def test_a_board_counts_what_is_executed(content, tmp_path):
    """100 000 instructions, the loop around them, and reading the counter by a division."""
    if lacking := missing("thumbv7em"):
        pytest.skip(f"{lacking} is not installed")
    target, library = TARGETS["thumbv7em"], Library(content, "known")
    start, memory = library.write(tmp_path, target, ["board.c", "board.ld"])
    (source := tmp_path / "known.c").write_text(_KNOWN_ON_A_BOARD)
    program = target.program(
        [source, start], tmp_path / "known", [*target.linking, "-T", str(memory)]
    )
    found = subprocess.run(
        [*target.emulator, program], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, timeout=60
    )
    assert 100_000 <= int(found.stdout) <= 100_000 + 300


def test_an_emulator_counts_each_program_for_itself(content, tmp_path):
    """They run at the same time.

    A step takes what it takes, and creating, resetting and looking is none.
    """
    if lacking := missing("arm-linux"):
        pytest.skip(f"{lacking} is not installed")
    words = counted(build_program(content, TARGETS["arm-linux"], tmp_path), tmp_path)
    with Program(content, words) as one, Program(content, words) as other:
        one.create(), other.create()
        for n in range(STEPS):
            assert other.measured.steps == n
            assert one.step(given(content, n)) == other.step(given(content, n))
            other.restore(other.state)
        alone, beside = one.measured, other.measured
        assert one.reset(law().configurations[ROLE].common.seed)[0] == 0
        assert one.measured[:4] == alone[:4]
    assert not alone.error
    assert alone.instructions == beside.instructions > 0


def test_an_emulator_counts_what_is_executed(tmp_path):
    if lacking := missing("aarch64-linux"):
        pytest.skip(f"{lacking} is not installed")
    source, target = tmp_path / "known.c", TARGETS["aarch64-linux"]
    source.write_text(_KNOWN)
    words = counted([*target.emulator, str(target.program([source], tmp_path / "known"))], tmp_path)
    found = int(subprocess.run(words, stdout=subprocess.PIPE, check=True).stdout)
    assert 10_000 <= found <= 10_000 + 10 * 3 + 10  # the loop around them, and reading the count


def test_an_emulator_without_plugins_is_named(command, tmp_path):
    emulator = tmp_path / "qemu-old"
    emulator.write_text("#!/bin/sh\necho unknown option >&2\nexit 1\n")
    emulator.chmod(0o755)
    with pytest.raises(
        ParameterError, match=r"qemu-old does not take the plugin that counts: unknown option"
    ):
        counted([str(emulator), *command], tmp_path)


# Ten times a thousand instructions. A block is counted when it begins, so those beside a call that
# reads the count belong to other blocks than the call.
_KNOWN = """
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
static const volatile uint64_t *counted;
static __attribute__((noinline)) uint64_t now(void) { return *counted; }
int main(int count, char **words)
{
    counted = mmap(0, 8, PROT_READ, MAP_SHARED, atoi(words[1]), 0);
    uint64_t first = now();
    for (int i = 0; i < 10; i++) __asm__ volatile(".rept 1000\\n nop\\n .endr");
    printf("%d", (int)(now() - first));
    return 0;
}
"""


_KNOWN_ON_A_BOARD = """
#include <stdint.h>
#include <stdio.h>
uint64_t board_instructions(void);
int main(void)
{
    uint64_t first = board_instructions();
    for (int i = 0; i < 10; i++) __asm__ volatile(".rept 10000\\n nop\\n .endr");
    printf("%d", (int)(board_instructions() - first));
    return 0;
}
"""


# A file with given rows in the place of the kernel, or an error.
_COUNTER = """
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
long syscall(long number, ...)
{
    const char *given = getenv("COUNTER");
    if (*given == '/') return open(given, O_RDONLY);
    errno = atoi(given);
    return -1;
}
"""
# instructions that calls without a step take, the last one to paint the stack
_NOTHING = (900, 7, 9, 7, 50)


@pytest.fixture(scope="module")
def kernel(tmp_path_factory):
    source = tmp_path_factory.mktemp("kernel") / "counter.c"
    source.write_text(_COUNTER)
    return TARGETS["x86_64-linux"].program(
        [source], source.with_suffix(".so"), ("-fPIC", "-shared")
    )


def measured_with(kernel, content, command, counter, steps: int):
    with Program(
        content, ["env", f"LD_PRELOAD={kernel}", f"COUNTER={counter}", *command]
    ) as program:
        program.create()
        answers_of(content, program, steps)
        return program.measured


@pytest.mark.parametrize("is_lent", [False, True])
def test_the_counter_of_the_processor_is_read_around_each_step(
    is_lent, kernel, content, command, tmp_path
):
    pairs = [*_NOTHING, 107, 207, 7, 50]
    counts = np.cumsum([each for pair in pairs for each in (1000, pair)])
    # in the first step
    rows = np.stack([counts, counts, counts - is_lent * (counts == counts[11])], axis=1)
    rows.astype("<u8").tofile(tmp_path / "counts")
    measured = measured_with(kernel, content, command, tmp_path / "counts", 3)
    assert measured.steps == 3
    if is_lent:
        assert measured.why_not_counted == "the counter there did not count all the time"
    else:
        assert (measured.error, measured.instructions) == (0, 100 + 200 + 0)


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (errno.EACCES, "the kernel there does not allow it (kernel.perf_event_paranoid)"),
        (errno.ENOENT, "the processor there shows no counter of them"),
        (errno.EMFILE, "Too many open files"),
    ],
)
def test_why_instructions_are_not_counted_is_given_in_words(error, line, kernel, content, command):
    measured = measured_with(kernel, content, command, error, 1)
    assert (measured.why_not_counted, measured.instructions, measured.steps) == (line, 0, 1)


def test_a_count_that_stands_still_is_none(content, command, tmp_path):
    """A counter that never moves is that of an emulator without its plugin."""
    (tmp_path / "count").write_bytes(bytes(8))
    with Program(content, ["sh", "-c", f"exec {command[0]} 9 9<{tmp_path}/count"]) as program:
        assert program.measured.why_not_counted == "the counter there stands still"


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
        assert same_bits(
            answers_of(content, other, begin=25), answers_of(content, program, begin=25)
        )


def test_what_is_refused_changes_nothing(content, program):
    before, tunables = (
        program.state,
        [tunable for part in content.parts for tunable in part.tunables],
    )
    index, high = next(
        (n, tunable.high) for n, tunable in enumerate(tunables) if math.isfinite(tunable.high)
    )
    assert program.step([*given(content, 0)[:-1], math.nan])[0] == -2
    assert program.measured.steps == 0
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


def test_an_older_program_is_refused_by_its_protocol(content, tmp_path):
    """The first version answered with the same identity, and less of what steps have taken."""
    (tmp_path / "answer").write_bytes(struct.pack("<Q3I", int(content.digest[:16], 16), 1, 1, 8))
    with pytest.raises(
        ParameterError, match="it knows another version of the protocol: build it again"
    ):
        Program(content, ["sh", "-c", f"cat {tmp_path}/answer; exec cat >/dev/null"])


def test_what_a_refused_program_has_started_is_ended(content, tmp_path, monkeypatch):
    monkeypatch.setattr(exported, "PATIENCE", 0.2)
    with pytest.raises(ParameterError, match=r"no answer within 0\.2 s"):
        Program(content, ["sh", "-c", f"sleep 1000 & echo $! > {tmp_path}/id; wait"])
    child = Path(f"/proc/{int((tmp_path / 'id').read_text())}/stat")
    # which adopts it takes its time
    wait_until(lambda: not child.exists() or child.read_text().split()[2] == "Z")


def test_a_request_that_is_not_read_has_a_limit(content, command, monkeypatch):
    """It is longer than a pipe is, and the program reads no further than its identity."""
    with Program(content, ["sh", "-c", f"head -c 1 | {command[0]}; exec sleep 1000"]) as deaf:
        monkeypatch.setattr(exported, "PATIENCE", 0.2)
        with pytest.raises(ParameterError, match=r"no answer within 0\.2 s"):
            deaf.drive(1 << 20)


def test_a_program_that_does_not_end_with_its_input_is_ended(content, command):
    # its identity, and nothing more
    silent = ["sh", "-c", f"head -c 1 | {command[0]}; exec sleep 30"]
    running = Program(content, silent)
    running.close()
    assert running._process.returncode == -9
