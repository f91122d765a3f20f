"""What comes from outside, such as a value, a name in the graph or a line of a log, as it may be shown to somebody."""

from __future__ import annotations

from typing import Any

LONGEST = 200  # characters


def shown(text: Any) -> str:
    """A text of at most `LONGEST` characters on one line, control characters as text: a terminal obeys none of them."""
    words = str(text)
    cut = words if len(words) <= LONGEST else f"{words[: LONGEST // 2]} ... {words[-LONGEST // 4 :]}"
    return "".join(each if each.isprintable() else each.encode("unicode_escape").decode() for each in cut)[:LONGEST]


def quoted(value: Any) -> str:
    """A value as Python writes it, in the same bounds."""
    return shown(_repr(value))


def _repr(value: Any) -> str:
    try:
        return repr(value)
    except (ValueError, RecursionError):  # a whole number of thousands of digits, or what holds itself
        return f"some {type(value).__name__}"
