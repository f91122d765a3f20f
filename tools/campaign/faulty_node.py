"""One of our nodes whose messages get lost, late, doubled or spoilt: HOW SHARE SEED ROLE --ros-args ..."""

from __future__ import annotations

import os
import random
import sys
import time
from functools import partial
from typing import Any

from campaign.spoiling import spoilt
from ev_msgs_py.contract.stamps import RUNS
from ev_msgs_py.wire import format_of, stamp_of
from ev_nodes.node_loop.ordinary_steps import VARIABLE
from ev_nodes.run_role import run_role
from ev_nodes.stepping.signal_io import SignalWriter

_LATE = 0.05  # s at most


class Faulty:
    """Stands in the place of what publishes a signal."""

    def __init__(self, how: str, share: float, chance: random.Random) -> None:
        self._how, self._share, self._chance = how, share, chance
        self._said = 0
        self._last: dict[int, bytes] = {}

    def write(self, writer: SignalWriter, message: bytes) -> None:
        """Publish a message, or what becomes of it."""
        say = partial(_publish, writer)
        self._said += 1
        if self._how == "mute":
            if self._said <= self._share:
                say(message)
            return
        if self._chance.random() >= self._share:
            say(message)
        elif self._how == "delay":
            time.sleep(self._chance.uniform(0.0, _LATE))
            say(message)
        elif self._how == "duplicate":
            say(message)
            say(message)
        elif self._how == "reorder":
            say(message)
            before = self._last.get(id(writer), message)
            if stamp_of(before) >= RUNS:  # the first stamp of a run behind others means a reset
                say(before)
        elif self._how != "loss":
            say(spoilt(message, self._how, self._chance))
        self._last[id(writer)] = message


def _publish(writer: SignalWriter, message: bytes) -> None:
    writer.publisher.publish(message)


def main() -> None:
    """Play the role, with a fault behind each of its publishers."""
    how, share, seed, role = sys.argv[1:5]
    del sys.argv[1:5]
    faulty = Faulty(how, float(share), random.Random(int(seed)))
    plain = SignalWriter.__init__

    def made(writer: SignalWriter, node: Any, topic: Any) -> None:
        plain(writer, node, topic)
        pack = format_of(topic.signal).pack
        # An attribute of the object goes before the method of its class.
        writer.write = lambda stamp, here: faulty.write(writer, pack(stamp, here))  # type: ignore[method-assign]

    os.environ[VARIABLE] = "0"  # compiled, it would publish by itself
    SignalWriter.__init__ = made  # type: ignore[method-assign,assignment]
    run_role(role)


if __name__ == "__main__":
    main()
