"""The bench's database as the tests read it.

By us, by cantools, and by canmatrix, which is independent of both.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import canmatrix.formats
import cantools

from ev_bench.bus.parameters import load_database
from ev_msgs_py.can.database import Database

FILE = Path(__file__).parents[3] / "config" / "can" / "ev_bench.dbc"


@cache
def ours() -> Database:
    return load_database(str(FILE))


@cache
def by_cantools():
    return cantools.database.load_file(str(FILE))


@cache
def by_canmatrix():
    return canmatrix.formats.loadp_flat(str(FILE))
