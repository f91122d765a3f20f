"""The line of a node to the runner that has started it: a socket that only these two processes hold.

Any process on the graph can publish in the name of a node; only a child of the runner can write
here. Reports for all tools are in /diagnostics as well.
"""

from __future__ import annotations

import errno
import json
import os
import socket
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

# Variable of the environment: file descriptor, process of the runner.
RUNNER_LINE = "EV_STACK_RUNNER_LINE"
PROGRESS, WAITS, WARNING, NOTE, REMARK, TIME_SERVICE, TIMING = WORD_KINDS = (
    "progress",  # of the recorder: `values` has the stamp up to which the run is held [ns]
    "waits",  # `values` has the roles that a node waits for, and why, as far as it knows
    "warning",  # why the run may not be reproducible
    "note",  # reported once for each `what`, and changes no number
    "remark",  # what a part notes of the run
    "time",  # what a service has done to time
    "timing",  # how well real time was kept
)
_NEWEST_COUNTS = (PROGRESS, WAITS)  # of these kinds a word that waits is replaced by the next one
_PATIENCE, _A_MOMENT = 1.0, 0.002  # s, for the last words to find room
_LONGEST = 100_000  # bytes of a word
_NO_ROOM = (
    errno.EAGAIN,
    errno.ENOBUFS,
    errno.ENOMEM,
)  # at the moment, for a word that is not too long
_LASTS = 0.2  # s without a step until a node waits, and between two words about it


@dataclass(frozen=True)
class Word:
    """One message to the runner: its kind, a text for the user, what it is about, and values by name."""

    kind: str
    text: str = ""
    what: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)

    def encoded(self) -> bytes:
        """Return it as JSON."""
        return json.dumps(asdict(self)).encode()

    @classmethod
    def decoded(cls, message: bytes) -> Word:
        """Read a word from JSON; ValueError where it has another form."""
        try:
            word = cls(**json.loads(message))
        except (RecursionError, TypeError) as error:
            raise ValueError(str(error)) from None
        forms = (word.kind, str), (word.text, str), (word.what, str), (word.values, dict)
        if word.kind not in WORD_KINDS or not all(isinstance(value, kind) for value, kind in forms):
            raise ValueError(f"kind {word.kind!r}")
        return word


class RunnerLine:
    """A node's end of the line, if a runner has started it; without one there is no line."""

    def __init__(self) -> None:
        self._socket = _inherited()
        self._waiting: dict[object, bytes] = {}

    def tell(self, word: Word) -> None:
        """Send a word now or, while the socket is full, with a later call.

        Never wait for the runner.
        """
        if self._socket is None:
            return
        self._waiting[word.kind if word.kind in _NEWEST_COUNTS else object()] = word.encoded()
        self.send_what_waits()

    def send_what_waits(self) -> None:
        """Try once more to send what found no room."""
        while self._waiting and self._socket is not None:
            first = next(iter(self._waiting))
            try:
                self._socket.send(self._waiting[first], socket.MSG_DONTWAIT | socket.MSG_NOSIGNAL)
            except OSError as error:
                if error.errno in _NO_ROOM:
                    return
                if error.errno != errno.EMSGSIZE:  # the runner is gone
                    self._waiting.clear()
                    return
            del self._waiting[first]

    def close(self) -> None:
        """Send the last words, and close the socket."""
        given_up = time.monotonic() + _PATIENCE
        self.send_what_waits()
        while self._waiting and time.monotonic() < given_up:
            time.sleep(_A_MOMENT)
            self.send_what_waits()
        if self._socket is not None:
            self._socket.close()
        self._socket = None


def _inherited() -> socket.socket | None:
    """The socket that the environment names, if the runner has made its other end."""
    number, _, runner = os.environ.get(RUNNER_LINE, "").partition(" ")
    try:
        line = socket.socket(fileno=os.dup(int(number)))
    except (ValueError, OSError):
        return None
    if line.family == socket.AF_UNIX and line.type == socket.SOCK_SEQPACKET:
        peer = line.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 4)
        if str(int.from_bytes(peer, "little")) == runner:  # it has made both ends
            return line
    line.close()
    return None


class ListeningEnd:
    """The runner's end of the line of one node."""

    def __init__(self) -> None:
        self._ours, self.theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._ours.setblocking(False)

    @property
    def address(self) -> str:
        """Value of RUNNER_LINE in the environment of the node."""
        return f"{self.theirs.fileno()} {os.getpid()}"

    def heard(self) -> list[bytes]:
        """The messages that have come since."""
        messages: list[bytes] = []
        while True:
            try:
                message = self._ours.recv(_LONGEST)
            except (BlockingIOError, ConnectionError):
                return messages
            if not message:  # the node has hung up
                return messages
            messages.append(message)

    def close(self) -> None:
        """Close both ends; a process that was started has its copy of the node's end."""
        self._ours.close()
        self.theirs.close()


class Waiting:
    """Reports repeatedly which nodes a node waits for while its steps stand still.

    `look` is to be called often.
    """

    def __init__(self, runner: RunnerLine) -> None:
        self._runner = runner
        self._at: object = None
        self._next = 0.0  # when there is something to report

    def look(self, at: object, whom: Iterable[str], why: Callable[[], list[str]] = list) -> None:
        """Report the roles that the node waits for, and why, if it has been at the same place `at` for a while."""
        now = time.monotonic()
        if at != self._at:
            self._at, self._next = at, now + _LASTS
        elif now >= self._next:
            self._next = now + _LASTS
            self._runner.tell(Word(WAITS, values={"whom": list(whom), "why": why()}))
