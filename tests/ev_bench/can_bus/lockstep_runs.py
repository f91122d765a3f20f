"""Runs of the bench behind its bus, offline."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ev_stack.recording.offline import run_offline
from ev_stack.scenarios.scenario import Overrides, load_scenario

HEALTHY = (
    ("test_bench", "inject.kind", "none"),
    ("inverter_gateway", "enable_at", -1.0),
    ("inverter_gateway", "reset_at", -1.0),
)


def driven(duration: float, *values: tuple[str, str, Any]) -> Mapping[str, np.ndarray]:
    """The channels of bench_fault without its fault."""
    (run,) = load_scenario(
        "bench_fault", Overrides(values=[*HEALTHY, *values], duration=duration)
    ).runs
    return run_offline(run.configurations, duration).channels
