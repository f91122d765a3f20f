"""Tables of a board: scores by division, each law where it wins and breaks, and the cells with how to repeat them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ev_study.benchmark.board import COSTS
from ev_study.benchmark.ranking.distributions import Estimate
from ev_study.benchmark.ranking.result import BoardResult
from ev_study.benchmark.ranking.scores import Score

SCORE_COLUMNS = (
    "law",
    "handling",
    "rank",
    "worst tenth",
    "rank",
    "energy",
    "rank",
    "unstable [%]",
    "demand met [%]",
)
LAW_COLUMNS = (
    "law",
    *(f"{cost} better [%]" for cost in COSTS),
    "step [µs]",
    "wins most in",
    "breaks most in",
)
CELL_COLUMNS = (
    "cell",
    *(f"{cost}: {which}" for cost in COSTS for which in ("best", "cost")),
    "signal hash",
    "once more",
)
DIGITS = 12  # of a hash
EQUAL = 0.02  # between middle costs, within which a cell is neither won nor lost


def score_rows(result: BoardResult, laws: Sequence[str]) -> list[list[str]]:
    """A row for each of some laws below SCORE_COLUMNS, ranked among themselves, the best handling first."""
    places = [result.laws.index(law) for law in laws]
    scores = result.scores_among(places)
    rows = [
        [
            result.laws[i],
            *(text for each in scores.values() for text in in_words(each[n])),
            f"{100.0 * result.unstable[i].mean():.1f}",
            f"{100.0 * result.met[i].mean():.1f}",
        ]
        for n, i in enumerate(places)
    ]
    return [
        rows[n] for n in sorted(range(len(rows)), key=lambda n: (scores["handling"][n].rank, n))
    ]


def closed_division(result: BoardResult) -> list[str]:
    """The laws that differ in their controller alone, and the reference; none if fewer than two were driven."""
    closed = [law for law in result.laws if law in result.board.closed]
    return (
        [law for law in result.laws if law in closed or law == result.board.reference]
        if len(closed) > 1
        else []
    )


def law_rows(result: BoardResult) -> list[list[str]]:
    """A row for each law but the reference below LAW_COLUMNS: against it, and the cells with its ends of handling."""
    reference = result.laws.index(result.board.reference)
    rows = []
    for i, law in enumerate(result.laws):
        if i != reference:
            shares = [_percent(result.improvement[cost], i, reference) for cost in COSTS]
            step = f"{1e-3 * result.step_times[law]:.2f}" if law in result.step_times else "-"
            rows.append([law, *shares, step, *_ends(result, i, reference)])
    return rows


def cell_rows(result: BoardResult) -> list[list[str]]:
    """A row for each cell below CELL_COLUMNS: laws with the least middle costs, and a run of the best handling."""
    rows = []
    for n, cell in enumerate(result.cells):
        best = {cost: int(np.argmin(of[:, n])) for cost, of in result.middles.items()}
        numbers = [
            text
            for cost, i in best.items()
            for text in (result.laws[i], f"{result.middles[cost][i, n]:.2f}")
        ]
        law = best["handling"]
        signals = cell.laws[result.laws[law]].hashes[0][:DIGITS]
        rows.append([cell.cell.id("*"), *numbers, signals, result.once_more(n, law, 0)])
    return rows


def _ends(result: BoardResult, law: int, reference: int) -> tuple[str, str]:
    """Columns of LAW_COLUMNS."""
    names, middle = (
        [short_id(result, n) for n in range(len(result.places))],
        result.middles["handling"],
    )
    lost = result.unstable[[law, reference]].sum(axis=-1).T.tolist()
    unstable = [
        f"; unstable {one} for {other} of {result.board.draws}" if one or other else ""
        for one, other in lost
    ]
    return ends_in_words(names, middle[law], middle[reference], unstable)


def ends_in_words(
    cells: Sequence[str], law: np.ndarray, reference: np.ndarray, unstable: Sequence[str]
) -> tuple[str, str]:
    """The cells in which a law's middle cost of handling is farthest below and above that of the reference.

    "nowhere" if that is within EQUAL. `unstable` has words on the unstable runs of each cell.
    """
    more = law - reference
    best, worst = int(np.argmin(more)), int(np.argmax(more))
    won, lost = (
        f"{cells[n]}: {law[n]:.2f} for {reference[n]:.2f}{unstable[n]}" for n in (best, worst)
    )
    return won if more[best] < -EQUAL else "nowhere", lost if more[worst] > EQUAL else "nowhere"


def short_id(result: BoardResult, cell: int) -> str:
    """CAR:LAYOUT:MANOEUVRE:ROAD of a cell."""
    of = result.places[cell]
    return f"{of.car}:{of.manoeuvre}:{of.road}"


def _percent(of: Estimate, row: int, column: int) -> str:
    value, low, high = (100.0 * each[row, column] for each in of)
    return f"{value:.0f} [{low:.0f}, {high:.0f}]"


def in_words(score: Score) -> tuple[str, str]:
    """A score with its interval, and its rank: two columns of SCORE_COLUMNS."""
    return f"{score.value:.3f} [{score.low:.3f}, {score.high:.3f}]", str(score.rank)
