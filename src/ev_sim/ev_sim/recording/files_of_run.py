"""What a command and the nodes of its runs leave in their folders, by name, each as a whole or not at all."""

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


BAG = "bag"
SIGNALS = "signals.npz"
PARAMETERS = "parameters.yaml"
LOG = "log"
SUMMARY, PAGE = OF_ALL_RUNS = ("summary.json", "report.html")

# A bag has two files while it grows (`durable_bag`), and keeps its name before a reset.
_OF_A_BAG = ("metadata.yaml", "metadata.yaml.tmp", f"{BAG}.mcap", f"{BAG}_[01].mcap", f"{BAG}.mcap.spare")
RECORDED = (SIGNALS, *(f"{BAG}/{name}" for name in _OF_A_BAG))
_BEFORE_RESET = tuple(f"{BAG}_before_reset_[0-9]*/{name}" for name in _OF_A_BAG)
