"""The files with a record of each run of a board, written run by run."""

from __future__ import annotations

import gzip
import json
from importlib.util import find_spec
from itertools import islice
from pathlib import Path
from typing import IO

from ev_stack.recording.outcome import announce
from ev_stack.recording.recording import atomic_file
from ev_study.benchmark.ranking.result import BoardResult

MOST_IN_JSON = 100_000  # runs, beyond which there is a line of JSON for each, compressed
_ROWS_AT_ONCE = 10_000


def write_runs(folder: Path, result: BoardResult) -> None:
    """Write runs.json, or for many runs runs.jsonl.gz, and runs.parquet where pyarrow is installed."""
    whole = folder / "runs.json"
    lines = folder / "runs.jsonl.gz"
    runs = len(result.cells) * len(result.laws) * result.board.draws
    if runs <= MOST_IN_JSON:
        with atomic_file(whole) as file:
            _write_lines(file, result, b'{"runs": [\n', b",\n", b"\n]}\n")
    else:
        announce(
            f"note: {runs} runs: {lines.name} has one a line, since {whole.name} takes"
            f" at most {MOST_IN_JSON}"
        )
        with atomic_file(lines) as file, gzip.open(file, "wb", compresslevel=6) as packed:
            _write_lines(packed, result, b"", b"\n", b"\n")
    if find_spec("pyarrow") is not None:
        _write_parquet(folder / "runs.parquet", result)


def _write_lines(
    file: IO[bytes], result: BoardResult, begin: bytes, between: bytes, end: bytes
) -> None:
    for run in result.runs():
        file.write(begin + json.dumps(run, allow_nan=False, ensure_ascii=False).encode())
        # The first run has the head of the file in front, the others a separator.
        begin = between
    file.write(end)


def _write_parquet(path: Path, result: BoardResult) -> None:
    """Write the metrics of all manoeuvres as columns of numbers, empty where a run has none."""
    import pyarrow
    import pyarrow.parquet

    first = pyarrow.Table.from_pylist([next(result.runs())]).schema
    metrics = [name for cell in result.cells for of in cell.metrics.values() for name in of]
    kinds = dict(zip(first.names, first.types, strict=True)) | dict.fromkeys(
        metrics, pyarrow.float64()
    )
    schema, runs = pyarrow.schema([*kinds.items()]), result.runs()
    # Commands are long and much alike: snappy, which is the default, leaves almost three times as
    # much of them.
    with (
        atomic_file(path) as file,
        pyarrow.parquet.ParquetWriter(file, schema, compression="zstd") as writer,
    ):
        while rows := [*islice(runs, _ROWS_AT_ONCE)]:
            writer.write_table(pyarrow.Table.from_pylist(rows, schema))
