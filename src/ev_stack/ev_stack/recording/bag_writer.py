"""A rosbag2 MCAP bag: messages on disk within a second, index and metadata at the end.

A recorder that is killed leaves a file without index and metadata.yaml. It lacks only what was
written in the last second: readers that go through the file, such as `ros2 bag`, `mcap recover` and
Foxglove, find all the rest. Nothing waits for the disk, so a loss of power may cost more.
"""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

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
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

# What ROS 2 writes for "no limit": the longest duration that it can express.
UNLIMITED = QosTime(sec=9223372036, nsec=854775807)


@cache
def ros_types() -> Typestore:
    """Definitions of messages, also of packages that are not installed."""
    return get_typestore(Stores.ROS2_KILTED)


class BagWriter:
    """Records serialized messages into a new bag.

    At most `flush_period` seconds of them are not yet on the disk.

    FileExistsError if the directory exists; OSError, and no directory, if there is no room to
    begin. It is used from one thread.
    """

    def __init__(
        self,
        directory: Path,
        flush_period: float = 0.8,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        if directory.exists():
            raise FileExistsError(f"{directory} exists already: a recording needs a new directory")
        self._flush_period = flush_period
        self._clock = clock
        self._next_flush = clock() + flush_period
        self._writer = Writer(
            directory, version=Writer.VERSION_LATEST, storage_plugin=StoragePlugin.MCAP
        )
        # By chunks of the file, not message by message.
        self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        try:
            self._writer.open()
            self._writer.storage.bio.flush()
        except OSError:  # no room for an empty bag: what there is of it cannot be read
            shutil.rmtree(directory, ignore_errors=True)
            raise

    def add_topic(
        self, name: str, message_type: str, depth: int = 10, lasts: bool = False
    ) -> Connection:
        """Announce a topic with the quality of service of its publisher, and return the handle for `write`.

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
        return self._writer.add_connection(
            name, message_type, typestore=ros_types(), offered_qos_profiles=[quality]
        )

    def write(self, handle: Connection, stamp_ns: int, data: bytes) -> None:
        """Record one message, CDR with its encapsulation header as a raw subscription delivers it."""
        self._writer.write(handle, stamp_ns, data)
        self.flush_where_due()

    def flush_where_due(self) -> None:
        """Bring everything to the disk if the period is over.

        `write` calls this, and a writer that may fall silent does so as well.
        """
        now = self._clock()
        storage = self._writer.storage
        if now < self._next_flush or storage is None:  # None: the bag is closed
            return
        self._next_flush = now + self._flush_period
        # A chunk can only be read when it is closed; an empty one would be one more for nothing.
        if storage.chunk.bio.tell():
            storage.close_chunk()
        storage.bio.flush()

    def close(self) -> None:
        """Write index and metadata; nothing can be written from now on."""
        if self._writer.storage is not None:
            self._writer.close()

    def __enter__(self) -> BagWriter:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()
