"""Refusals in one line, and values, names and lines from outside as they are shown."""

import difflib
from collections.abc import Iterable, Mapping
from typing import Any

LONGEST = 200  # characters
_SHOWN = 12  # names that are listed at most
LINE = 1000  # of a line about several things, which may each have that length

# What would make two lines of one, such as a line break in the name of a file.
_BREAKS = {ord(each): repr(each)[1:-1] for each in "\0\n\r\v\f\x1c\x1d\x1e\x85\u2028\u2029"}


def shown(text: Any, longest: int = LONGEST) -> str:
    """Text on one line of so many characters at most, with control characters as text."""
    words = str(text)
    cut = (
        words if len(words) <= longest else f"{words[: longest // 2]} ... {words[-longest // 4 :]}"
    )
    return "".join(
        each if each.isprintable() else each.encode("unicode_escape").decode() for each in cut
    )[:longest]


def quoted(value: Any) -> str:
    """A value as Python writes it, in the same bounds."""
    return shown(_repr(value))


def first_line(error: Exception) -> str:
    """Message of a library about a file, in the same bounds, without lines of its content."""
    return str(error).partition("\n")[0][:LONGEST]


def _repr(value: Any) -> str:
    try:
        return repr(value)
    except (ValueError, RecursionError):
        # A whole number of thousands of digits, or what holds itself.
        return f"some {type(value).__name__}"


class ParameterError(ValueError):
    """Refusal of a parameter; the message names it, the value and what is expected.

    `parameter` is its dotted name where there is one.
    """

    def __init__(self, text: str, parameter: str = "") -> None:
        super().__init__(text.translate(_BREAKS))
        self.parameter = parameter

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (str(self), self.parameter)


def unknown_name(kind: str, name: Any, known: Iterable[str]) -> ParameterError:
    """Error for a name that does not exist; it proposes similar ones, or lists the few known.

    Similar are also names with this one in them. Of many of which none is similar it lists the
    first.
    """
    known, text = sorted(known), str(name)
    similar = (
        difflib.get_close_matches(text, known, n=3)
        or [each for each in known if len(text) > 2 and text in each][:3]
    )
    meant = f"did you mean {', '.join(similar)}?" if similar else ""
    more = f" and {len(known) - _SHOWN} more" if len(known) > _SHOWN else ""
    listed = "" if similar and more else f"known: {', '.join(known[:_SHOWN])}{more}"
    return ParameterError(
        f"unknown {kind} {quoted(name)}; {' '.join(filter(None, (meant, listed)))}", name
    )


class UnknownNameError(ParameterError, KeyError):
    """Refusal of a name that a mapping lacks; a KeyError, as Python has it, in one line of ours."""

    __str__ = ValueError.__str__  # a KeyError would show the line as a quoted text


class Named(dict[str, Any]):
    """Mapping of things of a kind by name, which proposes similar names for one that it lacks."""

    def __init__(self, kind: str, things: Mapping[str, Any]) -> None:
        super().__init__(things)
        self._kind = kind

    def __missing__(self, name: Any) -> Any:
        raise UnknownNameError(str(unknown_name(self._kind, name, self)), str(name))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._kind, dict(self))
