"""Commands that hold a car against measurement: scripts/run.sh validate and identify (docs/measured.md).

Each raises what `ev_stack.commands.run_scenario.main` catches.

How it works: `validate` and `identify` open a record, cut it into windows and make a replay of it
with a car. `validate` drives that car and judges it; `identify` fits parameters of it to the first
part of the record, and judges start and result on both parts. Tyres and motors are fitted to tables
of a rig instead, by the same command.
"""

from __future__ import annotations

import argparse
import hashlib
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from ev_core.methods.estimator import estimators
from ev_core.parameters.data_file import SIGNALS, read_data
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.command_line.options import add_changes, command_of, overrides
from ev_stack.command_line.paths import add_out
from ev_stack.command_line.refusal import Parser
from ev_stack.running.output_folder import output_folder
from ev_stack.scenarios.files import vehicle_file
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.records import Overrides
from ev_study.measured.free_parameters import GROUPS, free_parameters
from ev_study.measured.identification import identify, moved_by_scales
from ev_study.measured.identified import CAR, PARTS, Identified
from ev_study.measured.intervals import knowledge
from ev_study.measured.motor_map import MOTOR, fit_motor, motor_table, write_motor
from ev_study.measured.records.bags import is_foreign
from ev_study.measured.records.loose_bags import without_metadata
from ev_study.measured.records.mapping import read_record, read_standard
from ev_study.measured.records.record import (
    SIDESLIP,
    YAW_RATE,
    ColumnParameters,
    MaskParameters,
    MeasuredRecord,
    Sampled,
    measured,
)
from ev_study.measured.replays.corridors import CORRIDOR, corridor_parameters
from ev_study.measured.replays.estimates import estimates_of
from ev_study.measured.replays.open_loop import (
    IMPOSED,
    ROLES_OF_REPLAY,
    OpenLoop,
    Windows,
    graph,
    refuse_own,
    windows_of,
)
from ev_study.measured.replays.plausibility import contradictions
from ev_study.measured.replays.validation import Validation, signals_to_show
from ev_study.measured.rig import read_rig
from ev_study.measured.search_key import search_key
from ev_study.measured.tyre_fit import fit_tyre
from ev_study.measured.tyre_report import TYRE, tyre_table, write_tyre
from ev_study.replay.recorded import find_recorded
from ev_study.studies.digests import digest_of_sources
from ev_study.studies.result_store import Answers, ResultStore

# Largest values of options of `identify`, each above 0.
_MOST = {"starts": 1000, "steps": 100_000, "every": 100_000, "prior": 1e6, "train": 1.0}
# what a recording of ours may end with; the last is a folder
_OF_A_RUN = (".npz", ".mcap", ".db3", "")


def run_validate(argv: Sequence[str]) -> None:
    """Replay a record open loop, and print and write how far the car is from it."""
    parser = Parser(
        prog="run.sh validate",
        description="scripts/run.sh validate: a car against a record of a real one.",
    )
    _add_record(parser, "validate")
    parser.add_argument(
        "--no-report",
        action="store_true",
        help="neither report.html nor figures, numbers all the same",
    )
    parser.add_argument(
        "--estimators",
        action="store_true",
        help="what the laws estimate from the record as well, beside what was measured",
    )
    given = parser.parse_args(argv)
    if given.record is None:
        parser.error("which record?")
    record = open_record(given.record, given.mapping)
    changed, judging = _parted(overrides(given), given.estimators)
    replay = _replay(given, record, windows_of(record, given.window, *given.part), changed)
    tolerances = corridor_parameters(judging[CORRIDOR])
    estimates, lacking = estimates_of(replay, judging) if given.estimators else ([], [])
    with output_folder(given.out, "validate") as folder:
        begin = time.monotonic()
        # The only car of the batch.
        simulated = {n: v[0] for n, v in replay.simulate().items()}
        found = Validation(replay, simulated, time.monotonic() - begin, tolerances, estimates)
        print(found.table())
        found.write(folder, command_of(["validate", *argv]), not given.no_report)
    for note in (*found.notes(), *lacking):
        print(f"note: {note}")
    print(
        f"{len(replay.windows)} windows of {given.window:g} s; page, figures, signals, summary:"
        f" {folder}"
    )


def run_identify(argv: Sequence[str]) -> None:
    """Find parameters of a car, a tyre or a motor, and print and write them with what is known of each."""
    parser = _parser_of_identify()
    given = parser.parse_args(argv)
    command = command_of(["identify", *argv])
    if given.motor:
        _identify_motor(given, command)
    elif given.tyre:
        _identify_tyre(given, command)
    elif given.record is None or not given.free:
        parser.error(
            "which record, and which parameters? RECORD --free GROUP ..., or --tyre RIG ..., or"
            " --motor MAP.csv"
        )
    else:
        _identify_car(given, command)


def _parser_of_identify() -> Parser:
    parser = Parser(
        prog="run.sh identify",
        description="scripts/run.sh identify: parameters of a car from a record of it.",
    )
    parser.add_argument(
        "--tyre",
        nargs="+",
        type=Path,
        metavar="RIG",
        help="a tyre from these rig data instead of a car",
    )
    parser.add_argument(
        "--friction-scale",
        type=float,
        default=1.0,
        metavar="S",
        help="of the road over the rig's belt",
    )
    parser.add_argument(
        "--motor",
        type=Path,
        metavar="MAP.csv",
        help="a motor's losses from this map instead of a car",
    )
    _add_record(parser, "identify")
    groups = "; ".join(f"{name}: {', '.join(of)}" for name, of in GROUPS.items())
    parser.add_argument(
        "--free",
        nargs="+",
        default=[],
        metavar="GROUP",
        help=f"parameters that are looked for, or groups of them: {groups}",
    )
    parser.add_argument(
        "--train",
        type=float,
        default=2 / 3,
        metavar="SHARE",
        help="of the windows; the rest is held out",
    )
    parser.add_argument(
        "--signals",
        nargs="+",
        default=[],
        metavar="CHANNEL",
        help="that are compared; default yaw rate and sideslip",
    )
    parser.add_argument(
        "--starts", type=int, default=1, metavar="N", help="starts of the search; default 1"
    )
    parser.add_argument(
        "--steps", type=int, default=25, metavar="N", help="largest number of steps from a start"
    )
    parser.add_argument(
        "--prior",
        type=float,
        default=1.0,
        metavar="W",
        help="width of what is believed of a start, in scales",
    )
    parser.add_argument(
        "--every",
        type=int,
        default=5,
        metavar="N",
        help="sample that counts for the fit; default 5",
    )
    parser.add_argument(
        "--no-report",
        action="store_true",
        help="neither report.html nor figures, numbers all the same",
    )
    return parser


def _identify_car(given: argparse.Namespace, command: str) -> None:
    """Fit parameters of a car to the first part of a record, and hold it against the rest."""
    for name, most in _MOST.items():
        value = getattr(given, name)
        if not 0.0 < value <= most:
            raise ParameterError(
                f"--{name} {value:g} is refused, expected more than 0 and at most {most:g}"
            )
    record = open_record(given.record, given.mapping)
    # Both parts now: one without a window is refused before the search, not hours behind it.
    replays = _replays_of_parts(given, record)
    replay = replays[PARTS[0]]
    # A fit would bend the car until a wrong sign or unit is made up for.
    if wrong := contradictions(replay):
        raise ParameterError(f"{record.source}: {wrong[0]}")
    stated, beside = _given(given)
    free = free_parameters(given.free, replay.configurations)
    signals = _signals_to_fit(given, replay)
    # Of further starts and of the bootstrap.
    seed = given.seed or 0
    key = search_key(
        replay,
        free,
        signals,
        given.every,
        given.prior,
        given.starts,
        seed,
        given.steps,
        given.impose,
    )
    # Evaluations are kept one by one, so a search that is stopped goes on where it was.
    answers = Answers(ResultStore(digest_of_sources()), key)
    with output_folder(given.out, "identify") as folder:
        fitted = identify(
            replay, free, signals, every=given.every, width=given.prior, starts=given.starts, seed=seed,
            most=given.steps, progress=lambda line: print(line, flush=True), answers=answers,
        )  # fmt: skip
        known = knowledge(
            fitted.residuals, fitted.derivatives, fitted.values, free, given.prior, seed
        )
        moved = moved_by_scales(replay, free, fitted, given.every, given.prior)
        found = Identified(free, fitted, known, replays, stated, beside, command, moved)
        print(found.table())
        found.write(folder, not given.no_report)
    for note in (*record.notes, *replay.notes):
        print(f"note: {note}")
    if answers.taken:
        print(f"went on behind {answers.taken} evaluations of an earlier search")
    print(f"car: {folder / CAR}")


def _replays_of_parts(given: argparse.Namespace, record: MeasuredRecord) -> dict[str, OpenLoop]:
    """Replays of the part that is fitted and, if something is left of the record, of the part that is held out."""
    begin, end = given.part
    # Training first: windows of the rest are newer than all that the fit has seen.
    split = begin + given.train * (end - begin)
    parts = {PARTS[0]: (begin, split)}
    if given.train < 1.0:
        parts[PARTS[1]] = (split, end)
    changed = overrides(given)
    return {
        part: _replay(given, record, windows_of(record, given.window, *of), changed)
        for part, of in parts.items()
    }


def _signals_to_fit(given: argparse.Namespace, replay: OpenLoop) -> list[str]:
    """Channels to fit: those of the command, else yaw rate and sideslip angle where they are measured."""
    signals = given.signals or [name for name in (YAW_RATE, SIDESLIP) if name in replay.compared]
    for name in signals:
        if name not in replay.compared:
            raise unknown_name("--signals", name, replay.compared)
    return signals


def _identify_motor(given: argparse.Namespace, command: str) -> None:
    """Fit the losses of a motor to a map of its efficiency, and write its parameters and errors."""
    with output_folder(given.out, "identify") as folder:
        motor = fit_motor(given.motor)
        print(motor_table(motor))
        write_motor(folder, motor, command)
    print(f"{len(motor.speed)} points, {motor.left_out} rows left out; motor: {folder / MOTOR}")


def _identify_tyre(given: argparse.Namespace, command: str) -> None:
    """Fit a tyre to rig data, and write its property file, the errors and curves over data."""
    if not 0.1 <= given.friction_scale <= 2.0:
        raise ParameterError(
            f"--friction-scale {given.friction_scale:g} is refused, expected 0.1 to 2"
        )
    sweeps = read_rig(given.tyre)
    with output_folder(given.out, "identify") as folder:
        fit = fit_tyre(sweeps)
        print(tyre_table(fit))
        write_tyre(folder, fit, sweeps, given.friction_scale, command)
    passed_over = f"{sweeps.passed_over} samples passed over that lack a number or have no load"
    print(f"{sweeps.count} sweeps, {passed_over}; tyre: {folder / TYRE}")


def _given(given: argparse.Namespace) -> tuple[dict[str, Any], dict[str, Any]]:
    """Values of the vehicle, by dotted name, and of the rest, by ROLE.PARAMETER."""
    changed = overrides(given)
    stated, beside = vehicle_file(given.vehicle).values_for("/ev/plant"), dict[str, Any]()
    # A parameter file may have a section for each role.
    for role in ROLES_OF_REPLAY:
        for file in map(ParameterFile, changed.files):
            beside |= {
                f"{role}.{name}": value for name, value in file.values_for(f"/ev/{role}").items()
            }
    for node, name, value in changed.values:
        beside |= {
            f"{role}.{name}": value for role in (ROLES_OF_REPLAY if node == "*" else (node,))
        }
    # What belongs to the car goes into the vehicle file that is written, not beside it.
    of_car = {
        name.partition(".")[2]: value for name, value in beside.items() if ".vehicle." in name
    }
    return {**stated, **of_car}, {
        name: value for name, value in beside.items() if ".vehicle." not in name
    }


def _add_record(parser: argparse.ArgumentParser, name: str) -> None:
    parser.add_argument(
        "record",
        nargs="?",
        type=Path,
        metavar="RECORD",
        help="CSV (.csv, .csv.xz), a bag, a CAN log (.log, .asc, .blf, .mf4) or signals.npz",
    )
    parser.add_argument(
        "--mapping",
        type=Path,
        metavar="FILE",
        help="what the columns are; default RECORD's name .yaml",
    )
    parser.add_argument(
        "--impose",
        choices=IMPOSED,
        default="speed",
        help="what drives the car besides the measured angle",
    )
    about = (
        "[Hz] of the speed and what windows begin from, 0 for none; default by the noise of the"
        " record"
    )
    parser.add_argument("--smooth", type=_cut_off, metavar="HZ", help=about)
    parser.add_argument(
        "--window", type=float, default=5.0, metavar="S", help="length of a window; default 5 s"
    )
    parser.add_argument(
        "--part",
        type=_part,
        default=(0.0, 1.0),
        metavar="A:B",
        help="shares of the record; default 0:1",
    )
    add_out(parser, name)
    add_changes(parser)


def _cut_off(text: str) -> float:
    value = float(text)
    if not (value == 0.0 or 0.1 <= value <= 1000.0):
        raise argparse.ArgumentTypeError(
            f"{quoted(text)} is refused, expected 0, or 0.1 to 1000 Hz"
        )
    return value


def _part(text: str) -> tuple[float, float]:
    try:
        begin, end = map(float, text.split(":"))
    except ValueError:
        begin, end = 0.0, 0.0
    if not 0.0 <= begin < end <= 1.0:
        raise argparse.ArgumentTypeError(
            f"{quoted(text)} is refused, expected A:B with 0 <= A < B <= 1"
        )
    return begin, end


def _parted(
    changed: Overrides, with_estimators: bool
) -> tuple[Overrides, dict[str, dict[str, Any]]]:
    """Split values for the graph from those for corridors and estimators, by their names."""
    found: dict[str, dict[str, Any]] = {name: {} for name in (CORRIDOR, *estimators())}
    for file in map(ParameterFile, changed.files):
        for name, values in found.items():
            values |= file.values_for(f"/ev/{name}", by_name=True)
    for name, key, value in changed.values:
        if name in found:
            # A value that nothing reads is refused, as everywhere.
            if name != CORRIDOR and not with_estimators:
                raise ParameterError(f"{name}.{key} is refused without --estimators")
            found[name][key] = value
    return replace(changed, values=[each for each in changed.values if each[0] not in found]), found


def _replay(
    given: argparse.Namespace, record: MeasuredRecord, windows: Windows, changed: Overrides
) -> OpenLoop:
    if given.duration is not None:
        raise ParameterError(
            "--duration is refused: a replay lasts as long as its windows, expected --window"
        )
    if given.vehicle is None:
        raise ParameterError("--vehicle is missing: which car?")
    refuse_own(changed, given.impose)
    configurations = graph(given.vehicle, record.period, changed, given.impose)
    return OpenLoop(record, windows, configurations, signals_to_show(), given.impose, given.smooth)


def open_record(path: Path, mapping: Path | None = None) -> MeasuredRecord:
    """The record of a file with its mapping, of a bag of standard messages, or of a run of ours.

    Raises ParameterError if there is none.
    """
    path = without_metadata(path)
    name = path.name.removesuffix(".xz")
    # The name of a folder has no suffix: drive_v1.yaml is not that of the bag drive_v1.2.
    beside = path.with_name(f"{name if path.is_dir() else Path(name).stem}.yaml")
    # A mapping goes before all else; without one only bags and recordings of ours explain
    # themselves.
    if mapping or beside.exists() or not (path.is_dir() or path.suffix in _OF_A_RUN):
        return read_record(path, mapping or beside)
    if path.suffix != ".npz" and is_foreign(path):
        return read_standard(path)
    found = find_recorded(path)
    time = found.recording.time
    columns = {
        name: (Sampled(time, values), ColumnParameters())
        for name, values in found.recording.channels.items()
    }
    return measured(str(path), _digest(found.source), columns, MaskParameters())


def _digest(path: Path) -> str:
    """SHA-256 of a file, empty of a folder."""
    return hashlib.sha256(read_data(path, SIGNALS)).hexdigest() if path.is_file() else ""
