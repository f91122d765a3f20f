"""Commands that hold a car against measurement: scripts/run.sh validate (docs/measured.md).

Each raises what `ev_sim.commands.run_scenario.main` catches.
"""

from __future__ import annotations

import argparse
import hashlib
import time
from collections.abc import Sequence
from pathlib import Path

from ev_core.parameters.data_file import SIGNALS, read_data
from ev_msgs_py.refusal import ParameterError, quoted
from ev_sim.command_line.options import add_changes, command_of, overrides
from ev_sim.command_line.refusal import Parser
from ev_sim.measured.open_loop import OpenLoop, Windows, graph, windows_of
from ev_sim.measured.record import (
    ColumnParameters,
    MaskParameters,
    MeasuredRecord,
    measured,
    read_record,
)
from ev_sim.measured.validation import FILES, Validation, signals_to_show
from ev_sim.replay.recorded import find_recorded
from ev_sim.running.output_folder import OutputFolder

_OF_A_RUN = (".npz", ".mcap", ".db3", "")  # what a recording of ours may end with; the last is a folder


def run_validate(argv: Sequence[str]) -> None:
    """Replay a record open loop, and print and write how far the car is from it."""
    parser = Parser(
        prog="run.sh validate", description="scripts/run.sh validate: a car against a record of a real one."
    )
    _add_record(parser, "validate")
    parser.add_argument("--no-report", action="store_true", help="no report.html; numbers and figures all the same")
    given = parser.parse_args(argv)
    record = open_record(given.record, given.mapping)
    replay = _replay(given, record, windows_of(record, given.window, *given.part))
    with OutputFolder(given.out, "validate", FILES) as folder:
        begin = time.monotonic()
        found = Validation(replay, {n: v[0] for n, v in replay.simulate().items()}, time.monotonic() - begin)
        print(found.table())
        found.write(folder.directory, command_of(["validate", *argv]), not given.no_report)
    for note in found.notes():
        print(f"note: {note}")
    print(f"{len(replay.windows)} windows of {given.window:g} s; page, figures, signals, summary: {folder.directory}")


def _add_record(parser: argparse.ArgumentParser, name: str) -> None:
    parser.add_argument("record", type=Path, metavar="RECORD", help="CSV (.csv, .csv.xz), a bag or signals.npz")
    parser.add_argument(
        "--mapping", type=Path, metavar="FILE", help="what the columns are; default RECORD's name .yaml"
    )
    parser.add_argument("--window", type=float, default=5.0, metavar="S", help="length of a window; default 5 s")
    parser.add_argument(
        "--part", type=_part, default=(0.0, 1.0), metavar="A:B", help="shares of the record; default 0:1"
    )
    folder = Path("results") / name
    parser.add_argument("--out", type=Path, metavar="DIR", default=folder, help=f"output folder; default {folder}")
    add_changes(parser)


def _part(text: str) -> tuple[float, float]:
    try:
        begin, end = map(float, text.split(":"))
    except ValueError:
        begin, end = 0.0, 0.0
    if not 0.0 <= begin < end <= 1.0:
        raise argparse.ArgumentTypeError(f"{quoted(text)} is refused, allowed is A:B with 0 <= A < B <= 1")
    return begin, end


def _replay(given: argparse.Namespace, record: MeasuredRecord, windows: Windows) -> OpenLoop:
    if given.vehicle is None:
        raise ParameterError("--vehicle is missing: which car?")
    return OpenLoop(record, windows, graph(given.vehicle, record.period, overrides(given)), signals_to_show())


def open_record(path: Path, mapping: Path | None = None) -> MeasuredRecord:
    """The record of a CSV file with its mapping, of a bag or of signals.npz; ParameterError if there is none."""
    if path.suffix not in _OF_A_RUN:
        beside = path.with_name(path.name.removesuffix(".xz")).with_suffix(".yaml")
        return read_record(path, mapping or beside)
    found = find_recorded(path)
    columns = {name: (values, ColumnParameters()) for name, values in found.recording.channels.items()}
    return measured(str(path), _digest(found.source), found.recording.time, columns, MaskParameters())


def _digest(path: Path) -> str:
    """SHA-256 of a file, empty of a folder."""
    return hashlib.sha256(read_data(path, SIGNALS)).hexdigest() if path.is_file() else ""
