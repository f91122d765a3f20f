"""Time that tests wait for other processes: no test fails because a machine is slow or busy."""

import time
from collections.abc import Callable

# s of wall time without progress, after which something hangs. A busy machine once took 30.
PATIENCE = 300.0


def wait_until(
    holds: Callable[[], object], progress: Callable[[], object] = lambda: None, about: object = ""
) -> None:
    """Look until something holds.

    Fail where `progress` gives the same for so long, and show what it is `about`.
    """
    seen, since = progress(), time.monotonic()
    while not holds():
        if progress() != seen:
            seen, since = progress(), time.monotonic()
        assert time.monotonic() < since + PATIENCE, about() if callable(about) else about
        time.sleep(0.02)
