"""Files of signals: one array for each channel under its name, and `time`."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np
from numpy.lib import format

from ev_msgs_py.parameters.data_file import MEGABYTE, SIGNALS, open_data
from ev_msgs_py.parameters.shown import quoted

TIME = "time"  # [s], what the array of the instants is called


class RecordingError(ValueError):
    """A file holds no recording; the message names it, in one line."""


def read_arrays(path: Path | str) -> dict[str, np.ndarray]:
    """The arrays of signals.npz by name; FileNotFoundError, or RecordingError if they are damaged or too large.

    Nothing is made of what the file says of sizes before these fit each other: a few bytes can claim any.
    """
    try:
        with open_data(path, SIGNALS) as file, zipfile.ZipFile(file) as archive:
            members = archive.infolist()
            if sum(each.file_size for each in members) > SIGNALS:
                raise ValueError(f"its arrays are larger than {SIGNALS // MEGABYTE} MB")
            return {each.filename.removesuffix(".npy"): _read(archive, each) for each in members}
    except FileNotFoundError:
        raise
    except OSError as error:
        raise RecordingError(f"{path} holds no signals: {error.strerror or error}") from None
    except Exception as error:  # whatever numpy, zip and zlib raise for bytes that are none of theirs
        raise RecordingError(f"{path} holds no signals: {' '.join(str(error).split())[:200]}") from None


def _read(archive: zipfile.ZipFile, member: zipfile.ZipInfo) -> np.ndarray:
    """One array, (n,) of numbers; ValueError if it is something else."""
    with archive.open(member) as file:
        format.read_magic(file)
        shape, _, kind = format.read_array_header_1_0(file)
        if kind.kind not in "fiu" or len(shape) != 1 or shape[0] * kind.itemsize != member.file_size - file.tell():
            raise ValueError(f"{quoted(member.filename)} is no series of numbers")
        return np.frombuffer(bytearray(file.read()), kind)
