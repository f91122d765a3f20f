"""Tables for LaTeX: rules of booktabs, number columns of siunitx, on demand the best in bold."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from ev_stack.measures.metric import LOWER

DIGITS = 4  # significant ones
_SPECIAL = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}
_SPECIAL |= {character: f"\\{character}" for character in "_%&#${}"}
_SMALLEST, _LARGEST = 1e-4, 1e7  # beyond them a number has a power of ten
_HEAD = r"""% \usepackage{booktabs,siunitx}
\begingroup
\sisetup{mode = match, reset-text-series = false, text-series-to-math = true, propagate-math-font = true}
"""


def latex_table(
    columns: Sequence[str],
    rows: Sequence[Sequence[Any]],
    digits: int = DIGITS,
    best: Mapping[str, str] = MappingProxyType({}),
) -> str:
    """Build a tabular of siunitx 3: numbers aligned at their points, all else as text.

    `best` has `metric.LOWER` or `metric.HIGHER` of the columns with the best value in bold; None is
    an empty cell.
    """
    series = [[row[n] for row in rows] for n in range(len(columns))]
    cells, kinds = [], []
    for name, values in zip(columns, series, strict=True):
        numbers = [value for value in values if value is not None and _is_number(value)]
        if numbers and all(value is None or _is_number(value) for value in values):
            shown = ["" if value is None else _number(value, digits) for value in values]
            kinds.append(f"S[table-format={_format(shown)}]")
            cells.append(_in_bold(values, shown, best.get(name, "")))
        else:
            kinds.append("l")
            cells.append(["--" if value is None else _text(value) for value in values])
    lines = [[f"{{{_text(name)}}}" for name in columns], *zip(*cells, strict=True)]
    head, *body = [" & ".join(line) + r" \\" for line in lines]
    ruled = [r"\toprule", head, r"\midrule", *body, r"\bottomrule"]
    return "\n".join(
        [
            f"{_HEAD}\\begin{{tabular}}{{{' '.join(kinds)}}}",
            *ruled,
            r"\end{tabular}",
            r"\endgroup",
            "",
        ]
    )


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _number(value: float, digits: int) -> str:
    """So many significant digits; a whole number, such as a seed, as it is."""
    if isinstance(value, int):
        return str(value)
    # Rounded first: 9.9996 becomes 10.00, with one digit less behind the point.
    rounded = float(f"{value:.{digits - 1}e}")
    if rounded and not _SMALLEST <= abs(rounded) < _LARGEST:
        return f"{value:.{digits - 1}e}"
    place = math.floor(math.log10(abs(rounded))) if rounded else 0
    return f"{rounded:.{max(digits - 1 - place, 0)}f}"


def _format(shown: Sequence[str]) -> str:
    """Digits for which siunitx leaves room before and behind the point and in the exponent."""
    parts = [number.partition("e") for number in shown]
    # siunitx reserves room by this format; a number with more digits would move its column.
    signs = "-" * any(number.startswith("-") for number, _, _ in parts)
    whole = max(len(number.lstrip("-").partition(".")[0]) for number, _, _ in parts)
    behind = max(len(number.partition(".")[2]) for number, _, _ in parts)
    powers = [str(int(power)) for _, _, power in parts if power]
    minus = "-" * any(power.startswith("-") for power in powers)
    exponent = f"e{minus}{max(len(power.lstrip('-')) for power in powers)}" if powers else ""
    return f"{signs}{whole}.{behind}{exponent}"


def _in_bold(values: Sequence[Any], shown: Sequence[str], better: str) -> list[str]:
    """The cells, those of the best value in bold, also where several look like it."""
    if not better:
        return list(shown)
    known = [(value, cell) for value, cell in zip(values, shown, strict=True) if value is not None]
    # By the values themselves; cells that look like the best are marked with it below.
    _, best = (min if better == LOWER else max)(known, key=lambda each: each[0])
    return [rf"\bfseries {cell}" if cell == best else cell for cell in shown]


def _text(value: Any) -> str:
    return "".join(_SPECIAL.get(character, character) for character in str(value))
