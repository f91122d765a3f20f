"""Buses beside DDS that packages bring: what they do for a run."""

from __future__ import annotations

from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any, Protocol

from ev_core.methods.offered import offered, offered_module
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.records import Run

GROUP = "ev_stack.buses"  # of entry points: the name of a bus, and its module


class Bus(Protocol):
    """A module with what a bus does for a run, if the run has it."""

    def real_bus(
        self, run: Run, domain: int, directory: Path
    ) -> AbstractContextManager[dict[str, dict[str, Any]]]:
        """Channels of this run alone in real time: further parameters of its nodes, by name.

        Raises RunFailed if they cannot be had.
        """

    def frame_log(self, run: Run, directory: Path) -> FrameLog | None:
        """A log of the frames of a run in lockstep, which is open.

        None if none is asked for. Raises RunFailed if it cannot be opened.
        """


class FrameLog(Protocol):
    """Writes the frames of a run that has been recorded."""

    def write(self, recording: Recording) -> str:
        """Write all frames and close the log.

        A line with the reason if it ends before the run does.
        """


def buses() -> list[Bus]:
    """The buses of all packages."""
    return [offered_module(GROUP, "bus", name) for name in sorted(offered(GROUP))]
