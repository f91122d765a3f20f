"""What noise makes of the traction controls, mean and spread over seeds; and dry asphalt's own slip as target."""

from __future__ import annotations

import argparse
from collections.abc import Mapping

import numpy as np

from documentation.markdown import code, table
from ev_sim.surfaces import SURFACES
from ev_sim.tyres.curve import peak_slip
from ev_stack.batches.batch import batch
from ev_stack.batches.observer import last, mean
from ev_study.studies import asr_shootout
from ev_study.studies.study import run_of

ROADS = ("ice", "snow", "wet", "dry", "ice left, dry right")
WITH_TARGET = ("feedback_linearisation", "fuzzy", "modified_lambda", "pi_slip")
SEEDS = range(8)


def seed_tables(roads: tuple[str, ...] = ROADS, controls: tuple[str, ...] = ()) -> str:
    """Distance [m] and mean slip [1] of each control on each road: mean and standard deviation over the seeds."""
    names = controls or tuple(asr_shootout.controls())
    rows: dict[str, dict[str, tuple[np.ndarray, np.ndarray]]] = {name: {} for name in names}
    for road in roads:
        for name in names:
            rows[name][road] = _over_seeds(road, name)
        for name in WITH_TARGET:
            if road == "dry" and name in names:
                tuned = f"{name}, target {dry_target():.2f}"
                rows.setdefault(tuned, {})[road] = _over_seeds(road, name, dry_target())
    return "\n".join(
        _table(quantity, digits, k, rows, roads) for k, (quantity, digits) in enumerate(QUANTITIES)
    )


QUANTITIES = (("distance [m]", 1), ("mean slip", 3))


def dry_target() -> float:
    """Slip of the peak of dry asphalt [1], as the laws count it, 1 - w_free/w."""
    dry = SURFACES["dry_asphalt"]
    return round(peak_slip("burckhardt", (dry.c1, dry.c2, dry.c3, 0.0)), 2)


def _over_seeds(road: str, control: str, target: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Distance and mean slip of the left driven wheel, for each seed."""
    (case,) = asr_shootout.cases(argparse.Namespace(controls=[control], roads=[road]))
    run = run_of(case)
    of = dict(run.configurations)
    if target:
        of["asr"] = of["asr"].changed({"regulator.target": target})
    metrics = {"distance": last("pose.x"), "slip": mean("tire_forces.slip_ratio.front_left")}
    found = batch(of, run.duration, {"*.seed": SEEDS}, metrics=metrics).metrics
    return found["distance"], found["slip"]


def _table(
    quantity: str,
    digits: int,
    k: int,
    rows: Mapping[str, Mapping[str, tuple[np.ndarray, ...]]],
    roads: tuple[str, ...],
) -> str:
    def cell(of: Mapping[str, tuple[np.ndarray, ...]], road: str) -> str:
        return (
            f"{of[road][k].mean():.{digits}f} ± {of[road][k].std(ddof=1):.{digits}f}"
            if road in of
            else "–"
        )

    header = (quantity, *roads)
    return table(
        header, [(code(name), *(cell(of, road) for road in roads)) for name, of in rows.items()]
    )
