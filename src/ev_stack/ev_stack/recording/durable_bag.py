"""A rosbag2 MCAP bag that is complete on disk at every instant, even when the process is killed.

An MCAP file is readable only with its trailer (index and footer) behind the data, and no system
call can exchange a trailer of several pages in one piece: a signal may stop a long write between
two pages. So the recording is kept in two files. Each checkpoint extends the one that metadata.yaml
does not name, the spare, gives it a name that ends in
.mcap, and then replaces metadata.yaml, which names the file to read and counts its messages: that rename is the commit.
Every byte is written twice; compressed that is little, and there is no need to trust anything but
rename. The data survives the end of the process, not a loss of power: nothing waits for the disk.
"""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import ClassVar

from rosbags.interfaces import (
    Connection,
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import McapWriter
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore


class _PositionedBuffer(BytesIO):
    """Bytes that belong at some position of a file, kept in memory, telling positions in that file."""

    def __init__(self, start: int) -> None:
        super().__init__()
        self.start = start

    def tell(self) -> int:
        return self.start + super().tell()

    def close(self) -> None:
        """Stay readable: the library closes what it has written, and then the bytes are wanted."""


class TwinStorage(McapWriter):
    """The library's MCAP storage, closed as often as one likes, each time into the spare one of two files.

    `bio` collects the chunks since the last commit; `path` is the name that the spare gets when it
    is complete.
    """

    def __init__(self, directory: Path, compression: CompressionMode) -> None:
        try:
            super().__init__(directory, compression)
        finally:  # what it could not begin would be written on whenever Python forgets it
            if hasattr(self, "bio"):
                self.bio.close()
        self.final = self.path
        self.spare = self.final.with_suffix(".mcap.spare")
        self.bio = _PositionedBuffer(start=0)
        self.bio.write(self.final.read_bytes())  # the header, which the library writes at once
        self.final.rename(self.spare)
        self.path, self.current = (directory / f"{directory.name}_{twin}.mcap" for twin in (0, 1))
        self.current.touch()
        self.lag = b""  # what the current file holds beyond the spare, apart from its trailer

    def close(self, version: int, metadata: str) -> None:
        """Complete the spare with all chunks and a trailer, and call it `path`."""
        if self.chunk.bio.tell():
            self.close_chunk()
        chunks = self.bio
        self.bio = trailer = _PositionedBuffer(start=chunks.tell())
        try:
            super().close(version, metadata)
        finally:
            self.bio = chunks

        if self.path.exists():  # from a commit that failed after this point
            self.path.rename(self.spare)
        with self.spare.open("r+b") as file:
            file.seek(chunks.start - len(self.lag))
            file.writelines((self.lag, chunks.getbuffer(), trailer.getbuffer()))
            file.truncate()
        self.spare.rename(self.path)

    def committed(self) -> None:
        """Take note that metadata.yaml names `path`: the file that was current is the spare now."""
        self.current.rename(self.spare)
        self.current, self.path = self.path, self.current
        self.lag = self.bio.getvalue()
        self.bio = _PositionedBuffer(start=self.bio.tell())


class TwinWriter(Writer):
    """The library's bag writer, which may commit again and again what others do once at the end."""

    STORAGE_PLUGINS: ClassVar = {StoragePlugin.MCAP: TwinStorage}

    def commit(self) -> None:
        """Bring spare file and metadata.yaml up to date, in this order."""
        storage = self.storage
        try:
            self.close()
        finally:
            self.storage = storage
        storage.committed()

    def finish(self) -> None:
        """Remove the spare; nothing can be written from now on."""
        self.storage.spare.unlink()
        self.storage = None


@cache
def ros_types() -> Typestore:
    """The definitions of messages, also of packages that are not installed."""
    return get_typestore(Stores.ROS2_KILTED)


# What ROS 2 writes for "no limit": the longest duration that it can express.
UNLIMITED = QosTime(sec=9223372036, nsec=854775807)


class DurableBag:
    """Record serialized messages into a new bag; at most `checkpoint_period` seconds of them are not yet on disk.

    FileExistsError if the directory exists; OSError, and no directory, if there is no room to
    begin. Use it from one thread. An OSError out of `write` or `checkpoint` (a full disk) leaves
    the last checkpoint as it was, and the next checkpoint tries again with everything since.
    """

    def __init__(
        self,
        directory: Path,
        checkpoint_period: float = 0.8,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        if directory.exists():
            raise FileExistsError(f"{directory} exists already: a recording needs a new directory")
        self._checkpoint_period = checkpoint_period
        self._clock = clock
        self._writer = TwinWriter(
            directory, version=Writer.VERSION_LATEST, storage_plugin=StoragePlugin.MCAP
        )
        self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        try:
            self._writer.open()
            self._commit()
        except OSError:  # no room for an empty bag: what there is of it cannot be read
            shutil.rmtree(directory, ignore_errors=True)
            raise

    def add_topic(
        self, name: str, message_type: str, depth: int = 10, lasts: bool = False
    ) -> Connection:
        """Announce a topic with the quality of service of its publisher; the answer is the handle for `write`.

        What `lasts` is kept for subscribers that come later.
        """
        quality = Qos(
            history=QosHistory.KEEP_LAST,
            depth=depth,
            reliability=QosReliability.RELIABLE,
            durability=QosDurability.TRANSIENT_LOCAL if lasts else QosDurability.VOLATILE,
            deadline=UNLIMITED,
            lifespan=UNLIMITED,
            liveliness=QosLiveliness.AUTOMATIC,
            liveliness_lease_duration=UNLIMITED,
            avoid_ros_namespace_conventions=False,
        )
        self._pending = True
        return self._writer.add_connection(
            name, message_type, typestore=ros_types(), offered_qos_profiles=[quality]
        )

    def write(self, handle: Connection, stamp_ns: int, data: bytes) -> None:
        """Record one message, CDR with its encapsulation header as a raw subscription delivers it."""
        self._writer.write(handle, stamp_ns, data)
        self._pending = True
        self.checkpoint_where_due()

    def checkpoint_where_due(self) -> None:
        """A checkpoint if the period is over; `write` calls this, and a writer that may fall silent does so as well."""
        if self._clock() >= self._next_checkpoint:
            self.checkpoint()

    def checkpoint(self) -> None:
        """Make the bag on disk hold everything written so far; free when it already does."""
        if self._pending:
            self._commit()

    def close(self) -> None:
        """Leave a bag of one file, NAME.mcap, in the directory NAME."""
        if self._writer.storage is None:
            return
        self._writer.storage.path = self._writer.storage.final  # the name that every bag has
        self._commit()
        self._writer.finish()

    def __enter__(self) -> DurableBag:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def _commit(self) -> None:
        # The time for the next attempt is set first: after a failure every single write would try
        # again.
        self._next_checkpoint = self._clock() + self._checkpoint_period
        self._writer.commit()
        self._pending = False
