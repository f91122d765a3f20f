"""Processor in the loop.

A law that runs as a program elsewhere leaves every signal of a run as it is, to the bit.
"""

from __future__ import annotations

import re
import shutil

import numpy as np
import pytest

from ev_doors.export import on_processor, program
from ev_doors.export.on_processor import with_processors
from ev_doors.export.targets import TARGETS
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.program import perform
from ev_stack.interface.driving import only_run, overrides
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import signal_hash

SECONDS = 0.5
# A law of each source, and a time [s] by which it has answered otherwise than at the start. Those
# compile quickly that are first, in the middle and last: every suite takes them.
SOURCES = (
    ("shchur2019", "", "electronic_differential", "power_steering", 0.5),
    ("ge_ni2005", "increment", "electronic_differential", "slip_target", 0.3),
    ("tatar_chudzik", "all_corrected", "electronic_differential", "steering_correction", 15.1),
    ("urban_mixed", "", "asr", "least_squares", 16.1),
    ("zhileykin2018", "k1_estimated", "electronic_differential", "axle_redistribution", 2.6),
)
EMULATORS = {
    "x86_64": "gcc",
    "aarch64": "qemu-aarch64",
    "arm": "qemu-arm",
    "thumbv7em": "qemu-system-arm",
}


def run(*faults: str):
    """The faults of the role stay here, behind the program."""
    return only_run(
        "shchur2019", "", overrides(duration=SECONDS, set={"driver.faults": list(faults)})
    )


def hash_of(driven) -> str:
    return signal_hash(run_offline(driven.configurations, driven.duration))


@pytest.mark.parametrize("processor", EMULATORS)
def test_the_signals_are_those_of_the_plain_run(processor):
    for needed in (EMULATORS[processor], TARGETS[on_processor.EMULATED[processor]].compiler):
        if not shutil.which(needed):
            pytest.skip(f"{needed} is not installed")
    plain = run("noisy driver.command.drive_torque 5.0")
    moved, (driver,) = with_processors(plain, {"driver": processor})
    assert hash_of(moved) == hash_of(plain)
    steps = round(SECONDS / 0.01) + 1  # the law answers at both ends
    assert driver.report.startswith(f"{plain.name}: driver on {processor}: {steps} steps")
    # An emulator counts; the processor itself where it shows a counter, which virtual machines
    # often do not.
    counted = re.search(r"[1-9]\d* instructions a step$", driver.report)
    assert counted or (
        processor == "x86_64" and "; instructions not counted: the " in driver.report
    )


@pytest.mark.skipif(not shutil.which("qemu-arm"), reason="qemu-arm is not installed")
def test_a_run_goes_on_where_instructions_cannot_be_counted(monkeypatch):
    def refuse(command, folder):
        raise ParameterError("qemu-arm does not take the plugin")

    monkeypatch.setattr(on_processor, "counted", refuse)
    moved, (driver,) = with_processors(run(), {"driver": "arm"})
    hash_of(moved)
    assert driver.report.endswith("; instructions not counted: qemu-arm does not take the plugin")
    driver._part.program._process.kill()
    assert driver.report.startswith("shchur2019: driver on arm: program ")
    assert driver.report.endswith(": it has ended, or does not know the protocol of here")


@pytest.mark.sampled
@pytest.mark.skipif(not shutil.which("gcc"), reason="gcc is not installed")
@pytest.mark.parametrize(
    ("scenario", "name", "role", "law", "seconds"), SOURCES, ids=[source[0] for source in SOURCES]
)
def test_a_law_of_each_source_leaves_the_signals_as_they_are(scenario, name, role, law, seconds):
    plain = only_run(scenario, name, overrides(duration=seconds))
    assert plain.configurations[role].method.name == law
    moved, (there,) = with_processors(plain, {role: "x86_64"})
    recording = run_offline(plain.configurations, plain.duration)
    answers = np.array([recording.channels[channel.name] for channel in there.content.outputs])
    assert np.any(answers != answers[:, :1])  # else a program that does nothing would pass
    assert hash_of(moved) == signal_hash(recording)


@pytest.mark.parametrize(
    ("faults", "role", "where", "line"),
    [
        ((), "plant", "arm", "plant is refused, expected roles that answer"),
        ((), "driver", "'un", 'processor "\'un" is refused: no closing quotation'),
        ((), "driver", " ", "processor ' ' is refused, expected the command of a program"),
        ((), "driver", "''", "processor \"''\" is refused, expected the command of a program"),
        ((), "pilot", "arm", "unknown role 'pilot'"),
        (
            ("restarted driver.command from 0.1 until 0.2",),
            "driver",
            "arm",
            "has a fault `restarted`",
        ),
    ],
)
def test_what_cannot_run_elsewhere_is_one_line(faults, role, where, line):
    with pytest.raises(ParameterError) as refused:
        with_processors(run(*faults), {role: where})
    assert line in str(refused.value)


@pytest.mark.parametrize("command", ["/nowhere/program", "cat", "true"])
def test_a_program_that_is_none_of_ours_ends_the_run_by_name(command, monkeypatch):
    monkeypatch.setattr(program, "PATIENCE", 0.5)  # cat gives the request back, and waits for more
    moved, _ = with_processors(run(), {"driver": command})
    with pytest.raises(ParameterError, match=f"program {command}"):
        hash_of(moved)


def test_nodes_over_dds_are_not_asked_for_as_well():
    with pytest.raises(SystemExit):
        perform(["run", "shchur2019", "--processor", "driver=arm", "--in-process"])
