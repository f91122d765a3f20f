"""The traction controls that are compared, and the roads on which they are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ev_core.lockstep.finding import find_method
from ev_core.methods.register import methods_of, node_package
from ev_msgs_py.contract.roles import MASTER


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
    names.remove("blended_brakes")  # of the study `braking`
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


STRAIGHT, BEND = 5.0, 200.0  # lengths of a path with a bend [m]


@dataclass(frozen=True, slots=True)
class Situation:
    """A road and the drive torque of all wheels that is asked for on it within a second [N m]."""

    torque: float
    left: tuple[str, ...]
    right: tuple[str, ...] = ()  # as left
    lengths: tuple[float, ...] = ()  # of the segments [m]; the same surface everywhere without
    grade: float = 0.0  # [1]
    curvature: float = 0.0  # of the path behind the first metres [1/m]

    def values(self) -> tuple[tuple[str, str, Any], ...]:
        """What differs from the scenario's own file."""
        return (
            ("driver", "pedals.time", [0.0, 0.5, 0.7, 1.5]),
            ("driver", "pedals.drive_torque", [0.0, 0.0, 0.2 * self.torque, self.torque]),
            ("driver", "pedals.brake_torque", [1000.0, 1000.0, 0.0, 0.0]),  # holds the car on the hill
            ("plant", "road.left", list(self.left)),
            ("plant", "road.right", list(self.right or self.left)),
            ("plant", "road.grade", [self.grade]),
            *(
                [("plant", "road.pattern", "segments"), ("plant", "road.length", list(self.lengths))]
                * bool(self.lengths)
            ),
            *(
                [
                    ("driver", "path.shape", "arcs"),
                    ("driver", "path.length", [STRAIGHT, BEND]),
                    ("driver", "path.curvature", [0.0, self.curvature]),
                ]
                * bool(self.curvature)
            ),
        )


SITUATIONS = {
    "ice": Situation(3000.0, ("ice",)),
    "snow": Situation(3000.0, ("packed_snow_1",)),
    "snow 2": Situation(3000.0, ("packed_snow_2",)),
    "wet": Situation(3000.0, ("wet_asphalt_1",)),
    "dry": Situation(3600.0, ("dry_asphalt",)),
    "dry, gentle": Situation(1500.0, ("dry_asphalt",)),
    "ice left, dry right": Situation(2400.0, ("ice",), ("dry_asphalt",)),
    "snow, then dry": Situation(2600.0, ("packed_snow_1", "dry_asphalt"), lengths=(10.0,)),
    "dry, then ice": Situation(2400.0, ("dry_asphalt", "ice"), lengths=(10.0,)),
    "snow, 5 % uphill": Situation(3000.0, ("packed_snow_1",), grade=0.05),
    "snow, bend of 25 m": Situation(3000.0, ("packed_snow_1",), curvature=0.04),
}
