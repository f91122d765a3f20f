"""Pace in the progress bar."""

from __future__ import annotations

import time
from types import SimpleNamespace

from ev_stack.recording import outcome


def test_behind_a_reset_the_pace_is_that_of_the_new_run(monkeypatch):
    """Simulated time goes back there, which is no negative pace."""
    wall, bars = [0.0], []

    class Bar(SimpleNamespace):
        def __init__(self, **options) -> None:
            super().__init__(n=0.0, unit="-", paces=[])
            bars.append(self)

        def __enter__(self) -> None: ...

        def __exit__(self, *error: object) -> None: ...

        def refresh(self) -> None: ...

        def update(self, more: float) -> None:
            self.n += more
            self.paces.append(self.unit)

    monkeypatch.setattr(time, "monotonic", lambda: wall[0])
    monkeypatch.setattr(outcome, "tqdm", Bar)
    with outcome.progress_bar("lane_change", 10.0) as progress:
        for simulated in (2.0, 4.0, 0.0, 0.0, 1.0, 4.0):
            progress(simulated)
            wall[0] += 1.0
    assert bars[0].paces == ["-", "2.0", "2.0", "2.0", "2.0", "3.0"]
    assert bars[0].n == 4.0
