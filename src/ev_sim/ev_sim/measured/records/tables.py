"""Columns of CSV files, packed or not."""

from __future__ import annotations

import hashlib
import lzma
from pathlib import Path

import numpy as np

from ev_core.parameters.data_file import MEGABYTE, SIGNALS, read_data
from ev_msgs_py.refusal import ParameterError


def read_columns(path: Path) -> tuple[dict[str, np.ndarray], str]:
    """The columns of a CSV file, by name, and its SHA-256; .csv.xz is unpacked. ParameterError, in one line, if not."""
    try:
        content = read_data(path, SIGNALS)
        text = lzma.LZMADecompressor().decompress(content, SIGNALS) if path.suffix == ".xz" else content
        header, *lines = text.decode("utf-8-sig").splitlines() or [""]
        names = [cell.strip() for cell in header.split(",")]
        rows = np.genfromtxt(lines, delimiter=",", ndmin=2) if any(map(str.strip, lines)) else np.empty((0, len(names)))
    except OSError as error:
        raise ParameterError(f"{path}: {error.strerror or error}") from None
    except (lzma.LZMAError, ValueError, UnicodeDecodeError) as error:
        reason = " ".join(str(error).split())[:200]
        raise ParameterError(f"{path} is no CSV table of at most {SIGNALS // MEGABYTE} MB: {reason}") from None
    if rows.shape[1] != len(names) or len(set(names)) < len(names):
        raise ParameterError(f"{path}: the header names {len(names)} columns, the rows have {rows.shape[1]}")
    return dict(zip(names, rows.T, strict=True)), hashlib.sha256(content).hexdigest()
