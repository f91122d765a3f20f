"""Folders on a command line, as types of argparse."""

from __future__ import annotations

import argparse
from pathlib import Path


def output_folder(text: str) -> Path:
    """Return the folder of this name, which need not exist; an empty name is refused, as that of an unset variable."""
    if not text.strip():
        raise argparse.ArgumentTypeError(f"{text!r} is refused, expected the name of a folder")
    path = Path(text)
    if path.exists() and not path.is_dir():
        raise argparse.ArgumentTypeError(f"{text!r} is no folder, expected the name of a folder")
    return path
