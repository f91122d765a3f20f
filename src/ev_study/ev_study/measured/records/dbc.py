"""Messages of a DBC file, and what one frame of a message gives of the signals that are wanted."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from ev_core.parameters.data_file import TEXT, read_data
from ev_msgs_py.refusal import ParameterError, first_line, unknown_name

if TYPE_CHECKING:
    from cantools.database.can import Database, Message, Signal

# tried in this order; cp1252 before gbk, which takes its "°C" for one letter
_ENCODINGS = ("utf-8", "cp1252", "gbk")
# source of J1939 that no control unit has: with it a DBC means frames from any source
NULL_ADDRESS = 0xFE


@dataclass
class Wanted:
    """A message, and the signals of it that are wanted, by column."""

    message: Message
    signals: dict[str, Signal] = field(default_factory=dict)


@dataclass
class Decoded:
    """Values of a message from one source, by column, and the frames passed over, by reason."""

    wanted: Wanted
    times: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    values: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    frames: int = 0
    undecoded: Counter[str] = field(default_factory=Counter)
    short: Counter[str] = field(default_factory=Counter)
    outside: Counter[str] = field(default_factory=Counter)

    def add(self, time: float, data: bytes) -> None:
        """Take the signals of a frame: those with all bits in it, within the range of the DBC."""
        from cantools.database.errors import DecodeError

        self.frames += 1
        try:
            # Choices as numbers: a text such as "reverse" is no value over time. Truncated frames
            # still have their first signals.
            decoded = self.wanted.message.decode(data, decode_choices=False, allow_truncated=True)
        except DecodeError as error:
            self.undecoded[first_line(error)] += 1
            return
        # The library gives a list for containers alone, which a DBC does not have.
        assert isinstance(decoded, dict)
        for column, signal in self.wanted.signals.items():
            if signal.name not in decoded:
                # A signal of another page is not missing in this frame; it is short only on its own
                # page.
                pages = signal.multiplexer_ids
                if not pages or decoded.get(signal.multiplexer_signal or "") in pages:
                    self.short[column] += 1
                continue
            value = float(decoded[signal.name])  # type: ignore[arg-type]
            if _is_outside(signal, value):
                self.outside[column] += 1
            else:
                self.times[column].append(time)
                self.values[column].append(value)

    def notes(self) -> tuple[str, ...]:
        """Frames and values passed over, a line for each reason."""
        name, of = self.wanted.message.name, self.frames
        lines = [
            f"{n} of {of} frames of {name} passed over: {why}" for why, n in self.undecoded.items()
        ]
        for column, n in self.short.items():
            lines.append(f"{n} of {of} frames of {name} passed over: too short for {column}")
        for column, n in self.outside.items():
            signal = self.wanted.signals[column]
            lines.append(
                f"{column}: {n} of {of} values passed over, expected in the DBC's range of"
                f" {signal.minimum} to {signal.maximum} {signal.unit or ''}".rstrip()
            )
        return tuple(lines)


def _is_outside(signal: Signal, value: float) -> bool:
    """Return True if a value is beyond the declared range, if any, by more than half a digit."""
    low, high = signal.minimum, signal.maximum
    # [0|0] in a DBC means that no range was declared.
    if low is None or high is None or low >= high:
        return False
    # A limit that is rounded lies up to half a digit beside the raw value.
    digit = 0.5 * abs(float(signal.scale))
    return not float(low) - digit <= value <= float(high) + digit


def wanted_messages(database: Path, wanted: Sequence[str]) -> list[Wanted]:
    """The messages of the columns MESSAGE.SIGNAL.

    Raises ParameterError, in one line, if one is not there or is ambiguous.
    """
    known = _load(database)
    signals = {f"{m.name}.{s.name}": (m, s) for m in known.messages for s in m.signals}
    found: dict[str, Wanted] = {}
    for column in wanted:
        if column not in signals:
            raise unknown_name(f"signal of {database.name}", column, signals)
        message, signal = signals[column]
        found.setdefault(message.name, Wanted(message)).signals[column] = signal
    for each in found.values():
        try:
            # Only of the messages that are used: a fault elsewhere in the file does not matter
            # here.
            each.message.refresh(strict=True)
        except Exception as error:  # of the library: signals over each other, or beyond the message
            raise ParameterError(f"{database}: {first_line(error)}") from None
    return [*found.values()]


def _load(database: Path) -> Database:
    """Load the messages of a file, each checked when it is used: few of them are."""
    from cantools.database import load_string

    try:
        content = read_data(database, TEXT)
    except OSError as error:
        raise ParameterError(f"{database}: {error.strerror or error}") from None
    reason = ""
    for encoding in _ENCODINGS:
        try:
            return load_string(content.decode(encoding), "dbc", strict=False)  # type: ignore[return-value]
        except UnicodeDecodeError:
            continue
        except Exception as error:  # whatever the library raises for what is no database
            reason = reason or f": {' '.join(str(error).split())[:200]}"
    raise ParameterError(f"{database} is no DBC file{reason}")


def id_text(message: Message) -> str:
    """The id of the frames of a message as logs write it."""
    return f"{message.frame_id:08X}" if message.is_extended_frame else f"0x{message.frame_id:03X}"


def group_of(frame_id: int) -> int:
    """Mask an id of J1939: without priority, source, and the destination if it has one."""
    # Below PF 240 the next byte is the destination of the message and belongs to no group.
    destined = (frame_id >> 16) & 0xFF < 240  # PDU1
    return frame_id & (0x03FF0000 if destined else 0x03FFFF00)
