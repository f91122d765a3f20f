"""Ctrl-C and SIGTERM as a request that the program looks at between two steps."""

from __future__ import annotations

import atexit
import os
import signal
import sys
import time
from _thread import interrupt_main, start_new_thread
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType, TracebackType
from typing import NoReturn

from ev_core.compiled.interruptible import REQUESTS

_SIGNALS = (signal.SIGINT, signal.SIGTERM)
STOPPED = 130  # the status that shells know of a command that Ctrl-C has ended

_A_MOMENT = 0.001  # s

KEPT: list[
    object
] = []  # objects that must not be destroyed: while there are any, a command leaves Python's end out
_INTERRUPTS: list[int] = []  # signals that came as KeyboardInterrupt


def hold_back() -> None:
    """Let these signals wait until `let_in`, also in a program that this process becomes: it cannot handle them yet."""
    signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)


def let_in() -> None:
    """Let in the signals that we or our parent process have held back."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _SIGNALS)


def turn_deaf() -> None:
    """Ignore these signals from here on: the process ends anyway, and Python's own end cannot bear them.

    Where it waits for its threads it would print a traceback, and where it has put its handlers
    away it would be killed with its shared memory left behind.
    """
    for kind in _SIGNALS:
        signal.signal(kind, signal.SIG_IGN)


def end_stopped(*_: object) -> NoReturn:
    """End the process as a command that was stopped, with one line, also as the handler of a signal.

    Python's own end is left out: an interrupt may have left modules of C half-made, which cannot be
    destroyed.
    """
    turn_deaf()
    atexit._run_exitfuncs()
    with suppress(OSError, ValueError):  # the reader of the output may be gone
        print("stopped", file=sys.stderr, flush=True)
        sys.stdout.flush()
    os._exit(STOPPED)


def end(code: int | str | None) -> NoReturn:
    """End the process with this status or line, as `sys.exit` does, but without Python's own end."""
    with suppress(OSError, ValueError):  # the reader of the output may be gone
        if isinstance(code, str) and code:
            print(code, file=sys.stderr, flush=True)
        sys.stdout.flush()
    os._exit(1 if isinstance(code, str) and code else int(code or 0))


@contextmanager
def loading() -> Iterator[None]:
    """Let these signals end the process at once while the block imports modules, with nothing to clean up."""
    handled = [
        kind for kind in _SIGNALS if callable(signal.getsignal(kind))
    ]  # in the background Ctrl-C is ignored
    before = {kind: signal.signal(kind, end_stopped) for kind in handled}
    try:
        yield
    finally:
        for kind, handler in before.items():
            signal.signal(kind, handler)


def interrupt(number: int, frame: FrameType | None) -> None:
    """Handle a signal as Python handles Ctrl-C, by KeyboardInterrupt, and remember that it came."""
    _INTERRUPTS.append(number)
    raise KeyboardInterrupt


def was_interrupted() -> bool:
    """Return whether an interrupt came.

    It may show as another error, as behind a callback from C.
    """
    return bool(_INTERRUPTS)


def interrupt_destructors() -> None:
    """Let Ctrl-C end the program also where it meets a destructor: Python would print a traceback and go on.

    Nor is there a traceback where an object that an interrupt has left half-made cannot be
    destroyed.
    """
    report = sys.unraisablehook

    def hook(unraisable: sys.UnraisableHookArgs) -> None:
        if not issubclass(unraisable.exc_type, KeyboardInterrupt):
            if not was_interrupted():
                report(unraisable)
            return
        # In the background Ctrl-C is ignored: then it was SIGTERM.
        which = signal.SIGINT if callable(signal.getsignal(signal.SIGINT)) else signal.SIGTERM
        while True:
            try:
                start_new_thread(_interrupt_soon, (which,))
                return
            except (
                KeyboardInterrupt
            ):  # raised in here it is lost: on a busy machine a moment may be too short
                continue

    sys.unraisablehook = hook
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, interrupt)


def _interrupt_soon(which: signal.Signals) -> None:
    time.sleep(_A_MOMENT)
    interrupt_main(which)


class StopRequest:
    """Remembers, for the time of its `with` block, that SIGINT or SIGTERM came.

    rclpy's own handlers shut its context down under a node that is just using it, and Python's
    interrupt any line. This leaves everything intact, so that the running code can finish and clean
    up. A second signal raises KeyboardInterrupt wherever the program is, unless the request is
    `patient`; so does the first one where a law never ends. For the main thread only.
    """

    def __init__(self, patient: bool = False) -> None:
        self.received = False
        self._patient = patient

    def __enter__(self) -> StopRequest:
        REQUESTS.append(self._is_received)
        self._before = {kind: signal.signal(kind, self._on_signal) for kind in _SIGNALS}
        let_in()
        return self

    def __exit__(
        self, kind: type | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        REQUESTS.remove(self._is_received)
        for number, handler in self._before.items():
            if signal.getsignal(number) == self._on_signal:  # else the process has turned deaf
                signal.signal(number, handler)

    def _is_received(self) -> bool:
        return self.received

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        if self.received and not self._patient:
            raise KeyboardInterrupt
        self.received = True
