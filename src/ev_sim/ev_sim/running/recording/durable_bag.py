"""A rosbag2 MCAP bag that is complete on disk at every instant, even when the process is killed.

An MCAP file is readable only with its trailer (index and footer) behind the data, and no system call can exchange a
trailer of several pages in one piece: a signal may stop a long write between two pages. So the recording is kept in
two files. Each checkpoint extends the one that nobody was told of, the spare, gives it a name that ends in .mcap, and
then replaces metadata.yaml, which names the file to read and counts its messages: that one rename is the commit.
Every byte is written twice; compressed that is little, and there is no need to trust anything but rename.
The data survives the end of the process, not a loss of power: nothing waits for the disk.
"""

from __future__ import annotations

import shutil
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType

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

from ev_sim.running.recording.twin_writer import TwinWriter

# What ROS 2 writes for "no limit": the longest duration that it can express.
UNLIMITED = QosTime(sec=9223372036, nsec=854775807)


class DurableBag:
    """Record serialized messages into a new bag; at most `checkpoint_period` seconds of them are not yet on disk.

    FileExistsError if the directory exists; OSError, and no directory, if there is no room to begin. Use it from one
    thread. An OSError out of `write` or `checkpoint` (a full disk) leaves the last checkpoint as it was, and the next
    checkpoint tries again with everything since.
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
        self._types = get_typestore(Stores.ROS2_KILTED)
        self._writer = TwinWriter(directory, version=Writer.VERSION_LATEST, storage_plugin=StoragePlugin.MCAP)
        self._writer.set_compression(CompressionMode.STORAGE, CompressionFormat.ZSTD)
        try:
            self._writer.open()
            self._commit()
        except OSError:  # no room for an empty bag: what there is of it cannot be read
            shutil.rmtree(directory, ignore_errors=True)
            raise

    def add_topic(
        self,
        name: str,
        message_type: str,
        *,
        depth: int = 10,
        reliable: bool = True,
        transient_local: bool = False,
    ) -> Connection:
        """Announce a topic with the quality of service of its publisher; the answer is the handle for `write`."""
        quality = Qos(
            history=QosHistory.KEEP_LAST,
            depth=depth,
            reliability=QosReliability.RELIABLE if reliable else QosReliability.BEST_EFFORT,
            durability=QosDurability.TRANSIENT_LOCAL if transient_local else QosDurability.VOLATILE,
            deadline=UNLIMITED,
            lifespan=UNLIMITED,
            liveliness=QosLiveliness.AUTOMATIC,
            liveliness_lease_duration=UNLIMITED,
            avoid_ros_namespace_conventions=False,
        )
        self._pending = True
        return self._writer.add_connection(name, message_type, typestore=self._types, offered_qos_profiles=[quality])

    def write(self, handle: Connection, stamp_ns: int, data: bytes) -> None:
        """Record one message, CDR with its encapsulation header as a raw subscription delivers it."""
        self._writer.write(handle, stamp_ns, data)
        self._pending = True
        self.checkpoint_where_due()

    def checkpoint_where_due(self) -> None:
        """A checkpoint if the period is over; `write` calls this, and whoever may fall silent does so as well."""
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
        self._writer.name_for_good()
        self._commit()
        self._writer.finish()

    def __enter__(self) -> DurableBag:
        return self

    def __exit__(
        self,
        exception_type: type[BaseException] | None,
        exception: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def _commit(self) -> None:
        # The time for the next attempt is set first: after a failure every single write would try again.
        self._next_checkpoint = self._clock() + self._checkpoint_period
        self._writer.commit()
        self._pending = False
