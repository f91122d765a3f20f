"""What the channels of a CAN bus have carried in a lockstep run."""

from __future__ import annotations

import numpy as np

from ev_core.bus.parameters import CIRCUITS
from ev_sim.measures.metric import Metric
from ev_sim.recording.recording import Recording


def metrics(run: Recording) -> dict[str, Metric]:
    """Of each channel mean load, longest latency, its jitter from period to period, frames lost; none without a bus."""
    found = {}
    for circuit in CIRCUITS if f"can.bus.load_{CIRCUITS[0]}" in run.channels else ():
        load, latency, lost = (run.channels[f"can.bus.{what}_{circuit}"] for what in ("load", "latency", "lost"))
        carried = latency[latency > 0.0]
        found[f"bus_{circuit}_load"] = Metric(float(load[1:].mean()) if len(load) > 1 else 0.0, "1")
        found[f"bus_{circuit}_longest_latency"] = Metric(float(latency.max()), "s")
        found[f"bus_{circuit}_latency_jitter"] = Metric(float(np.ptp(carried)) if len(carried) else 0.0, "s")
        found[f"bus_{circuit}_lost_frames"] = Metric(float(lost[-1]), "1")
    return found
