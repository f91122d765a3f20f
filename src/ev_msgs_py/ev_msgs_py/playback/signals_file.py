"""Files of signals: one array for each channel under its name, and `time`."""

from __future__ import annotations

from pathlib import Path

import numpy as np

TIME = "time"  # [s], what the array of the instants is called


class RecordingError(ValueError):
    """A file holds no recording; the message names it, in one line."""


def read_arrays(path: Path | str) -> dict[str, np.ndarray]:
    """The arrays of signals.npz by name; OSError if it is not there, RecordingError if it is damaged."""
    try:
        with np.load(path, allow_pickle=False) as arrays:
            return {name: arrays[name] for name in arrays.files}
    except FileNotFoundError:
        raise
    except Exception as error:  # whatever numpy, zip and zlib raise for bytes that are none of theirs
        raise RecordingError(f"{path} holds no signals: {' '.join(str(error).split())[:200]}") from None
