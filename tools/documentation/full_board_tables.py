"""The tables of docs/benchmark_full.md, from what the repository keeps of the full board."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import nan

import numpy as np

from documentation.full_board import kept
from documentation.markdown import code, table
from ev_study.benchmark.board import COSTS
from ev_study.benchmark.ranking.scores import Score
from ev_study.benchmark.ranking.tables import CELL_COLUMNS, SCORE_COLUMNS, ends_in_words, in_words
from ev_study.benchmark.ranking.varied import Difference

PAGE = "docs/benchmark_full.md"
IMAGE = "benchmark_full"
SHARES = ("unstable", "demand_met")  # of runs, and of the demand


def scores() -> str:
    """All laws with their ranks, the best handling first."""
    rows = []
    for law, of in kept()["scores"].items():
        found = [of[name] for name in ("handling", "worst tenth", "energy")]
        texts = [text for each in found for text in in_words(Score(**each))]
        place = found[0]["rank"], found[0]["value"]
        rows.append(
            (
                place,
                [code(law), *texts, *(f"{100.0 * of[name]:.1f}" for name in SHARES if name in of)],
            )
        )
    rows.sort(key=lambda row: row[0])
    count = len(kept()["cells"]) * len(kept()["laws"]) * kept()["draws"]
    driven = (
        f"Version {kept()['version']}: {len(kept()['cells'])} cells, {kept()['draws']} draws,"
        f" {count} runs, {kept()['runs_driven']} with those of the searches; hash of all runs"
        f" `{kept()['hash']}`."
    )
    best = kept()["best of each run"]
    bound = (
        "With the best law of each run, handling and energy apart: handling"
        f" {best['handling']:.3f}, worst tenth {best['worst tenth']:.3f}, energy"
        f" {best['energy']:.3f}, unstable {100.0 * best['unstable']:.1f} %."
    )
    columns = SCORE_COLUMNS[: len(rows[0][1])]  # version 5 had no demand
    return f"{table(columns, [texts for _, texts in rows])}\n{bound}\n\n{driven}\n"


def recorded() -> str:
    """Medians of what counts in no cost."""
    names = list(next(iter(kept()["recorded"].values())))
    rows = [
        [code(law), *(_shown(of[name], ".3g") for name in names)]
        for law, of in kept()["recorded"].items()
    ]
    return table(("law", *names), rows)


def by_car() -> str:
    """Of each law the middle cost of handling, and the unstable runs, by car."""
    return _by("handling", _parts_of_cells(slice(0, 2)), with_unstable=True)


def handling_by_manoeuvre() -> str:
    """Of each law the middle cost of handling."""
    return _by("handling", _parts_of_cells(slice(2, 3)))


def energy_by_manoeuvre() -> str:
    """Of each law the middle cost of energy, of the manoeuvres that have one."""
    counted = [
        name
        for name in _parts_of_cells(slice(2, 3))
        if set(kept()["where"][name]["energy"]) != {1.0}
    ]
    return _by("energy", counted)


def handling_by_variation() -> str:
    """Of each law by how much the mean cost of handling is higher at the greater end of what varies."""
    return _by_variation("handling", 1.0, 3)


def unstable_by_variation() -> str:
    """Likewise of unstable runs, in points of a percentage."""
    return _by_variation("unstable", 100.0, 1)


def ends() -> str:
    """Of each law the cells in which its middle cost of handling is farthest below and above that of the reference."""
    cells, rows, reference = kept()["cells"], [], kept()["laws"].index("equal_torque")
    names = [cell.rpartition(":*")[0] for cell in cells]
    middle = np.array([of["handling"] for of in cells.values()]).T
    lost = 100.0 * np.array([of["unstable"] for of in cells.values()]).T
    for i, law in enumerate(kept()["laws"]):
        if i != reference:
            pairs = lost[[i, reference]].T
            unstable = [
                f"; unstable {one:.0f} for {other:.0f} %" if max(one, other) >= 0.5 else ""
                for one, other in pairs
            ]
            rows.append([code(law), *ends_in_words(names, middle[i], middle[reference], unstable)])
    return table(("law", "wins most in", "breaks most in"), rows)


def entry_speeds() -> str:
    """Medians of the highest clean entry speed of the double lane change [m/s]."""
    return _medians_by_car("double_lane_change", "entry_speed", ".1f")


def lap_times() -> str:
    """Medians of the time of a lap at the highest clean scale [s]."""
    return _medians_by_car("lap", "lap_time", ".1f")


def times_75() -> str:
    """Medians of the time of 75 m from rest [s]."""
    return _medians_by_car("acceleration_75", "time_75", ".1f")


def cells() -> str:
    """The best laws of each cell, and how a run of it is driven again."""
    rows = []
    for cell, of in kept()["cells"].items():
        best = [int(np.argmin(of[cost])) for cost in COSTS]
        numbers = [
            text
            for cost, i in zip(COSTS, best, strict=True)
            for text in (kept()["laws"][i], f"{of[cost][i]:.2f}")
        ]
        again = (
            f"scripts/run.sh benchmark full --cells '{cell}' --drive {kept()['laws'][best[0]]}:0"
        )
        rows.append([code(cell), *numbers, code(of["hashes"][best[0]]), code(again)])
    return table(CELL_COLUMNS, rows)


def _parts_of_cells(part: slice) -> list[str]:
    return list(dict.fromkeys(":".join(cell.split(":")[part]) for cell in kept()["cells"]))


def _by(cost: str, names: Sequence[str], with_unstable: bool = False) -> str:
    where, rows = kept()["where"], []
    for i, law in enumerate(kept()["laws"]):
        texts = [f"{where[name][cost][i]:.2f}" for name in names]
        if with_unstable:
            texts = [
                f"{text}; {100.0 * where[n]['unstable'][i]:.1f} %"
                for text, n in zip(texts, names, strict=True)
            ]
        rows.append([code(law), *texts])
    return table(("law", *names), rows)


def _by_variation(name: str, scale: float, digits: int) -> str:
    """A row for each law, a column for each variation, with the least and the most of what is drawn in the head."""
    varied, rows = kept()["varied"], []
    heads = [f"{code(variation)}: {' / '.join(of['drawn'])}" for variation, of in varied.items()]
    for i, law in enumerate(kept()["laws"]):
        pairs = [[nan if each is None else each for each in of[name][i]] for of in varied.values()]
        rows.append([code(law), *(Difference(*pair).in_words(scale, digits) for pair in pairs)])
    return table(("law", *heads), rows)


def _medians_by_car(manoeuvre: str, metric: str, form: str) -> str:
    """A row for each law, a column for each car, with a number for each road in the order of the board."""
    found: dict[str, dict[str, list[float | None]]] = {}
    for cell, of in kept()["cells"].items():
        car, road = cell.split(":")[0], cell.split(":")[3]
        if cell.split(":")[2] == manoeuvre:
            found.setdefault(car, {})[road] = of["medians"][metric]
    rows = [
        [
            code(law),
            *(" / ".join(_shown(of[i], form) for of in roads.values()) for roads in found.values()),
        ]
        for i, law in enumerate(kept()["laws"])
    ]
    roads = " / ".join(next(iter(found.values())))
    return table((f"law ({roads})", *found), rows)


def _shown(value: float | None, form: str) -> str:
    return "-" if value is None else f"{value:{form}}"


SCORES = "full scores"  # the part that the page keeps
BUILT: dict[str, Callable[[], str]] = {
    "full by car": by_car,
    "full handling by manoeuvre": handling_by_manoeuvre,
    "full energy by manoeuvre": energy_by_manoeuvre,
    "full unstable by variation": unstable_by_variation,
    "full handling by variation": handling_by_variation,
    "full entry speeds": entry_speeds,
    "full lap times": lap_times,
    "full times of 75 m": times_75,
    "full ends": ends,
    "full recorded": recorded,
    "full cells": cells,
}
