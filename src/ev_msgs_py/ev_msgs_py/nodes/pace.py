"""How simulated time and the wall clock belong together."""

from __future__ import annotations

import time

from ev_msgs_py.contract import stamps


class Pace:
    """Both times begin to count at the last call of `start`; the clock is monotonic.

    What `go_on` has let be lost since counts in the summary, but no instant is due earlier for it.
    """

    def __init__(self) -> None:
        self.start(0)

    def start(self, stamp: int) -> None:
        """Both times begin here."""
        self._rests: float | None = None
        self.go_on(stamp)
        self._begun = self._wall, self._stamp

    def rest(self) -> None:
        """Both stand still until `resume`."""
        if self._rests is None:
            self._rests = time.monotonic()

    def go_on(self, stamp: int) -> None:
        """The next instants are due as if this one were in time."""
        self._wall, self._stamp = time.monotonic(), stamp

    def resume(self, stamp: int) -> None:
        """The same behind a rest, which counts nowhere."""
        self.go_on(stamp)
        if self._rests is not None:
            self._begun = self._begun[0] + self._wall - self._rests, self._begun[1]
            self._rests = None

    def due(self, stamp: int, factor: float) -> float:
        """Wall time [s] at which an instant is due; `factor` is simulated over wall time, above zero."""
        return self._wall + stamps.to_seconds(stamp - self._stamp) / factor

    def summary(self, stamp: int, period: int) -> str:
        """What was simulated up to an instant, and how fast."""
        begun, first = self._begun
        wall, simulated = (self._rests or time.monotonic()) - begun, stamp - first
        return f"{stamps.to_seconds(simulated):g} s simulated in {wall:.3f} s, {simulated // period / wall:.1f} steps/s"
