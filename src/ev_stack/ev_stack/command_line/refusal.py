"""End of a command that is refused: one line and status 1, or 2 for wrong words."""

from __future__ import annotations

import argparse
import sys
from typing import NoReturn

from ev_msgs_py.refusal import LINE, shown


def refuse(error: BaseException | str) -> NoReturn:
    """End the process with one line about an error.

    That of an error of the system names the file, too.
    """
    text = str(error)
    if isinstance(error, OSError) and error.strerror:
        text = ": ".join(str(each) for each in (error.filename, error.strerror) if each)
    sys.exit(f"error: {shown(text, LINE)}")


class Parser(argparse.ArgumentParser):
    """Words of a command line.

    What is wrong with them is one line of a bounded length, and nothing raw.
    """

    def error(self, message: str) -> NoReturn:
        """End the process with the usage and that line."""
        super().error(shown(message, LINE))
