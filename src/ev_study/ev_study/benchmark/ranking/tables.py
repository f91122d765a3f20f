"""Tables of a board: scores by division, where each law wins and breaks, cells and their runs."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ev_stack.report.tables import Table
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


def score_table(result: BoardResult, laws: Sequence[str]) -> Table:
    """A row for each of some laws, ranked among themselves, the best handling first."""
    places = [result.laws.index(law) for law in laws]
    scores = result.scores_among(places)
    rows = []
    for n, i in enumerate(places):
        row = [result.laws[i]]
        for each in scores.values():
            row += in_words(each[n])
        row.append(f"{100.0 * result.unstable[i].mean():.1f}")
        row.append(f"{100.0 * result.met[i].mean():.1f}")
        rows.append(row)
    # Equal ranks stay in the order of the board.
    order = sorted(range(len(rows)), key=lambda n: (scores["handling"][n].rank, n))
    return Table(SCORE_COLUMNS, [rows[n] for n in order])


def closed_division(result: BoardResult) -> list[str]:
    """Laws that differ in their controller alone, and the reference; none if fewer than two ran."""
    # One law alone is ranked against nothing.
    closed = [law for law in result.laws if law in result.board.closed]
    if len(closed) < 2:
        return []
    return [law for law in result.laws if law in closed or law == result.board.reference]


def law_table(result: BoardResult) -> Table:
    """A row for each law but the reference: shares against it, and where its handling ends."""
    reference = result.laws.index(result.board.reference)
    rows = []
    for i, law in enumerate(result.laws):
        if i != reference:
            shares = [_percent(result.improvement[cost], i, reference) for cost in COSTS]
            step = f"{1e-3 * result.step_times[law]:.2f}" if law in result.step_times else "-"
            rows.append([law, *shares, step, *_ends(result, i, reference)])
    return Table(LAW_COLUMNS, rows)


def cell_table(result: BoardResult) -> Table:
    """A row for each cell: laws with the least middle costs, and a run of the best handling."""
    rows = []
    for n, cell in enumerate(result.cells):
        row = [cell.cell.id("*")]
        best = {cost: int(np.argmin(of[:, n])) for cost, of in result.middles.items()}
        for cost, i in best.items():
            row += [result.laws[i], f"{result.middles[cost][i, n]:.2f}"]
        law = best["handling"]
        # The first draw stands for the cell.
        row.append(cell.laws[result.laws[law]].hashes[0][:DIGITS])
        row.append(result.once_more(n, law, 0))
        rows.append(row)
    return Table(CELL_COLUMNS, rows, left=len(CELL_COLUMNS))


def _ends(result: BoardResult, law: int, reference: int) -> tuple[str, str]:
    """Columns of LAW_COLUMNS."""
    names = [short_id(result, n) for n in range(len(result.places))]
    middle = result.middles["handling"]
    unstable = []
    for one, other in result.unstable[[law, reference]].sum(axis=-1).T.tolist():
        is_lost = one or other
        words = f"; unstable {one} for {other} of {result.board.draws}"
        unstable.append(words if is_lost else "")
    return ends_in_words(names, middle[law], middle[reference], unstable)


def ends_in_words(
    cells: Sequence[str], law: np.ndarray, reference: np.ndarray, unstable: Sequence[str]
) -> tuple[str, str]:
    """Cells in which a law's middle cost of handling is farthest below and above the reference's.

    "nowhere" if that is within EQUAL. `unstable` has words on the unstable runs of each cell.
    """
    more = law - reference
    best = int(np.argmin(more))
    worst = int(np.argmax(more))

    def words(n: int) -> str:
        return f"{cells[n]}: {law[n]:.2f} for {reference[n]:.2f}{unstable[n]}"

    wins = words(best) if more[best] < -EQUAL else "nowhere"
    breaks = words(worst) if more[worst] > EQUAL else "nowhere"
    return wins, breaks


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
