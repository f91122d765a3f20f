"""The frames of a bus from a DBC file, which is read once, when a node starts."""

from __future__ import annotations

from pathlib import Path

from ev_core.parameters.data_file import TEXT, find_file, read_data
from ev_msgs_py.can.database import Database, database_of
from ev_msgs_py.refusal import ParameterError

EV_BENCH = "can/ev_bench.dbc"


def load_database(name: str = EV_BENCH) -> Database:
    """The database in a DBC file; a relative name counts from the config folder.

    ParameterError in one line that names the file if it cannot be read, or if `database_of` refuses it.
    """
    path: Path | str = name
    try:
        path = find_file(name)
        return database_of(read_data(path, TEXT))
    except OSError as error:
        raise ParameterError(f"CAN database {path}: {error.strerror or error}") from None
    except ParameterError as error:
        raise ParameterError(f"CAN database {path}: {error}") from None
