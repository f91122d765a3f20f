"""Driven cells of a board, a row for each law: memory stays flat, a stop loses nothing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from ev_stack.recording.outcome import RunFailed
from ev_stack.scenarios.records import Run
from ev_study.benchmark.added import refuse_variations
from ev_study.benchmark.board import Board, Cell
from ev_study.benchmark.cell_runs import law_of, run_of, values_of, with_law
from ev_study.benchmark.driving import DrivenCell, DrivenLaw
from ev_study.studies.digests import short_digest
from ev_study.studies.kept_rows import KeptRows, Key, run_key
from ev_study.studies.result_store import Results


@dataclass(frozen=True)
class KeptCells(Sequence[DrivenCell]):
    """The cells of a board as some laws have driven them, each read when it is asked for.

    `runs` are some with all methods that drive.
    """

    rows: KeptRows[DrivenLaw]
    cells: Sequence[Cell]
    laws: Sequence[str]
    runs: Sequence[Run]

    def missing(self) -> dict[Cell, list[str]]:
        """Return by cell the laws that have not driven it."""
        found: dict[Cell, list[str]] = {}
        for cell in self.cells:
            for law in self.laws:
                if self.rows.get((cell, law)) is None:
                    found.setdefault(cell, []).append(law)
        return found

    def keep(self, driven: DrivenCell) -> None:
        """Write what laws have driven in a cell, at once; OSError if it cannot be written."""
        for law, row in driven.laws.items():
            self.rows.keep((driven.cell, law), row)

    def __len__(self) -> int:
        return len(self.cells)

    def __getitem__(self, number: int) -> DrivenCell:
        """Return a cell with all its laws; RunFailed if the store has lost one."""
        cell = self.cells[number]
        driven = {}
        for law in self.laws:
            row = self.rows.get((cell, law))
            if row is None:
                lost = f"{law} in {cell.id('*')} is broken"
                raise RunFailed(f"{lost}: the same command drives it again")
            driven[law] = row
        return DrivenCell(cell, driven)


def kept_cells(
    board: Board, cells: Sequence[Cell], laws: Sequence[str], results: Results, anew: bool = False
) -> KeptCells:
    """Return cells as laws have driven them before; those to drive again, `anew`, count as missing.

    ParameterError for a mistake of the board's file.
    """
    runs: list[Run] = []
    keys = dict(keys_of_cells(board, cells, laws, runs))
    refuse_variations(board, runs)
    return KeptCells(KeptRows(results, DrivenLaw, keys, anew), cells, laws, runs)


def keys_of_cells(
    board: Board, cells: Sequence[Cell], laws: Sequence[str], runs: list[Run]
) -> Iterator[tuple[tuple[Cell, str], Key]]:
    """Give the key of each law in each cell; the runs that are made for it are put into `runs`.

    What does not belong to other cells and laws stays in the key, so that nothing is forgotten.
    """
    # A key without these: another name, scale or reference changes no run that was driven.
    others = replace(board, name="", cars=[], scales={}, reference="", closed=[], tuned={})
    others = replace(others, training=None, validation=None, held_out=None)
    of_runs: dict[tuple[str, str], tuple[Key, Run]] = {}
    of_laws: dict[tuple[str, str], Key] = {}
    for cell in cells:
        at = cell.car, cell.manoeuvre
        # One run stands for all roads: these are in `declared`, and their surfaces are no files.
        if at not in of_runs:
            of_runs[at] = run_key(lambda cell=cell: run_of(board, cell, values_of(board, cell)))
            base = of_runs[at][1]
            # With the first law alone: it shows what the scenario has, for the variations to be
            # held against.
            runs.append(with_law(base, law_of(board, laws[0], base)))
        # The run without a law gives the car for the laws.
        of_run, base = of_runs[at]
        for law in laws:
            if (cell.car, law) not in of_laws:
                # Of its nodes alone: an edit of the first manoeuvre leaves what others have driven.
                of_law, nodes = run_key(
                    lambda law=law, base=base: Run(law, "", law_of(board, law, base), 0.0)
                )
                of_laws[cell.car, law] = of_law
                runs.append(with_law(base, nodes.configurations))
            of_law = of_laws[cell.car, law]
            # Only its own law and manoeuvre: an edit of another one leaves this row.
            manoeuvres = {cell.manoeuvre: board.manoeuvres[cell.manoeuvre]}
            declared = replace(others, laws={law: board.laws[law]}, manoeuvres=manoeuvres)
            content = declared, replace(cell, board=""), of_run.digest, of_law.digest
            yield (cell, law), Key(short_digest(content), {**of_run.files, **of_law.files})
