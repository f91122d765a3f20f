"""A run that all tests of this folder replay."""

from __future__ import annotations

from pathlib import Path

import pytest

from ev_stack.commands.run_scenario import main


@pytest.fixture(scope="session")
def turn(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Power steering up to the first turn, without a bag."""
    out = tmp_path_factory.mktemp("turn")
    main(
        [
            "shchur2019",
            "--offline",
            "--duration",
            "11",
            "--no-report",
            "--no-record",
            "--out",
            str(out),
        ]
    )
    return out
