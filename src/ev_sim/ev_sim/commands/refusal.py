"""How a command ends that cannot do what it was asked for: one line, and status 1."""

from __future__ import annotations

import sys
from typing import NoReturn

from ev_msgs_py.parameters.shown import LINE, shown


def refuse(error: BaseException | str) -> NoReturn:
    """End the process with one line about an error; of one of the system the file is named, too."""
    said = str(error)
    if isinstance(error, OSError) and error.strerror:
        said = ": ".join(str(each) for each in (error.filename, error.strerror) if each)
    sys.exit(f"error: {shown(said, LINE)}")
