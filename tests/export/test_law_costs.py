"""The table of docs/native.md: what a law needs on three processors, counted by the emulator."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from documentation import law_costs
from ev_sim.export.content import Content
from ev_sim.export.targets import TARGETS

PAGE = Path(__file__).parents[2] / law_costs.NATIVE
ROLE, LAW = "electronic_differential", "power_steering"

pytestmark = pytest.mark.slow


def test_a_row_is_that_of_the_page(tmp_path, monkeypatch):
    """The bytes follow from the pinned compiler; that the answers have the bits of the recording is part of the count.

    Instructions hang on how far the run goes, and stack on the compiler of the loop: here they are of that size only.
    """
    for target in law_costs.DRIVEN:
        for needed in (TARGETS[target].compiler, law_costs.COUNTING[target][0]):
            if not shutil.which(needed):
                pytest.skip(f"{needed} is not installed")
    monkeypatch.setattr(law_costs, "SECONDS", 0.5)
    _, run, recording = law_costs.driven(ROLE, LAW)
    content, counter = Content(run, only=[ROLE], bare=True), law_costs.plugin(tmp_path)
    costs = [law_costs.cost(content, recording, target, counter) for target in law_costs.DRIVEN]
    (row,) = (line for line in PAGE.read_text().splitlines() if line.startswith(f"| `{LAW}` |"))
    code, stack, instructions = ([int(n) for n in cell.split(" / ")] for cell in row.strip("| ").split(" | ")[3:])
    assert [each.code for each in costs] == code
    assert [each.stack for each in costs] == pytest.approx(stack, rel=0.5)
    assert [each.instructions for each in costs] == pytest.approx(instructions, rel=0.5)
