"""Series that a study has measured on its cases, as signals of a page."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ev_msgs_py.playback.signals_file import TIME
from ev_sim.report.page.content import Signals
from ev_sim.running.recording.recording import Recording


def measured_signals(measured: Mapping[str, Mapping[str, Any]]) -> tuple[Signals, ...]:
    """What was measured over `time` on each case, if there is such a thing on any."""
    series = {name: _series(values) for name, values in measured.items()}
    runs = {name: found for name, found in series.items() if found is not None}
    return (Signals("", runs, None),) if runs else ()


def _series(values: Mapping[str, Any]) -> Recording | None:
    time = values.get(TIME)
    if not isinstance(time, np.ndarray):
        return None
    others = {
        name: np.asarray(each, dtype=np.float64)
        for name, each in values.items()
        if name != TIME and isinstance(each, np.ndarray) and each.shape == time.shape
    }
    return Recording(time, others) if others else None
