"""Signals of a log of a CAN bus, as a DBC file names them.

How it works: the DBC gives the wanted messages by id; frames of the log are looked up by id, or by
parameter group where the DBC leaves the source of J1939 open. Each source (bus and id) collects its
own values, and only at the end one source per message is chosen: two of them would be mixed
otherwise.
"""

from __future__ import annotations

import hashlib
import io
import re
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ev_core.parameters.data_file import SIGNALS, open_data, read_data
from ev_msgs_py.refusal import ParameterError
from ev_study.measured.records.dbc import (
    NULL_ADDRESS,
    Decoded,
    Wanted,
    group_of,
    id_text,
    wanted_messages,
)
from ev_study.measured.records.record import Read
from ev_study.measured.records.samples import Sampled

if TYPE_CHECKING:
    import can

_NAMES = {"can": "python-can"}
Source = tuple[str, int]  # bus and id of a frame
_FROM_ZERO = (".asc", ".blf")  # formats with buses that python-can counts from 0, the files from 1
# candump, text of Vector and of PEAK, Vector's binary, ASAM MDF
SUFFIXES = (".log", ".asc", ".trc", ".blf", ".mf4")
# The head of an .asc file in which each time counts from the line before.
_RELATIVE = re.compile(r"^base\s+\w+\s+timestamps\s+relative", re.IGNORECASE | re.MULTILINE)
# The line of a frame begins with its time; no other line begins with such a number.
_TIMED = re.compile(r"^(\s*)(-?\d+\.\d+)(?=\s)", re.MULTILINE)


def read_columns(log: Path, database: Path, wanted: Sequence[str], channel: str = "") -> Read:
    """Read the signals MESSAGE.SIGNAL over the times of their frames.

    With them come the SHA-256 of the log and the units of the DBC. `channel` is the bus that is
    read where several carry the same message. A message of J1939 with the null address as its
    source in the DBC is read from any source. Frames without the bits of a signal, pages of a
    multiplexer that the DBC does not have, and values beyond its range are passed over and counted.
    ParameterError, in one line, if log or database cannot be read, if a message or signal is not in
    the database, has several sources, or never came.
    """
    # Named before anything is read, so that a missing package is no error of the log.
    for package in ("can", "cantools", *(("asammdf",) if log.suffix.lower() == ".mf4" else ())):
        if find_spec(package) is None:
            raise ParameterError(
                f"{log} needs the Python package {_NAMES.get(package, package)}, which is missing"
            )
    messages = wanted_messages(database, wanted)
    by_id = {(each.message.frame_id, each.message.is_extended_frame): each for each in messages}
    by_group = {}
    for each in messages:
        # The last byte of an extended id is the source.
        if each.message.is_extended_frame and each.message.frame_id & 0xFF == NULL_ADDRESS:
            by_group[group_of(each.message.frame_id)] = each
    decoded: dict[str, dict[Source, Decoded]] = {each.message.name: {} for each in messages}
    others: set[int] = set()  # extended ids that are not wanted
    digest = _digest(log)
    for frame in _frames(log):
        # An exact id goes before a group: the DBC may name one source and leave others open.
        found = by_id.get((frame.arbitration_id, frame.is_extended_id))
        if found is None and frame.is_extended_id:
            found = by_group.get(group_of(frame.arbitration_id))
            # Kept for the hint on an id that differs in priority or source alone.
            others.add(frame.arbitration_id)
        if found is None:
            continue
        source = (_bus(log, frame), frame.arbitration_id)
        of = decoded[found.message.name].setdefault(source, Decoded(found))
        of.add(frame.timestamp, bytes(frame.data))
    columns: dict[str, Sampled] = {}
    units: dict[str, str] = {}
    notes: list[str] = []
    for each in messages:
        chosen = _chosen(log, each, decoded[each.message.name], channel, others)
        notes += chosen.notes()
        for column, signal in each.signals.items():
            if not chosen.times[column]:
                reasons = "; ".join(("", *chosen.notes()))
                raise ParameterError(f"{log} has no frame with {column} that can be read{reasons}")
            columns[column] = Sampled(
                np.array(chosen.times[column]), np.array(chosen.values[column])
            )
            units[column] = signal.unit or ""
    return Read(columns, digest, units, tuple(notes))


def _bus(log: Path, frame: can.Message) -> str:
    """The bus of a frame as the log has it."""
    if isinstance(frame.channel, int) and log.suffix.lower() in _FROM_ZERO:
        return str(frame.channel + 1)
    return "" if frame.channel is None else str(frame.channel)


def _chosen(
    log: Path, wanted: Wanted, decoded: dict[Source, Decoded], channel: str, others: set[int]
) -> Decoded:
    """The frames of a message from the one source that has it.

    Raises ParameterError if there is none, or more than one.
    """
    name, message = next(iter(wanted.signals)), wanted.message
    if not decoded:
        alike = sorted(each for each in others if group_of(each) == group_of(message.frame_id))
        hint = f": the DBC has it as {id_text(message)}"
        if message.is_extended_frame and alike:
            hint += (
                f", the log has {', '.join(f'{each:08X}' for each in alike)}; priority or source"
                " differ"
            )
        raise ParameterError(f"{log} has no frame with {name}{hint}")
    # A channel of the mapping that has none of the message is no filter: the message is on another
    # bus.
    on_channel = {source: each for source, each in decoded.items() if source[0] == channel}
    decoded = on_channel or decoded
    buses = sorted({bus for bus, _ in decoded})
    if len(buses) > 1:
        raise ParameterError(
            f"{log}: {id_text(message)} ({message.name}) is on {' and '.join(buses)}, "
            "expected one of them as `channel` in the mapping"
        )
    if len(decoded) > 1:
        ids = " and ".join(f"{each:08X}" for _, each in sorted(decoded))
        raise ParameterError(
            f"{log}: {message.name} comes as {ids}, expected a DBC with one of these ids for it"
        )
    return next(iter(decoded.values()))


def _digest(log: Path) -> str:
    try:
        with open_data(log, SIGNALS) as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as error:
        raise ParameterError(f"{log}: {error.strerror or error}") from None


def _frames(log: Path) -> Iterator[can.Message]:
    """The frames of data of a log.

    Raises ParameterError, in one line that has the last good one, if it cannot be read on.
    """
    import can

    number, last = 0, 0.0
    try:
        # .asc is read from a corrected text (`_absolute`), all other formats by the suffix.
        with (
            can.ASCReader(_absolute(log)) if log.suffix.lower() == ".asc" else can.LogReader(log)
        ) as reader:
            for frame in reader:
                number, last = number + 1, frame.timestamp
                # They carry no data of a signal.
                if not (frame.is_error_frame or frame.is_remote_frame):
                    yield frame
    except ParameterError:
        raise
    except OSError as error:
        raise ParameterError(f"{log}: {error.strerror or error}") from None
    except Exception as error:  # whatever the libraries raise for what is no log
        behind = f" behind frame {number} at {last:.6f} s" if number else ""
        raise ParameterError(
            f"{log}: the log cannot be read{behind}: {' '.join(str(error).split())[:200]}"
        ) from None


def _absolute(log: Path) -> io.StringIO:
    """The text of an .asc file with times from its first line on, none of them negative.

    python-can passes over lines with negative times, and takes times since the line before for
    times since the start.
    """
    text = read_data(log, SIGNALS).decode("utf-8", errors="replace")
    # One pass for the times and one for the text: the shift is known when all times are.
    times = np.array([float(match[2]) for match in _TIMED.finditer(text)])
    if _RELATIVE.search(text):
        times = np.cumsum(times)
    times = iter(times - min(times.min(initial=0.0), 0.0))
    return io.StringIO(_TIMED.sub(lambda match: f"{match[1]}{next(times):.9f}", text))
