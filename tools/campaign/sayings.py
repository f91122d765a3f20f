"""What a stranger says on the graph: one entry for each act, by the name that a trial chooses it by."""

from __future__ import annotations

import random
import struct
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus, KeyValue
from rcl_interfaces.msg import Log, Parameter, ParameterEvent, ParameterType, ParameterValue
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState
from std_msgs.msg import String

from campaign.spoiling import HOW, spoilt
from ev_core.lockstep.stepper import WRITERS
from ev_msgs_py.contract.frame import Frame, numbers_of
from ev_msgs_py.contract.signals import RecorderProgress, WheelTorqueCommand
from ev_msgs_py.contract.topics import QUEUE_DEPTH, TOPICS
from ev_msgs_py.wire import STAMP_AT, format_of, stamp_alone
from ev_nodes.stepping.signal_io import NAMELESS, QUALITY

ESCAPES = "\x1b[2J\x1b]0;mine\x07\x1b[31m\x9b1A\b\b\r"
INVENTED = (
    "\nerror: node plant was killed by nobody\r\nstopped\n\u2028error: once more\x85error: and"
    " again\n"
)
STEP, SECOND = 10**7, 10**9  # ns
_OTHER = 7.0  # a finite number that no run gives
_MEGABYTE = 10**6
_ALL = tuple(TOPICS)


class Said(NamedTuple):
    """A message, also as bytes, and where it is said; names without a slash are those of the car."""

    topic: str
    kind: type
    message: Any


class Saying(NamedTuple):
    """What is said with a stamp of the run [ns], in each round anew, by a node of this name."""

    about: str
    say: Callable[[random.Random, int], Iterator[Said]]
    node: str = "stranger"
    namespace: str = "/ev"
    quality: QoSProfile = QUALITY


def _signals(
    later: int = 0,
    *,
    at: int | None = None,
    value: float = _OTHER,
    signals: tuple[type, ...] = _ALL,
    how: str = "",
) -> Callable[[random.Random, int], Iterator[Said]]:
    """Signals in their own form, with another number, so much later than the run or `at` a stamp, or `spoilt`."""

    def say(chance: random.Random, stamp: int) -> Iterator[Said]:
        frame = Frame()
        frame.numbers[:] = numbers_of([value] * len(frame.numbers))
        for signal in signals:
            format_ = format_of(signal)
            message = format_.pack(stamp + later if at is None else at, frame)
            if how:
                message = spoilt(message, chance.choice(HOW) if how == "any" else how, chance)
            yield Said(format_.topic.name, format_.message_class, message)

    return say


def _of(role: str) -> tuple[type, ...]:
    return tuple(signal for signal, writer in WRITERS.items() if writer == role)


def _stamped(seconds: int, nanoseconds: int) -> Callable[[random.Random, int], Iterator[Said]]:
    """Signals with a stamp that no clock gives."""
    stamp = struct.pack("<iI", seconds, nanoseconds)

    def say(chance: random.Random, _: int) -> Iterator[Said]:
        for topic, kind, message in _signals()(chance, 0):
            yield Said(topic, kind, message[:STAMP_AT] + stamp + message[STAMP_AT + len(stamp) :])

    return say


def _status(
    name: str = "/ev/plant",
    text: str = "I am nobody",
    values: dict[str, str] | None = None,
    count: int = 1,
) -> Callable[[random.Random, int], Iterator[Said]]:
    """Diagnostics; {} in a name or a key becomes a number."""

    def say(chance: random.Random, _: int) -> Iterator[Said]:
        statuses = [
            DiagnosticStatus(
                level=DiagnosticStatus.ERROR,
                name=name.format(n := chance.randrange(10**6)),
                message=text,
                values=[
                    KeyValue(key=key.format(n), value=value)
                    for key, value in (values or {}).items()
                ],
            )
            for _ in range(count)
        ]
        yield Said("/diagnostics", DiagnosticArray, DiagnosticArray(status=statuses))

    return say


def _timing(value: str) -> Callable[[random.Random, int], Iterator[Said]]:
    keys = ("periods", "lateness", "histogram", "late", "stamp", "rests")
    return _status("/ev/plant: timing", "kept", dict.fromkeys(keys, value))


def _no_text(chance: random.Random, stamp: int) -> Iterator[Said]:
    for said in _status(text="?" * 40)(chance, stamp):
        message = serialize_message(said.message).replace(
            b"?" * 40, chance.randbytes(20) + b"\xff\xc0\xed\xa0\x80" * 4
        )
        yield said._replace(message=message)


def _other_clock(chance: random.Random, stamp: int) -> Iterator[Said]:
    said = stamp + chance.randrange(-SECOND, 10 * SECOND) if stamp > SECOND else 10**12
    yield Said("/clock", Clock, stamp_alone(said))


def _joints(names: list[str], count: int) -> Callable[[random.Random, int], Iterator[Said]]:
    """States of joints that are not those of a car; their arrays have `count` numbers."""

    def say(_: random.Random, stamp: int) -> Iterator[Said]:
        message = JointState(
            name=names,
            position=[_OTHER] * count,
            velocity=[_OTHER] * count,
            effort=[_OTHER] * count,
        )
        message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp, SECOND)
        message.header.frame_id = "base_link"
        for signal in (WheelTorqueCommand, *_of("plant")):
            if TOPICS[signal].message_type == "sensor_msgs/msg/JointState":
                yield Said(TOPICS[signal].name, JointState, message)

    return say


def _other_type(_: random.Random, stamp: int) -> Iterator[Said]:
    for topic in (*(topic.name for topic in TOPICS.values()), "/diagnostics"):
        yield Said(topic, String, String(data=f"{ESCAPES}{INVENTED}{stamp}"))


def _log(_: random.Random, __: int) -> Iterator[Said]:
    yield Said(
        "/rosout",
        Log,
        Log(level=50, name="ev.plant", msg=ESCAPES + INVENTED, file=ESCAPES, function=INVENTED),
    )


def _parameter_event(chance: random.Random, _: int) -> Iterator[Said]:
    value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=float("nan"))
    changed = [Parameter(name=f"real_time_factor{INVENTED}{chance.randrange(100)}", value=value)]
    yield Said(
        "/parameter_events",
        ParameterEvent,
        ParameterEvent(node="/ev/plant", changed_parameters=changed),
    )


def _both(
    *parts: Callable[[random.Random, int], Iterator[Said]],
) -> Callable[[random.Random, int], Iterator[Said]]:
    def say(chance: random.Random, stamp: int) -> Iterator[Said]:
        for part in parts:
            yield from part(chance, stamp)

    return say


_BEST_EFFORT = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
_KEEPS = QoSProfile(depth=QUEUE_DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_PROGRESS = (RecorderProgress,)

SAYINGS = {
    "same stamp": Saying("other numbers under the right stamp", _signals()),
    "next stamp": Saying("other numbers of the next step", _signals(STEP)),
    "later stamp": Saying("other numbers of a time to come", _signals(5 * SECOND)),
    "stamp zero": Saying("as if all began anew", _signals(at=0)),
    "spoilt": Saying("messages that nobody can read or believe", _signals(how="any")),
    "not finite": Saying("NaN in all places", _signals(value=float("nan"))),
    "infinite": Saying("infinities in all places", _signals(STEP, value=float("-inf"))),
    "stamp below zero": Saying("a time before all others", _stamped(-(2**31), 0)),
    "nanoseconds without end": Saying("more nanoseconds than a second has", _stamped(0, 2**32 - 1)),
    "largest stamp": Saying("the last time that there is", _stamped(2**31 - 1, SECOND - 1)),
    "clock": Saying("other times", _other_clock),
    "best effort": Saying("another quality of service, less", _signals(STEP), quality=_BEST_EFFORT),
    "transient local": Saying("another quality of service, more", _signals(STEP), quality=_KEEPS),
    "another type": Saying("texts on all topics", _other_type),
    "joints of a megabyte": Saying("joint states that are large", _joints(["front_left"], _MEGABYTE // 24)),
    "10^5 joints": Saying("joint states with many names", _joints([f"j{n}" for n in range(10**5)], 0)),
    "joints without names": Saying("joint states whose numbers are nobody's", _joints([], 4)),
    "twin of asr": Saying("a second node asr", _signals(STEP, signals=_of("asr")), "asr"),
    "twin of the plant": Saying("a second plant, which begins anew", _signals(at=0, signals=_of("plant")), "plant"),
    "recorder far ahead": Saying(
        "a second recorder, which holds all", _signals(1000 * SECOND, signals=_PROGRESS), "recorder"
    ),
    "recorder at zero": Saying("a second recorder, which holds nothing", _signals(at=0, signals=_PROGRESS), "recorder"),
    "twin of the runner": Saying("a second run_scenario", _both(_signals(), _status(), _other_clock), "run_scenario"),
    "asr of another car": Saying("a node asr elsewhere, on our topics", _signals(STEP), "asr", "/other"),
    "asr of no name space": Saying("a node asr at the root, on our topics", _signals(STEP), "asr", "/"),
    "nameless": Saying("a node called as what has no name", _signals(STEP), f"{NAMELESS}asr{NAMELESS}"),
    "diagnostics": Saying("an error of the plant", _status()),
    "role that is not here": Saying("a bench without part", _both(_status("/ev/test_bench"), _signals()), "test_bench"),
    "gateway that is not here": Saying("a gateway in error", _status("/ev/inverter_gateway"), "inverter_gateway"),
    "timing without values": Saying("timing of real time, without numbers", _status("/ev/plant: timing")),
    "timing is no JSON": Saying("timing that cannot be read", _timing("{'a': ]")),
    "timing is a list": Saying("timing in another form", _timing("[1, [2], null]")),
    "timing is nested": Saying("timing nested 100 000 deep", _timing("[" * 10**5)),
    "timing is not finite": Saying("timing with NaN", _timing("NaN")),
    "escape sequences": Saying("what a terminal obeys", _status(f"/ev/asr{ESCAPES}", ESCAPES, {"noted": ESCAPES})),
    "invented lines": Saying("lines that look like ours", _status(f"/ev/asr{INVENTED}", INVENTED, {"noted": INVENTED})),
    "megabyte of text": Saying("a long word", _status(text="word " * (_MEGABYTE // 5))),
    "10 000 statuses": Saying("many words at once", _status("/ev/asr{}", count=10**4)),
    "says paused": Saying("that time was stopped", _status("/ev/plant: time", "paused at 0.1 s", {"rests": "True"})),
    "notes without end": Saying("a new note each time", _status("/ev/n{}", "a note", {"noted": "{}", "{}": ""}, 50)),
    "no text": Saying("bytes that are no UTF-8", _no_text),
    "rosout": Saying("log messages of the plant", _log),
    "parameter events": Saying("changes that never were", _parameter_event),
}  # fmt: skip
