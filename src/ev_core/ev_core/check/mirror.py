"""Left and right alike: a mirrored car in mirrored motion gets the mirrored answer, to the bit.

Mirrored means: values of left and right wheels are exchanged, and `lateral` quantities change their
sign. A quantity declares this at the field of its signal or at its parameter. Zero has no sign
here.
"""

import re
from collections.abc import Collection, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from ev_core.check.stepping import Subject, difference, outputs
from ev_core.lockstep.configuration import Configuration
from ev_core.parameters.declaration import Entry
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import shape_of

_SIDES = {"left": "right", "right": "left"}


def asymmetry(subject: Subject, seed: int) -> str:
    """First difference between the mirror image of a run and the run of the mirror image.

    Empty if none.
    """
    other = replace(subject, configuration=mirrored_configuration(subject.configuration))
    frames = subject.frames(seed)
    image = mirrored(outputs(subject.part(), frames))
    of_image = outputs(other.part(), mirrored(frames))
    # Zero has no sign here: adding 0 makes -0 to 0.
    found = difference(subject, image, of_image + 0.0)
    if not found:
        return ""
    what = "the mirror image and the run of the mirror image differ"
    return f"left and right are not alike: {what}, {found}"


def mirrored(frames: np.ndarray) -> np.ndarray:
    """The mirror images of frames, (..., frame.SIZE); zeros in them are positive."""
    order, sign = _in_the_mirror()
    images: np.ndarray = frames[..., order] * sign + 0.0
    return images


def mirrored_numbers(kind: type, numbers: Sequence[float]) -> list[float]:
    """The numbers of a signal in the mirror."""
    return [-numbers[i] if shape_of(kind).lateral[i] else numbers[i] for i in _order(kind)]


@cache
def _in_the_mirror() -> tuple[np.ndarray, np.ndarray]:
    """Places from which the numbers of a frame's mirror image come, and their signs."""
    order, sign = np.arange(frame.SIZE), np.ones(frame.SIZE)
    for kind, place in frame.PLACES.items():
        order[place] = [place.start + i for i in _order(kind)]
        sign[place] = mirrored_numbers(kind, [1.0] * shape_of(kind).size)
    return order, sign


def _order(kind: type) -> Sequence[int]:
    """The places of a signal from which the numbers of its mirror image come."""
    shape = shape_of(kind)
    return _exchanged(range(shape.size)) if shape.per_wheel else range(shape.size)


def _exchanged(row: Sequence[Any]) -> list[Any]:
    """A row of values by wheel, once or several times, with left and right exchanged."""
    # Left and right stand beside each other, on even and odd places.
    return [row[i ^ 1] for i in range(len(row))]


def mirrored_configuration(configuration: Configuration) -> Configuration:
    """The configuration of the mirror image: its vehicle, its parameters."""
    known = {entry.name: entry for entry in configuration.entries()}
    changed: dict[str, Any] = {}
    for name, entry in known.items():
        other = _among(known, name)
        value = _mirrored_value(entry)
        if value != known[other].default:
            changed[other] = value
    return configuration.changed(changed)


def _among(known: Collection[str], name: str) -> str:
    """The name of the other side, if it is one of the known ones, else the name itself."""
    other = _other_side(name)
    return other if other in known else name


def _other_side(text: str) -> str:
    return "".join(_SIDES.get(word, word) for word in re.split(r"([\W_]+)", text))


def _mirrored_value(entry: Entry) -> Any:
    value, spec = entry.default, entry.spec
    if spec.lateral:
        return tuple(-element for element in value) if entry.is_array else -value
    if spec.per_wheel:
        return tuple(_exchanged(value))
    # Those of wheels and sides; those of signals act behind the part that is checked.
    if entry.name == "faults":
        return tuple(map(_other_side, value))
    if entry.type is not str:
        return value
    if entry.is_array:
        return tuple(_among(spec.choices, each) for each in value)
    return _among(spec.choices, value)
