"""Calls of compiled code that may never return, such as a law with an endless loop.

Ctrl-C ends the wait for them.

How it works: Python handles signals in its main thread alone, and there only between two of its own
steps. So another thread makes the call, and the main thread waits for it. Where the handler of a
signal raises an exception, or a request to stop has waited for a while, the wait ends; a call that
still does not return is given up, with its thread, which goes with the process.
"""

from __future__ import annotations

import os
import threading
from _thread import allocate_lock, start_new_thread
from collections.abc import Callable, Sequence
from typing import Any

_GRACE = 0.5  # s for a call to return after a signal: one of a law that ends takes far less
_LOOK = 0.1  # s between two looks at requests to stop

# For each request that is under way: a function that returns whether a stop was asked for. It
# raises nothing by itself.
REQUESTS: list[Callable[[], bool]] = []


class _Caller:
    """A thread that makes one call after the other."""

    def __init__(self) -> None:
        self._asked, self.done = allocate_lock(), allocate_lock()
        self._asked.acquire()
        self.done.acquire()
        self._given: tuple[Callable[[], Any], Any] | None = None
        self.result: Any = None
        self.error: BaseException | None = None
        # Not one that Python counts: workers may be forked off beside it, for it holds nothing
        # between two calls.
        start_new_thread(self._make_calls, ())

    def begin(self, call: Callable[[], Any], works_on: Any) -> None:
        """Let it make a call.

        The memory `works_on` lasts as long as the call, also when its caller has given up.
        """
        self._given = call, works_on
        self._asked.release()

    def _make_calls(self) -> None:
        while True:
            self._asked.acquire()
            assert self._given is not None
            call, works_on = self._given
            self._given = None
            self.error = None
            try:
                self.result = call()
            except BaseException as error:  # raised in the thread that waits
                self.error = error
            # The memory goes with the call, not with the next one.
            del call, works_on
            self.done.release()


_idle: list[_Caller] = []
os.register_at_fork(after_in_child=_idle.clear)  # their threads are not there


def interruptible(call: Callable[[], Any], works_on: Any = None) -> Any:
    """Return the result of a call, or raise its error.

    KeyboardInterrupt where a signal ends the wait. `works_on` holds the memory on which compiled
    code works by its address: a call that is given up goes on. Other threads than the main one,
    which get no signals, make the call themselves.
    """
    if threading.current_thread() is not threading.main_thread():
        return call()
    return side_by_side([call], works_on)[0]


def side_by_side(calls: Sequence[Callable[[], Any]], works_on: Any = None) -> list[Any]:
    """Return the results of calls that are made at once, or raise the first error in their order.

    The rest is that of `interruptible`.
    """
    callers: list[_Caller] = []
    for call in calls:
        caller = _idle.pop() if _idle else _Caller()
        caller.begin(call, works_on)
        callers.append(caller)
    returned = 0
    try:
        for caller in callers:
            _wait(caller)
            returned += 1
    except BaseException:
        # Most calls end in a moment. One that does not is given up, with its thread.
        late = [caller for caller in callers[returned:] if caller.done.acquire(timeout=_GRACE)]
        _idle.extend([*callers[:returned], *late])
        raise
    results = [caller.result for caller in callers]
    errors = [caller.error for caller in callers if caller.error is not None]
    for caller in callers:
        caller.result = caller.error = None
    # Only now: another thread may take them at once.
    _idle.extend(callers)
    if errors:
        raise errors[0]
    return results


def _wait(caller: _Caller) -> None:
    """Wait until a call has returned.

    KeyboardInterrupt if it goes on for longer than a request to stop can wait.
    """
    asked = 0.0
    while not caller.done.acquire(timeout=_LOOK):
        asked = asked + _LOOK if any(is_asked() for is_asked in REQUESTS) else 0.0
        if asked > _GRACE:
            raise KeyboardInterrupt
