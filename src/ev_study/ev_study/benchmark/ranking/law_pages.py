"""A board in Markdown: its scores, and a page of each law: where and by what it wins and breaks, what it is made of."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from ev_stack.report.tables import markdown_table
from ev_study.benchmark.board import COSTS, Cell
from ev_study.benchmark.ranking.drawing import undominated
from ev_study.benchmark.ranking.result import BoardResult
from ev_study.benchmark.ranking.scores import interquartile_mean, tail_mean
from ev_study.benchmark.ranking.tables import score_table, short_id

PART_COLUMNS = ("where", "handling", "worst tenth", "energy", "unstable [%]", "best law there")
VARIED_COLUMNS = ("what varies", "least", "most", "mean handling", "unstable [points]")
CELL_COLUMNS = ("cell", "handling", "energy", "unstable [%]", "once more, its worst draw")
ENDS = 3  # cells shown at each end
_GROUPS: tuple[Callable[[Cell], str], ...] = (
    lambda cell: cell.car,
    lambda cell: cell.manoeuvre,
    lambda cell: cell.road,
)


def overview(result: BoardResult) -> str:
    """The scores of all laws, and the medians of what is recorded beside them, over all runs that have it."""
    scores = score_table(result, result.laws)
    tables = [markdown_table(scores.columns, scores.rows)]
    if recorded := result.recorded:
        rows = [
            [law, *(f"{of[i]:.3g}" for of in recorded.values())]
            for i, law in enumerate(result.laws)
        ]
        tables += ["Medians of what counts in no cost:", markdown_table(("law", *recorded), rows)]
    return "\n\n".join(each.strip() for each in tables) + "\n"


def law_page(result: BoardResult, law: str, level: int = 2) -> str:
    """Scores, the same by car, manoeuvre and road, the best and the worst cells, neighbours on the Pareto front."""
    i = result.laws.index(law)
    stated = ", ".join(f"`{name}: {value}`" for name, value in result.board.laws[law].items())
    parts = [
        f"{'#' * level} {law}",
        f"{stated}.",
        _in_words(result, i),
        markdown_table(PART_COLUMNS, list(_parts(result, i))),
        (
            "By how much runs with the most of what varies cost more, and are more unstable, than"
            " with the least:"
        ),
        markdown_table(VARIED_COLUMNS, list(_varied(result, i))),
        (
            "The cells with the least and the largest middle cost of handling beside"
            f" `{result.board.reference}`:"
        ),
        markdown_table(CELL_COLUMNS, list(_ends(result, i))),
    ]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def _in_words(result: BoardResult, i: int) -> str:
    scores = {of: each[i] for of, each in result.scores.items()}
    texts = [
        f"{of} {each.value:.3f} [{each.low:.3f}, {each.high:.3f}] (rank {each.rank})"
        for of, each in scores.items()
    ]
    unstable = f"{100.0 * result.unstable[i].mean():.1f} % of the runs are unstable"
    return f"Of {len(result.laws)} laws: {', '.join(texts)}; {unstable}. {_on_the_front(result, i)}"


def _on_the_front(result: BoardResult, i: int) -> str:
    """Name the laws that are better in both handling and energy; on the front those next to it."""
    points = np.array(
        [[result.scores[of][n].value for of in COSTS] for n in range(len(result.laws))]
    )
    front = undominated(points)
    if i not in front:
        # Some law on the front is better in both: that is what being off the front means.
        better = [n for n in front if (points[n] <= points[i]).all()]
        return f"Better in handling and energy: {_names(result, better)}."
    front.sort(key=lambda n: points[n, 0])
    place = front.index(i)
    beside = [
        (word, front[n])
        for word, n in (("handling", place - 1), ("energy", place + 1))
        if 0 <= n < len(front)
    ]
    texts = [f"with better {word} comes {_names(result, [n])}" for word, n in beside]
    return f"No law is better in both handling and energy{''.join(f'; {text}' for text in texts)}."


def _parts(result: BoardResult, i: int) -> Iterator[list[str]]:
    for group in _GROUPS:
        for name in dict.fromkeys(group(each) for each in result.places):
            places = [n for n, each in enumerate(result.places) if group(each) == name]
            handling, energy = (
                result.costs[of][:, places].reshape(len(result.laws), -1)
                for of in ("handling", "energy")
            )
            best = int(np.argmin(interquartile_mean(handling)))
            numbers = (
                interquartile_mean(handling[i]),
                tail_mean(handling[i]),
                interquartile_mean(energy[i]),
            )
            unstable = 100.0 * result.unstable[i][places].mean()
            yield [name, *(f"{each:.2f}" for each in numbers), f"{unstable:.1f}", result.laws[best]]


def _varied(result: BoardResult, i: int) -> Iterator[list[str]]:
    for name, of in result.varied.items():
        handling, unstable = of.differences["handling"][i], of.differences["unstable"][i]
        yield [
            f"`{name}`",
            of.least,
            of.most,
            handling.in_words(1.0, 2),
            unstable.in_words(100.0, 1),
        ]


def _ends(result: BoardResult, i: int) -> Iterator[list[str]]:
    reference = result.laws.index(result.board.reference)
    middle = result.middles["handling"]
    # Against the reference: a cell that is dear for all laws shows nothing of this one.
    order = np.argsort(middle[i] - middle[reference], kind="stable")
    # Both ends show different cells, also of a board with few of them.
    count = min(ENDS, len(order) // 2) or 1
    for n in dict.fromkeys((*order[:count].tolist(), *order[-count:].tolist())):
        worst = int(np.argmax(result.costs["handling"][i, n]))
        yield [
            short_id(result, n),
            f"{middle[i, n]:.2f}",
            f"{result.middles['energy'][i, n]:.2f}",
            f"{100.0 * result.unstable[i, n].mean():.0f}",
            f"`{result.once_more(n, i, worst)}`",
        ]


def _names(result: BoardResult, places: Sequence[int]) -> str:
    return ", ".join(f"`{result.laws[n]}`" for n in places)
