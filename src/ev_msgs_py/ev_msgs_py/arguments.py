"""Arguments of public functions: `checked` holds them against the annotations of the function.

How it works: a function with `checked` above it looks at each argument before anything else is
done. An annotation may have words of its own for what is expected, as
`Annotated[Mapping[str, str], "{NODE: METHOD}"]`; else the words follow from the kind.
"""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache, wraps
from numbers import Integral, Real
from os import PathLike
from types import SimpleNamespace, UnionType
from typing import (
    Annotated,
    Any,
    Literal,
    TypeVar,
    Union,
    Unpack,
    cast,
    get_args,
    get_origin,
    get_type_hints,
)

import numpy as np

from ev_msgs_py.refusal import ParameterError, quoted, unknown_name

C = TypeVar("C", bound=Callable[..., Any])
# An int is a number and True is an int to Python; numbers of numpy count as well.
_NUMBERS: dict[Any, Any] = {bool: (bool, np.bool_), int: Integral, float: Real}
_OF_ANYTHING = (Any, Any)  # what is in a mapping or a list without a kind
_PLAIN = {bool, int, float, str}
_WORDS = {
    bool: "True or False",
    int: "a whole number",
    float: "a number",
    str: "a text",
    PathLike: "a path",
    Callable: "a function",
}


def checked(call: C) -> C:
    """Refuse arguments of another kind than their annotations, before the call begins.

    ParameterError in one line with what was given and what is expected; TypeError for a keyword
    that is none. `**changes: Unpack[KEYWORDS]` stands for the keywords of a TypedDict, which help
    and notebooks show in the signature.
    """
    shown = _listing_keywords(call)
    by_place = []
    by_name = []
    further = ""
    takes_any = False
    for each in shown.parameters.values():
        if each.kind is each.VAR_KEYWORD:
            takes_any = True
        elif each.kind is each.VAR_POSITIONAL:
            further = each.name
        else:
            by_name.append(each.name)
            if each.kind is not each.KEYWORD_ONLY:
                by_place.append(each.name)

    @cache
    def kinds() -> dict[str, Any]:
        # Not before the first call: an annotation may name a class that is being defined.
        return {**_kinds(call, call.__annotations__), **_listed(call)}

    def refusing(*given: Any, **named: Any) -> Any:
        if not takes_any:
            for name in named:
                if name not in by_name:
                    expected = [each for each in by_name if each != "self"]
                    raise TypeError(str(unknown_name("keyword", name, expected)))
        placed = zip(by_place, given, strict=False)
        values = [_taken(name, value, kinds()) for name, value in placed]
        # Python refuses what is beyond the last argument.
        values += [_taken(further, value, kinds()) for value in given[len(by_place) :]]
        return call(*values, **{name: _taken(name, named[name], kinds()) for name in named})

    found: Any = wraps(call)(refusing)
    # help and notebooks read __signature__ before they look at the function itself.
    found.__signature__ = shown
    return cast(C, found)


def _kinds(call: Any, annotations: Mapping[str, Any]) -> dict[str, Any]:
    """The annotations as types; what is given back may have one that is not imported."""
    given = {name: each for name, each in annotations.items() if name != "return"}
    known = vars(sys.modules[call.__module__])
    return get_type_hints(SimpleNamespace(__annotations__=given), known, None, True)


def _listed(call: Any) -> dict[str, Any]:
    """Keywords and kinds of the TypedDict that `**NAME: Unpack[KEYWORDS]` stands for."""
    for each in inspect.signature(call).parameters.values():
        if each.kind is each.VAR_KEYWORD:
            (kind,) = _kinds(call, {each.name: each.annotation}).values()
            if get_origin(kind) is Unpack:
                return get_type_hints(get_args(kind)[0], include_extras=True)
    return {}


def _listing_keywords(call: Any) -> inspect.Signature:
    """The signature, with these keywords in the place of the one that stands for them."""
    signature = inspect.signature(call)
    listed = _listed(call)
    if not listed:
        return signature
    own = [each for each in signature.parameters.values() if each.kind is not each.VAR_KEYWORD]
    keywords = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=kind)
        for name, kind in listed.items()
    ]
    return signature.replace(parameters=[*own, *keywords])


def _taken(name: str, value: Any, kinds: Mapping[str, Any]) -> Any:
    """The argument as it is passed on; ParameterError if its kind is not that of its name."""
    if name not in kinds:
        return value
    if isinstance(value, Iterator):
        # It can be read only once: for the check and the call it is kept.
        value = tuple(value)
    if line := refusal(name, value, kinds[name]):
        raise ParameterError(line, name)
    return value


def refusal(place: str, value: Any, kind: Any) -> str:
    """The line that refuses a value at a place for its kind; empty if it has that kind."""
    # Most arguments end here, but not NaN: there are thousands of declarations, and a loop of
    # one's own gives channels in every step.
    if type(value) in _plain_classes(kind) and value == value:
        return ""
    expected = ""
    if get_origin(kind) is Annotated:
        kind, expected = get_args(kind)[:2]
    union = get_args(kind) if get_origin(kind) in (Union, UnionType) else (kind,)
    if value is None and type(None) in union:
        return ""
    kinds = [each for each in union if each is not type(None)]
    lines = [_refusal_of_one(place, value, each) for each in kinds]
    if not all(lines):
        return ""
    # The part of a mapping or of a list that is wrong is named where only one kind can be meant.
    if len(lines) == 1 and not expected:
        return lines[0]
    return _line(place, value, expected or " or ".join(map(_words, kinds)))


@cache
def _plain_classes(kind: Any) -> frozenset[type]:
    """Classes of numbers and texts of which every object but NaN has a kind."""
    if get_origin(kind) is Annotated:
        return _plain_classes(get_args(kind)[0])
    if get_origin(kind) in (Union, UnionType):
        return frozenset().union(*map(_plain_classes, get_args(kind)))
    return frozenset({kind} & _PLAIN)


def _line(place: str, value: Any, expected: str) -> str:
    return f"{place}: {quoted(value)} is refused, expected {expected}"


def _refusal_of_one(place: str, value: Any, kind: Any) -> str:
    """The same for one kind that is no union."""
    of = get_origin(kind) or kind
    parts = get_args(kind) or _OF_ANYTHING
    if of is dict:
        of = Mapping
    if of is Any or isinstance(of, TypeVar):
        return ""
    if of is Literal:
        # What is no text may compare in ways of its own, as an array does.
        is_one = isinstance(value, str) and value in parts
        return "" if is_one else _line(place, value, _words(kind))
    if not _is_of(value, of):
        such = _such_as(value, kind)
        return _line(place, value, _words(kind) + such)
    if of is Mapping:
        for key, each in value.items():
            if refusal("", key, parts[0]):
                return refusal(f"{place}, a name", key, parts[0])
            # The place is written only where it is needed: a simulation checks at every step.
            if refusal("", each, parts[1]):
                return refusal(f"{place}[{quoted(key)}]", each, parts[1])
    elif of in (Sequence, Iterable) and parts[0] is not Any:
        for number, each in enumerate(value):
            if refusal("", each, parts[0]):
                return refusal(f"{place}[{number}]", each, parts[0])
    return ""


def _is_of(value: Any, of: Any) -> bool:
    """Mark of a value of a class, or of a kind of the annotations."""
    if of in (Sequence, Iterable):
        # A text is a list of its letters to Python, and none is meant by it.
        is_list = isinstance(value, Iterable) and not isinstance(value, str | bytes | Mapping)
        return is_list and np.ndim(value) > 0 if isinstance(value, np.ndarray) else is_list
    if of is Callable:
        return callable(value)
    if of is float or of is int:
        return (
            isinstance(value, _NUMBERS[of])
            and not isinstance(value, _NUMBERS[bool])
            # NaN is a float that is no number; whether infinity is one is a matter of ranges.
            and value == value
        )
    return isinstance(value, _NUMBERS.get(of, of))


def _words(kind: Any) -> str:
    """Words for what a kind expects."""
    if get_origin(kind) is Annotated:
        return str(get_args(kind)[1])
    of = get_origin(kind) or kind
    parts = get_args(kind) or _OF_ANYTHING
    if of in (Union, UnionType):
        return " or ".join(_words(each) for each in parts if each is not type(None))
    if of is Literal:
        return " or ".join(map(str, parts))
    if of in (Mapping, dict):
        return f"a mapping from {_several(parts[0])} to {_several(parts[1])}"
    if of in (Sequence, Iterable):
        return f"a list of {_several(parts[0])}"
    return _WORDS.get(of) or f"a {of.__name__}"


def _several(kind: Any) -> str:
    """The words for several of a kind."""
    if kind is Any:
        return "values"
    plural = []
    for each in _words(kind).split(" or "):
        plural.append(f"{each[2:]}s" if each.startswith("a ") else each)
    return " or ".join(plural)


def _such_as(value: Any, kind: Any) -> str:
    """The list that is meant where one of its elements is given; empty if it is none."""
    if get_origin(kind) not in (Sequence, Iterable) or isinstance(value, bytes | Mapping):
        return ""
    return "" if refusal("", value, get_args(kind)[0]) else f", such as [{quoted(value)}]"
