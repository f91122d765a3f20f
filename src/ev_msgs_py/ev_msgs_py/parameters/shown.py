"""What comes from outside, such as a value, a name in the graph or a line of a log, as it may be shown to somebody."""

from __future__ import annotations

from typing import Any

LONGEST = 200  # characters
LINE = 1000  # of a line about several things, which may each have that length


def shown(text: Any, longest: int = LONGEST) -> str:
    """A text on one line of so many characters at most, control characters as text: a terminal obeys none of them."""
    words = str(text)
    cut = words if len(words) <= longest else f"{words[: longest // 2]} ... {words[-longest // 4 :]}"
    return "".join(each if each.isprintable() else each.encode("unicode_escape").decode() for each in cut)[:longest]


def quoted(value: Any) -> str:
    """A value as Python writes it, in the same bounds."""
    return shown(_repr(value))


def _repr(value: Any) -> str:
    try:
        return repr(value)
    except (ValueError, RecursionError):  # a whole number of thousands of digits, or what holds itself
        return f"some {type(value).__name__}"
