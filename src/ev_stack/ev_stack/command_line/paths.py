"""The option --out of a command line."""

from __future__ import annotations

import argparse
from pathlib import Path


def add_out(parser: argparse.ArgumentParser, name: str = "") -> None:
    """Declare --out, the folder that a command writes into; by default one in results/NAME."""
    about = "a new or empty folder"
    if name:
        about += f"; default results/{name}/TIME, to which results/{name}/latest leads"
    parser.add_argument("--out", type=output_path, required=not name, metavar="DIR", help=about)


def output_path(text: str) -> Path:
    """Return the path that a word of the command line means, for argparse."""
    if not text.strip():  # of an unset variable of the shell: it would mean the present folder
        raise argparse.ArgumentTypeError(f"{text!r} is refused, expected a name")
    try:
        # The shell leaves ~ in --out=~/runs as it is; a folder of that name would be removed by
        # `rm -r ~` one day, and the home with it.
        return Path(text).expanduser()
    except RuntimeError:
        raise argparse.ArgumentTypeError(f"{text!r} is refused: no such home") from None
