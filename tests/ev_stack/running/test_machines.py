"""The same bits on other machines, as far as one machine can act another one."""

from __future__ import annotations

import inspect
import os
import subprocess
import sys

import pytest
from determinism.surroundings import C_LIBRARIES
from determinism.surroundings import COMPILERS as FOREIGN

from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import signal_hash
from ev_stack.scenarios.scenario import load_scenario

MACHINES = {"a C library without FMA and AVX2": C_LIBRARIES["without FMA and AVX2"]}
# between them tyres, drives, columns, drivers and laws
SCENARIOS = ("double_lane_change", "shchur2019", "urban_mixed")
# Compiling the planar plant takes half a minute: scripts/determinism.sh does it, and for all
# scenarios.
QUICKLY_COMPILED = ("shchur2019",)
COMPILERS = ("any x86-64 processor", "without optimisation")


def hashes(*scenarios: str) -> list[str]:
    """Those of the first seconds of scenarios."""
    return [
        signal_hash(run_offline(load_scenario(name).runs[0].configurations, 6.0))
        for name in scenarios
    ]


def hashes_on(machine: dict[str, str], scenarios: tuple[str, ...]) -> list[str]:
    """The same by a process that believes to be elsewhere."""
    imports = (
        "from ev_stack.recording.recording import signal_hash",
        "from ev_stack.recording.offline import run_offline",
        "from ev_stack.scenarios.scenario import load_scenario",
    )
    text = "\n".join((*imports, inspect.getsource(hashes), f"print(*hashes{scenarios})"))
    environment = {**os.environ, **machine}
    done = subprocess.run(
        [sys.executable, "-c", text], env=environment, capture_output=True, text=True, check=True
    )
    return done.stdout.split()


@pytest.mark.parametrize("machine", MACHINES.values(), ids=MACHINES)
def test_another_c_library_gives_the_same_bits(machine):
    """Its sin, exp and atan2 round differently; those of `ev_core.elementary` do not."""
    assert hashes_on(machine, SCENARIOS) == hashes(*SCENARIOS)


@pytest.mark.weekly
@pytest.mark.slow
@pytest.mark.parametrize("compiler", COMPILERS)
def test_another_compiler_gives_the_same_bits(compiler: str):
    """No target contracts a product and a sum, no optimisation reorders sums."""
    assert hashes_on(FOREIGN[compiler], QUICKLY_COMPILED) == hashes(*QUICKLY_COMPILED)
