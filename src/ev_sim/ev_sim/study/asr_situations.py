"""The roads on which traction controls are compared, and how hard the driver pulls away on them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

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
