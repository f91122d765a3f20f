"""A log of frames in a form that the tools of others read: candump, Vector's BLF, or MF4."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import can

from ev_msgs_py.parameters.shown import quoted

SUFFIXES = (".log", ".blf", ".mf4")


class BusLog:
    """Writes frames to a new file, as they come; ValueError, in one line, if that cannot be or a file is there."""

    def __init__(self, file: str) -> None:
        path = Path(file)
        if path.suffix not in SUFFIXES:
            raise ValueError(
                f"parameter log: {quoted(file)} is refused, allowed are files ending with {', '.join(SUFFIXES)}"
            )
        if os.path.lexists(path):
            raise ValueError(f"parameter log: {quoted(file)} is refused, allowed is a file that is not there yet")
        try:
            self._writer: Any = can.Logger(path)
        except (NotImplementedError, ImportError):
            raise ValueError(
                f"parameter log: {quoted(file)} needs the Python package asammdf, which is missing"
            ) from None
        except OSError as error:
            raise ValueError(f"parameter log: {quoted(file)}: {error.strerror or error}") from None

    def write(self, message: can.Message) -> None:
        """Keep one frame."""
        self._writer.on_message_received(message)

    def close(self) -> None:
        """End the file."""
        self._writer.stop()
