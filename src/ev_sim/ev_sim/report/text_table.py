"""Aligned columns of text."""

from __future__ import annotations

from collections.abc import Collection, Sequence


def text_table(columns: Sequence[str], rows: Sequence[Sequence[str]], left: Collection[str]) -> str:
    """A table with a line below the names of its columns; those in `left` are set to the left, numbers to the right."""
    widths = [max(len(row[i]) for row in (columns, *rows)) for i in range(len(columns))]
    sides = [str.ljust if column in left else str.rjust for column in columns]
    lines = [columns, ["-" * width for width in widths], *rows]
    return "\n".join(
        "  ".join(side(cell, width) for side, cell, width in zip(sides, line, widths, strict=True)).rstrip()
        for line in lines
    )
