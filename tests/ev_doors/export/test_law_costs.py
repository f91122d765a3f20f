"""The table of docs/native.md: what a law needs on four processors, counted by the emulator."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from documentation import law_costs
from ev_doors.export.content import Content
from ev_doors.export.on_processor import with_processors
from ev_doors.export.targets import TARGETS
from ev_stack.recording.offline import run_offline

PAGE = Path(__file__).parents[3] / law_costs.NATIVE
ROLE, LAW = "electronic_differential", "power_steering"

pytestmark = pytest.mark.slow


@pytest.mark.weekly
def test_a_row_is_that_of_the_page(monkeypatch):
    """The bytes follow from the pinned compiler.

    That the answers have the bits of the recording is part of the count.

    The page has 20 s of the run, here is the begin, where the law may take other branches; most of
    the instructions are those of the loop, which hang on the C compiler, as its stack does. Between
    both ways to count, all are equal.
    """
    for target in law_costs.ON:
        for needed in (TARGETS[target].compiler, law_costs.COUNTING[target][0]):
            if not shutil.which(needed):
                pytest.skip(f"{needed} is not installed")
    monkeypatch.setattr(law_costs, "SECONDS", 0.5)
    _, run, recording = law_costs.driven(ROLE, LAW)
    content = Content(run, only=[ROLE], bare=True)
    costs = [law_costs.cost(content, recording, target) for target in law_costs.ON]
    (row,) = (line for line in PAGE.read_text().splitlines() if line.startswith(f"| `{LAW}` |"))
    constants, *cells = row.strip("| ").split(" | ")[2:]
    code, stack, instructions = ([int(n) for n in cell.split(" / ")] for cell in cells)
    assert [each.code for each in costs] == code
    assert [each.constants for each in costs] == [int(constants)] * len(costs)
    assert [each.stack for each in costs] == pytest.approx(stack, rel=0.5)
    assert [each.instructions_a_step for each in costs] == pytest.approx(instructions, rel=0.25)
    # A processor in the loop runs the same program with the same inputs, so it takes the same
    # instructions.
    moved, (there,) = with_processors(run, {ROLE: "aarch64"})
    run_offline(moved.configurations, moved.duration)
    (measured,) = (
        each for target, each in zip(law_costs.ON, costs, strict=True) if target == "aarch64-linux"
    )
    assert f"; {measured.instructions_a_step} instructions a step" in there.report
    assert (
        f" {measured.stack} bytes of stack, {measured.code} of code, {measured.constants} of"
        in there.report
    )
