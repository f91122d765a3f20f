"""Signals of a log of a CAN bus, as a DBC file names them."""

from __future__ import annotations

import hashlib
from collections import defaultdict
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from ev_core.parameters.data_file import SIGNALS, TEXT, open_data, read_data
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_sim.measured.records.record import Sampled

_NAMES = {"can": "python-can"}
SUFFIXES = (".log", ".asc", ".blf", ".mf4")  # candump, Vector's text and binary form, ASAM MDF


def read_columns(log: Path, database: Path, wanted: Sequence[str]) -> tuple[dict[str, Sampled], str]:
    """The signals MESSAGE.SIGNAL over the times of their frames, and the SHA-256 of the log.

    A multiplexed signal has the frames that carry it. ParameterError, in one line, if log or database cannot be read,
    if a message or signal is not in the database, or if it never came.
    """
    for package in ("can", "cantools", *(("asammdf",) if log.suffix == ".mf4" else ())):
        if find_spec(package) is None:
            raise ParameterError(f"{log} needs the Python package {_NAMES.get(package, package)}, which is missing")
    import can
    from cantools.database import load_string
    from cantools.database.can import Database

    try:
        known = load_string(read_data(database, TEXT).decode("cp1252"), "dbc")
    except OSError as error:
        raise ParameterError(f"{database}: {error.strerror or error}") from None
    except Exception as error:  # whatever the library raises for what is no database
        raise ParameterError(f"{database} is no DBC file: {' '.join(str(error).split())[:200]}") from None
    assert isinstance(known, Database)
    signals = {f"{m.name}.{s.name}": (m, s.name) for m in known.messages for s in m.signals}
    by_frame = defaultdict(list)
    for column in wanted:
        if column not in signals:
            raise unknown_name(f"signal of {database.name}", column, signals)
        by_frame[signals[column][0].frame_id, signals[column][0].is_extended_frame].append(column)
    times, values = defaultdict(list), defaultdict(list)
    try:
        with open_data(log, SIGNALS) as file:
            digest = hashlib.file_digest(file, "sha256").hexdigest()
        with can.LogReader(log) as reader:
            for frame in reader:
                of = by_frame.get((frame.arbitration_id, frame.is_extended_id))
                if not of or frame.is_error_frame or frame.is_remote_frame:
                    continue
                decoded = signals[of[0]][0].decode(bytes(frame.data), decode_choices=False)
                for column in of:
                    name = signals[column][1]
                    if name in decoded and not (times[column] and frame.timestamp <= times[column][-1]):
                        times[column].append(frame.timestamp)
                        values[column].append(float(decoded[name]))
    except OSError as error:
        raise ParameterError(f"{log}: {error.strerror or error}") from None
    except Exception as error:  # whatever the libraries raise for what is no log, or no frame of this database
        raise ParameterError(f"{log}: the log cannot be read: {' '.join(str(error).split())[:200]}") from None
    for column in wanted:
        if not times[column]:
            raise ParameterError(f"{log} has no frame with {column}")
    return {column: Sampled(np.array(times[column]), np.array(values[column])) for column in wanted}, digest
