"""The library's bag writer on two files, of which one is complete at every instant (see `durable_bag`)."""

from __future__ import annotations

from io import BytesIO
from pathlib import Path
from typing import ClassVar

from rosbags.rosbag2 import CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import McapWriter


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

    `bio` collects the chunks since the last commit; `path` is the name that the spare gets when it is complete.
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

    def name_for_good(self) -> None:
        """Let the next commit use the name that every bag has, NAME.mcap."""
        self.storage.path = self.storage.final

    def finish(self) -> None:
        """Remove the spare; nothing can be written from now on."""
        self.storage.spare.unlink()
        self.storage = None
