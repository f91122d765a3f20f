"""Messages of a bag that may be open still, or was never closed."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path

from mcap.exceptions import EndOfFile
from mcap.records import Message
from mcap.stream_reader import StreamReader


def scanned(file: Path) -> Iterator[tuple[int, bytes]]:
    """Time and data of a file's messages, read as `mcap recover` does, without an index."""
    with file.open("rb") as content:
        try:
            for record in StreamReader(content).records:
                if isinstance(record, Message):
                    yield record.log_time, record.data
        except (EndOfFile, struct.error):  # the library reads a length that is cut off
            return
