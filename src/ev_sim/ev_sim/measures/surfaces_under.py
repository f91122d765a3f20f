"""The surfaces that the wheels of a run have rolled on, told apart by the available friction under them."""

from __future__ import annotations

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.motion import distance_on_path
from ev_sim.measures.samples import channel
from ev_sim.recording.recording import Recording
from ev_sim.surfaces import SURFACES, tyre_on_road


def surfaces_under(run: Recording, vehicle: Vehicle, wheel: str) -> np.ndarray:
    """The surface of the table whose friction comes closest to that under the wheel, at each sample, (n,) str.

    The closest one, for a sensor may add noise. Surfaces whose friction is the same for the tyre are not told apart,
    and those of one's own are not known here.
    """
    friction = channel(run, f"tire_forces.friction_coefficient.{wheel}")
    available = np.array([tyre_on_road(vehicle.tyre, name).friction for name in SURFACES])
    return np.array(tuple(SURFACES))[np.abs(friction[:, None] - available).argmin(axis=1)]


def share_of(run: Recording, vehicle: Vehicle, wheel: str, prefix: str) -> float:
    """Share of the driven distance on which surfaces lay whose name begins so, under the wheel [1]."""
    distance = distance_on_path(run)
    if distance[-1] <= 0.0:
        raise NotMeasured("the car has not moved")
    on_it = np.char.startswith(surfaces_under(run, vehicle, wheel)[1:], prefix)
    return float(np.diff(distance)[on_it].sum() / distance[-1])
