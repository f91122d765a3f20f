"""The option --out of a command line."""

from __future__ import annotations

import argparse
from pathlib import Path


def add_out(parser: argparse.ArgumentParser, name: str = "") -> None:
    """Declare --out, the folder that a command writes into; by default one in results/NAME."""
    about = "a new or empty folder"
    if name:
        about += f"; default results/{name}/TIME, to which results/{name}/latest leads"
    parser.add_argument("--out", type=_folder, required=not name, metavar="DIR", help=about)


def _folder(text: str) -> Path:
    if not text.strip():  # of an unset variable of the shell: it would mean the present folder
        raise argparse.ArgumentTypeError(f"{text!r} is refused, expected the name of a folder")
    return Path(text)
