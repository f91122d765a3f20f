"""One stroke for one name: colour and dashes of a law or run in all figures of a report."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from ev_core.methods.register import methods_of

# Okabe and Ito's colours, then those of Tol's muted scheme that are unlike them: both can be
# distinguished with every kind of colour vision. The dashes differ in grey, too, and let a curve be
# seen under another one.
HUES = (
    *("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#7F7F7F"),
    *(
        "#332288",
        "#882255",
        "#999933",
        "#117733",
        "#AA4499",
        "#CC6677",
        "#44AA99",
        "#DDCC77",
        "#661100",
    ),
)
DASHES = ("-", "--", ":", "-.")
PUBLISHED: dict[str, Any] = {"color": "black", "linestyle": ":", "linewidth": 1.4, "zorder": 3}
PART = ": "  # between the name of a result and that of a curve of it
_ROLES = ("electronic_differential", "asr")  # their laws are drawn over each other


class Stroke(NamedTuple):
    """Colour, and dashes as matplotlib takes them."""

    colour: str
    dashes: str


def stroke(number: int) -> Stroke:
    """Stroke of the n-th name: the colours one after the other, then again with other dashes."""
    again, hue = divmod(number, len(HUES))
    # Neighbours differ in dashes, and a colour that comes again has others than before.
    return Stroke(HUES[hue], DASHES[(hue + again) % len(DASHES)])


def strokes_of(labels: Iterable[str]) -> dict[str, Stroke]:
    """A stroke for each name, which labels have with blanks or underscores.

    A law has that of its place among the laws of its role, others have the first free ones. So a
    law looks the same in every figure, unless two roles meet in one report. Names beyond the number
    of strokes have the same once more. What has no name has the first stroke. Parts of one name,
    such as "pi: left" and "pi: right", have its colour and differ in dashes.
    """
    places = {
        name.replace("_", " "): place
        for role in _ROLES
        for place, name in enumerate(methods_of(role))
    }
    readable = dict.fromkeys(label.replace("_", " ") for label in labels if label)
    names = dict.fromkeys(label.partition(PART)[0] for label in readable)
    found: dict[str, Stroke] = {}
    # Laws first: they have fixed places, around which the other names find room.
    for name in sorted(names, key=lambda name: _law(name) not in places):
        taken, hues = set(found.values()), {each.colour for each in found.values()}
        of_all = [stroke(places.get(_law(name), 0) + n) for n in range(len(HUES) * len(DASHES))]
        free = [each for each in of_all if each not in taken] or of_all
        others = [each for each in free if each.colour not in hues] or free
        found[name] = (free if _law(name) in places else others)[0]
    parts = list(dict.fromkeys(label.partition(PART)[2] for label in readable if PART in label))
    strokes = {}
    for label in readable:
        name, _, part = label.partition(PART)
        strokes[label] = found[name]
        if part:
            dashes = DASHES[parts.index(part) % len(DASHES)]
            strokes[label] = Stroke(found[name].colour, dashes)
    return {**strokes, "": stroke(0)}


def _law(name: str) -> str:
    # The mark of a run with a car that has spun belongs to no law.
    return name.removesuffix(" (spun)")
