"""Channels of an ASAM MDF file (.mf4), as a measuring tool has written them in physical units."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from ev_core.parameters.data_file import SIGNALS, open_data
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_study.measured.records.record import Read
from ev_study.measured.records.samples import Sampled

SUFFIX = ".mf4"


def read_columns(file: Path, wanted: Sequence[str]) -> Read:
    """The channels over their times [s] since the file began, with its SHA-256 and their units.

    ParameterError, in one line, if the file cannot be
    read, or if a channel is not there, is there more than once, or has no numbers.
    """
    if find_spec("asammdf") is None:
        raise ParameterError(f"{file} needs the Python package asammdf, which is missing")
    from asammdf import MDF

    try:
        # Refuses a fifo or a file that is too large before asammdf opens it.
        with open_data(file, SIGNALS) as opened:
            digest = hashlib.file_digest(opened, "sha256").hexdigest()
        with MDF(file) as measured:
            found, units = {}, {}
            for column in wanted:
                if column not in measured.channels_db:
                    raise unknown_name(f"channel of {file}", column, sorted(measured.channels_db))
                signal = measured.get(column)
                found[column] = Sampled(
                    np.asarray(signal.timestamps, float), np.asarray(signal.samples, float)
                )
                units[column] = str(signal.unit or "")
    except ParameterError:
        raise
    except OSError as error:
        raise ParameterError(f"{file}: {error.strerror or error}") from None
    # whatever the library raises for what is no MDF file, or for an ambiguous name
    except Exception as error:
        raise ParameterError(
            f"{file}: the file cannot be read: {' '.join(str(error).split())[:200]}"
        ) from None
    return Read(found, digest, units)
