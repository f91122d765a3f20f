"""Records that the functions of the planar plant are handed in place of long lists of arguments.

Inside compiled code a NamedTuple of records costs nothing: it is taken apart before anything runs.
"""

from __future__ import annotations

from typing import NamedTuple

from ev_core.law import Car
from ev_sim.plant.planar.given import BodyConstants, PlanarParameters
from ev_sim.plant.planar.planar_state import PlanarState, Step
from ev_sim.plant.planar.prepare import PlanarConstants


class Mechanics(NamedTuple):
    """Body, wheels and tyres: all that the rates depend on, besides the integrated state."""

    p: PlanarParameters
    car: Car
    body: BodyConstants
    step: Step


class Plant(NamedTuple):
    """One object of the plant: parameters, car, constants, state, and the present step."""

    p: PlanarParameters
    car: Car
    c: PlanarConstants
    s: PlanarState
    step: Step
