"""Files that are there as a whole or not at all, in the place of nothing."""

from __future__ import annotations

import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO


@contextmanager
def atomic_file(path: Path | str, replaces: bool = False) -> Iterator[IO[bytes]]:
    """A binary file that takes its name only when everything is written; a failure leaves what was there before.

    FileExistsError if something has this name by then, unless it `replaces` that; OSError names the file.
    """
    path = Path(path)
    unfinished = path.with_name(f".{path.name}.{secrets.token_hex(4)}")
    try:
        with unfinished.open("xb") as file:
            try:
                yield file
                file.close()
                if not replaces:
                    path.touch(exist_ok=False)  # unlike a test for existence nobody can come in between
                unfinished.replace(path)
            finally:
                unfinished.unlink(missing_ok=True)
    except OSError as error:  # what has no room on the disk says not where
        if error.errno is None or error.filename is not None:
            raise
        raise OSError(error.errno, error.strerror, str(path)) from None
