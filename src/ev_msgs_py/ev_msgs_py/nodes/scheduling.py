"""What a process may ask of the system so that its steps are not held up: real-time priority and memory that stays."""

from __future__ import annotations

import ctypes
import os
from collections.abc import Iterator
from pathlib import Path

from ev_msgs_py.lockstep.common_parameters import CommonParameters

_CURRENT_AND_FUTURE = 1 | 2  # of mlockall


def ask_for(p: CommonParameters) -> Iterator[str]:
    """Ask for what the parameters say, for all threads of this process; what is not granted, one line each."""
    if p.scheduling_priority:
        try:
            for thread in Path("/proc/self/task").iterdir():
                os.sched_setscheduler(int(thread.name), os.SCHED_FIFO, os.sched_param(p.scheduling_priority))
        except OSError as error:
            yield (
                f"SCHED_FIFO with priority {p.scheduling_priority} is not granted ({error.strerror}): "
                "needed is CAP_SYS_NICE, or rtprio in /etc/security/limits.conf"
            )
    if p.lock_memory and ctypes.CDLL(None, use_errno=True).mlockall(_CURRENT_AND_FUTURE):
        yield (
            f"locked memory is not granted ({os.strerror(ctypes.get_errno())}): "
            "needed is CAP_IPC_LOCK, or memlock in /etc/security/limits.conf"
        )
