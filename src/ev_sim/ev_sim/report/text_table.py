"""Aligned columns of text."""

from __future__ import annotations

from collections.abc import Sequence


def text_table(header: Sequence[str], rows: Sequence[Sequence[str]], left: int = 1) -> str:
    """A table with its first columns to the left and the others to the right, and a line below the header."""
    widths = [max(len(row[i]) for row in (header, *rows)) for i in range(len(header))]
    sides = [str.ljust if i < left else str.rjust for i in range(len(header))]
    lines = [header, ["-" * width for width in widths], *rows]
    return "\n".join(
        "  ".join(side(cell, width) for side, cell, width in zip(sides, line, widths, strict=True)).rstrip()
        for line in lines
    )
