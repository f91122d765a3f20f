"""Bags that a recorder has left in a folder without its metadata."""

from __future__ import annotations

from pathlib import Path

from ev_msgs_py.refusal import ParameterError


def without_metadata(path: Path) -> Path:
    """The bag file in a folder that a recorder has left without metadata.yaml, else the path as it is."""
    is_whole = any((path / name).exists() for name in ("metadata.yaml", "bag", "signals.npz"))
    if not path.is_dir() or is_whole:
        return path
    files = sorted(each for each in path.iterdir() if each.suffix in (".mcap", ".db3"))
    if len(files) > 1:
        names = ", ".join(each.name for each in files)
        raise ParameterError(
            f"{path} has several bag files and no metadata.yaml, expected one of them: {names}"
        )
    return files[0] if files else path
