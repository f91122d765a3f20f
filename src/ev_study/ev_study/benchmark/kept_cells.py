"""What a board has driven, by law and cell: memory stays flat, and a stopped board goes on."""

from __future__ import annotations

import io
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_core.parameters.data_file import files_read
from ev_stack.recording.outcome import RunFailed
from ev_stack.running.folder_content import digest_of
from ev_stack.scenarios.scenario import Run
from ev_study.benchmark.added import refuse_variations
from ev_study.benchmark.board import Board, Cell
from ev_study.benchmark.cell_runs import law_of, run_of, values_of
from ev_study.benchmark.driving import DrivenCell
from ev_study.studies.digests import short_digest
from ev_study.studies.kept_rows import run_key
from ev_study.studies.result_store import Results

Part = Mapping[str, np.ndarray]  # of a law in a cell
_METRIC, _CLEAN, _HASHES, _COMMANDS = "metric ", "clean", "hashes", "commands"


class KeptCells(Sequence[DrivenCell]):
    """The cells of a board as some laws have driven them, each read when it is asked for.

    They stand in `results` under a digest of all that their numbers depend on beside our sources.
    `runs` are some with all methods that drive. ParameterError for what the file of the board gets
    wrong.
    """

    def __init__(
        self, board: Board, cells: Sequence[Cell], laws: Sequence[str], results: Results
    ) -> None:
        self._cells, self._laws, self._results = cells, laws, results
        self._read: dict[str, str] = {}
        self._anew = set[str]()
        self.runs: list[Run] = []
        self._names = dict(self._named(board))
        refuse_variations(board, self.runs)

    def _named(self, board: Board) -> Iterator[tuple[tuple[Cell, str], str]]:
        """The file of each law in each cell. What is not of both stays in the digest, so that nothing is forgotten."""
        others = replace(board, name="", cars=[], scales={}, reference="", closed=[], tuned={})
        others = replace(others, training=None, validation=None, held_out=None)
        of_runs: dict[tuple[str, str], str] = {}
        of_laws: dict[tuple[str, str], str] = {}
        for cell in self._cells:
            if (cell.car, cell.manoeuvre) not in of_runs:
                of_runs[cell.car, cell.manoeuvre], base = self._key_of(
                    lambda cell=cell: run_of(board, cell, values_of(board, cell))
                )
                self.runs.append(_playing(base, law_of(board, self._laws[0], base)))
            for law in self._laws:
                if (cell.car, law) not in of_laws:
                    # Its nodes alone, so that an edit of the first manoeuvre leaves what the others
                    # have driven.
                    of_laws[cell.car, law], nodes = self._key_of(
                        lambda base=base, law=law: Run(law, "", law_of(board, law, base), 0.0)
                    )
                    self.runs.append(_playing(base, nodes.configurations))
                manoeuvres = {cell.manoeuvre: board.manoeuvres[cell.manoeuvre]}
                declared = replace(others, laws={law: board.laws[law]}, manoeuvres=manoeuvres)
                keys = of_runs[cell.car, cell.manoeuvre], of_laws[cell.car, law]
                digest = short_digest((declared, replace(cell, board=""), *keys))
                yield (cell, law), f"{digest}.cell"

    def _key_of(self, make: Callable[[], Run]) -> tuple[str, Run]:
        with files_read() as read:
            key, run = run_key(make)
        self._read |= read
        return key, run

    @property
    def laws_in_cells(self) -> list[Sequence[str]]:
        """The laws of each cell."""
        return [self._laws] * len(self._cells)

    @property
    def names(self) -> list[str]:
        """What they are called in `results`."""
        return list(dict.fromkeys(self._names.values()))

    def forget(self) -> None:
        """Count all as missing until they have been driven again."""
        self._anew = set(self._names.values())

    def missing(self) -> dict[Cell, list[str]]:
        """By cell the laws that have not driven it."""
        found: dict[Cell, list[str]] = {}
        for (cell, law), name in self._names.items():
            if name in self._anew or self._results.get(name) is None:
                found.setdefault(cell, []).append(law)
        return found

    def keep(self, driven: DrivenCell) -> None:
        """Write what laws have driven in a cell, at once; OSError if it cannot be written.

        RunFailed if one of the files behind its numbers is another one by now.
        """
        for path, digest in self._read.items():
            if not (Path(path).is_file() and digest_of(Path(path)) == digest):
                raise RunFailed(f"{path} has changed while the board was driven: start it again")
        for law, metrics in driven.metrics.items():
            texts = {_HASHES: driven.hashes[law], _COMMANDS: driven.commands[law]}
            part = {f"{_METRIC}{name}": values for name, values in metrics.items()} | {
                _CLEAN: driven.clean[law]
            }
            part |= {name: np.array([each.encode() for each in of]) for name, of in texts.items()}
            np.savez_compressed(content := io.BytesIO(), **part)
            name = self._names[driven.cell, law]
            self._results[name] = content.getvalue()
            self._anew.discard(name)

    def _part(self, name: str) -> Part:
        """What a law has driven in a cell; RunFailed if it is not what was written."""
        content = self._results.get(name)
        if content is None:
            raise RunFailed(f"{name} is broken: the same command drives it again")
        with np.load(io.BytesIO(content), allow_pickle=False) as file:
            return dict(file)

    def __len__(self) -> int:
        return len(self._cells)

    def __getitem__(self, number: int) -> DrivenCell:
        """A cell with all its laws."""
        cell = self._cells[number]
        driven = DrivenCell(cell, {}, {}, {}, {})
        for law in self._laws:
            part = self._part(self._names[cell, law])
            driven.metrics[law] = {
                n.removeprefix(_METRIC): part[n] for n in part if n.startswith(_METRIC)
            }
            driven.clean[law] = part[_CLEAN]
            driven.hashes[law], driven.commands[law] = (
                [each.decode() for each in part[name].tolist()] for name in (_HASHES, _COMMANDS)
            )
        return driven


def _playing(run: Run, nodes: Mapping[str, Configuration]) -> Run:
    return replace(run, configurations={**run.configurations, **nodes})
