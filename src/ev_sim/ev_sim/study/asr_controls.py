"""The traction controls that are compared: every method, and variants of some by their parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.lockstep.methods import find_method, methods_of, node_package


@dataclass(frozen=True, slots=True)
class Variant:
    """A method of the role asr with other parameters than its own."""

    method: str
    values: tuple[tuple[str, Any], ...]


VARIANTS = {
    "least_squares_error_bound": Variant("least_squares", (("largest_error", 0.001),)),
    "least_squares_square": Variant("least_squares", (("template", "square"),)),
    "maximum_transmissible_torque_always": Variant("maximum_transmissible_torque", (("limits", "always"),)),
    "slip_window_side_force": Variant("slip_window", (("side_force.correction", "ellipse"),)),
}


def controls() -> list[str]:
    """All traction controls of the package that brings the node, and the variants, none first."""
    names = [name for name, method in methods_of("asr").items() if method.package == node_package("asr")]
    names.remove("limp_home")  # does nothing about slip
    return sorted((*names, *VARIANTS), key=lambda name: (name != "off", name))


def values_of(control: str) -> tuple[tuple[str, str, Any], ...]:
    """What a control is told, and the plant if it needs a certain one: (node, parameter, value)."""
    variant = VARIANTS.get(control, Variant(control, ()))
    plant = find_method("asr", variant.method).requires.get(MASTER)
    return (
        ("asr", "method", variant.method),
        *(("asr", parameter, value) for parameter, value in variant.values),
        *(((MASTER, "method", plant),) if plant else ()),
    )
