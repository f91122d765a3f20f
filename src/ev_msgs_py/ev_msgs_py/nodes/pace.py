"""How simulated time and the wall clock belong together."""

from __future__ import annotations

import time

from ev_msgs_py.contract import stamps


class Pace:
    """Both times begin to count at the last call of `start`; the clock is monotonic."""

    def __init__(self) -> None:
        self.start(0)

    def start(self, stamp: int) -> None:
        """Time goes on from here."""
        self._wall, self._stamp = time.monotonic(), stamp

    def due(self, stamp: int, factor: float) -> float:
        """Wall time [s] at which an instant is due; `factor` is simulated over wall time, above zero."""
        return self._wall + stamps.to_seconds(stamp - self._stamp) / factor

    def summary(self, stamp: int, period: int) -> str:
        """What was simulated up to an instant, and how fast."""
        wall, simulated = time.monotonic() - self._wall, stamp - self._stamp
        return f"{stamps.to_seconds(simulated):g} s simulated in {wall:.3f} s, {simulated // period / wall:.1f} steps/s"
