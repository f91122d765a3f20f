"""The example of docs/batch.md is what it says."""

from __future__ import annotations

from pathlib import Path

import numpy as np

PAGE = Path(__file__).parents[3] / "docs" / "batch.md"


def test_the_example_runs(capsys):
    text = PAGE.read_text().partition("```python\n")[2].partition("```")[0]
    names: dict = {}
    exec(compile(text, str(PAGE), "exec"), names)
    found = names["found"]
    assert capsys.readouterr().out.endswith("(9, 81)\n{}\n")
    assert found.time[-1] == 8.0
    # each a metre per second faster than the one before
    assert (np.diff(found.metrics["end"]) > 0.9 * 8.0).all()
    # the fastest has to turn hardest
    assert found.metrics["peak_lateral_acceleration"].argmax() == 8
