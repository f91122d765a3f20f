"""For whom a node waits, told to its runner for as long as it does."""

from __future__ import annotations

import time
from collections.abc import Iterable

from ev_msgs_py.nodes.runner_line import WAITS, RunnerLine, Word

_LASTS = 0.2  # s without a step until a node waits, and between two words


class Waiting:
    """Says again and again whom a node waits for where its steps stand still; `look` is to be called often."""

    def __init__(self, runner: RunnerLine) -> None:
        self._runner = runner
        self._at: object = None
        self._next = 0.0  # when there is something to say

    def look(self, at: object, whom: Iterable[str]) -> None:
        """`at` is where the node is; the roles that it waits for matter where that stays."""
        now = time.monotonic()
        if at != self._at:
            self._at, self._next = at, now + _LASTS
        elif now >= self._next:
            self._next = now + _LASTS
            self._runner.tell(Word(WAITS, values={"whom": list(whom)}))
