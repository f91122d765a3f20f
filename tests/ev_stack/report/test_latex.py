"""Tables for LaTeX.

Columns of siunitx that fit their numbers, digits as wanted, the best values in bold.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from ev_stack.measures.metric import HIGHER, LOWER
from ev_stack.report.latex import latex_table

COLUMNS = ("method", "peak [rad]", "energy [J]", "seed", "work_50 % & more", "gap")
ROWS = [
    ("power_steering", 0.012345, 123456.7, 0, 1.2e-9, None),
    ("equal_torque", -1.5, 12.3, 12, 3.4e-12, 2.0),
    ("a^b~{c}\\", 0.5, 99999.96, 7, 5.6e-10, 0.0),
]


def cells(text: str) -> list[list[str]]:
    """The rows between the rules of booktabs."""
    body = re.search(r"\\midrule\n(.*)\\bottomrule", text, re.DOTALL)[1]
    return [line.removesuffix(r" \\").split(" & ") for line in body.splitlines()]


def test_numbers_have_the_digits_that_are_wanted_and_a_column_that_fits_them():
    """Four significant digits: 99999.96 is 100000.

    siunitx gets the most digits before and behind the point.
    """
    text = latex_table(COLUMNS, ROWS)
    formats = "l S[table-format=-1.5] S[table-format=6.2] S[table-format=2.0] S[table-format=1.3e-2] S[table-format=1.3]"
    assert rf"\begin{{tabular}}{{{formats}}}" in text
    assert [row[1] for row in cells(text)] == ["0.01235", "-1.500", "0.5000"]
    assert [row[2] for row in cells(text)] == ["123500", "12.30", "100000"]
    # whole numbers have no digits to choose
    assert [row[3] for row in cells(text)] == ["0", "12", "7"]
    assert [row[4] for row in cells(text)] == ["1.200e-09", "3.400e-12", "5.600e-10"]
    assert [row[5] for row in cells(text)] == ["", "2.000", "0.000"]
    assert [row[1] for row in cells(latex_table(COLUMNS, ROWS, digits=2))] == [
        "0.012",
        "-1.5",
        "0.50",
    ]


def test_text_is_masked_and_heads_are_braced():
    text = latex_table(COLUMNS, ROWS)
    assert (
        r"{method} & {peak [rad]} & {energy [J]} & {seed} & {work\_50 \% \& more} & {gap} \\"
        in text
    )
    assert cells(text)[2][0] == r"a\textasciicircum{}b\textasciitilde{}\{c\}\textbackslash{}"


def test_best_values_are_bold_where_one_way_is_better():
    best = {"peak [rad]": LOWER, "energy [J]": HIGHER}
    found = cells(latex_table(COLUMNS, ROWS, best=best))
    assert [row[1].startswith(r"\bfseries ") for row in found] == [False, True, False]
    assert [row[2].startswith(r"\bfseries ") for row in found] == [True, False, False]
    assert "bfseries" not in "".join(row[n] for row in found for n in (0, 3, 4, 5))
    assert "bfseries" not in latex_table(COLUMNS, ROWS)


def test_values_that_look_alike_are_all_bold():
    """1.0000 and 1.0001 are both 1.000: a reader could not see why one of them is bold."""
    found = cells(latex_table(["a"], [[1.0001], [1.0], [1.01], [None]], best={"a": LOWER}))
    assert found == [[r"\bfseries 1.000"], [r"\bfseries 1.000"], ["1.010"], [""]]


@pytest.mark.slow
@pytest.mark.skipif(
    not shutil.which("pdflatex"), reason="pdflatex with booktabs and siunitx 3 is not installed"
)
def test_latex_accepts_the_table(tmp_path: Path):
    table = latex_table(COLUMNS, ROWS, best={"peak [rad]": LOWER, COLUMNS[4]: LOWER})
    head = r"\documentclass{article}\usepackage{booktabs,siunitx}\begin{document}"
    (tmp_path / "table.tex").write_text("\n".join([head, table, r"\end{document}"]))
    words = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "table.tex"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0 and "Warning" not in done.stdout, done.stdout[-2000:]
