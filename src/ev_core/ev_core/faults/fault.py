"""One fault as a text, KIND WHERE [VALUE] [from SECONDS] [until SECONDS], and all kinds."""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

from ev_core.parameters.declaration import setting
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name

SYNTAX = "KIND WHERE [VALUE] [from SECONDS] [until SECONDS]"
BATTERY = "battery"
_NEVER = 1e18  # periods: finite, so that compiled code may count with it
_TOLERANCE = 1e-6  # of a period: 0.3 s are 30 periods of 0.01 s, though 0.3/0.01 is a little less


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of fault.

    Its value lies within `low` to `high` in `unit`; it has none where both are the same.
    """

    about: str
    unit: str = ""
    low: float = 0.0
    high: float = 0.0

    @property
    def has_value(self) -> bool:
        """True if a fault of this kind has a value."""
        return self.low < self.high


# Kinds that strike numbers in messages, be it in a sensor, its wire, or on the bus; in the order of
# their codes.
OF_SIGNALS = {
    "constant": Kind(
        "shows the value, whatever is true: 0 is a broken wire", "of the number", -1e6, 1e6
    ),
    "scaled": Kind("shows the true number times the value", "1", -100.0, 100.0),
    "offset": Kind("shows the true number plus the value", "of the number", -1e6, 1e6),
    "noisy": Kind("adds Gaussian noise with this standard deviation", "of the number", 0.0, 1e6),
    "tilted": Kind(
        "an accelerometer out of the level by this angle shows a cos + g sin of it",
        "rad",
        -1.5,
        1.5,
    ),
    "swapped": Kind("two numbers, NUMBER,NUMBER, in each other's place"),
    "frozen": Kind("keeps what it showed last"),
    "lost": Kind(
        "is lost with this probability in a period: readers keep the last one", "1", 0.0, 1.0
    ),
    "delayed": Kind("comes so much later, in whole control periods", "s", 1e-4, 10.0),
    "reordered": Kind(
        "with this probability two in a row arrive in the wrong order", "1", 0.0, 1.0
    ),
    "restarted": Kind(
        "the node that writes it is killed, and begins anew when the fault ends; readers keep the "
        "last"
    ),
}

# Kinds that strike the car itself, where the plant has them.
OF_THE_CAR = {
    "motor_share": Kind(
        "the motor gives this share of what it is asked for: 0 is a dead motor", "1", 0.0, 1.0
    ),
    "motor_stuck": Kind("the motor keeps the torque that it has when the fault begins"),
    "inverter_trip": Kind(
        "asked for more than the value, the inverter switches off", "N m at the shaft", 0.0, 1e5
    ),
    "inverter_delay": Kind(
        "the inverter gets its command later, in whole control periods", "s", 0.0, 0.5
    ),
    "hall_stuck": Kind("one of the three Hall sensors of a brushless motor always shows 1"),
    "battery_share": Kind(
        "the battery's power limits are this share of themselves: 0 is a cut-off", "1", 0.0, 1.0
    ),
    "puncture": Kind("the tyre loses this share of its air", "1", 0.0, 1.0),
}
KINDS = {**OF_SIGNALS, **OF_THE_CAR}

# Wheels by what a fault may name: one wheel, an axle, a side, or all.
_SOME_WHEELS: dict[str, tuple[str, ...]] = {name: (name,) for name in WHEEL_NAMES}
for _side in ("front", "rear", "left", "right"):
    _SOME_WHEELS[_side] = tuple(name for name in WHEEL_NAMES if _side in name)
_SOME_WHEELS["all"] = WHEEL_NAMES


def faults_parameter() -> Any:
    """Declare the one parameter `faults`."""
    return setting((), about=f"what goes wrong, each as {SYNTAX} (docs/faults.md)")


@dataclass(frozen=True, slots=True)
class FaultParameters:
    """The faults of a node with a method that does not ask for them itself."""

    faults: tuple[str, ...] = faults_parameter()


class Fault(NamedTuple):
    """One fault: its kind, its place, its value, and its begin and end [s]."""

    text: str
    kind: str
    where: str
    value: float
    begin: float
    end: float

    def periods(self, period: float) -> tuple[float, float]:
        """The first control period with it, and the first one without it again."""
        begin = float(math.ceil(self.begin / period - _TOLERANCE))
        if self.end == math.inf:
            return begin, _NEVER
        end = float(math.ceil(self.end / period - _TOLERANCE))
        return begin, min(end, _NEVER)

    def wheels(self) -> tuple[float, ...]:
        """1 for each wheel that it strikes."""
        return tuple(float(name in _SOME_WHEELS.get(self.where, ())) for name in WHEEL_NAMES)


def parsed(texts: tuple[str, ...]) -> list[Fault]:
    """The faults in these texts; ParameterError, in one line, for a text that is none."""
    return [_fault(text) for text in texts]


def _fault(text: str) -> Fault:
    words = text.split()
    if len(words) < 2:
        raise ParameterError(f"faults: {quoted(text)} is refused, expected {SYNTAX}")
    name, where, *rest = words
    if name not in KINDS:
        raise ParameterError(
            f"faults: {quoted(text)}: {unknown_name('kind of fault', name, KINDS)}"
        )
    kind = KINDS[name]
    value = 0.0
    if kind.has_value:
        if not rest or rest[0] in ("from", "until"):
            raise ParameterError(
                f"faults: {quoted(text)} lacks its value, {kind.low:g} to {kind.high:g} {kind.unit}"
            )
        value = _number(text, rest.pop(0), kind.low, kind.high, kind.unit)
    times = {"from": 0.0, "until": math.inf}
    # What is left are pairs of a word and a time, each word once at most.
    given = rest[::2]
    if len(rest) % 2 or len(set(given)) < len(given) or not set(given) <= set(times):
        raise ParameterError(f"faults: {quoted(text)} is refused, expected {SYNTAX}")
    for word, time in zip(given, rest[1::2], strict=True):
        times[word] = _number(text, time, 0.0, 1e9, "s")
    if times["from"] >= times["until"]:
        raise ParameterError(
            f"faults: {quoted(text)} ends at {times['until']:g} s, expected after its begin"
        )
    if name in OF_THE_CAR:
        allowed = (BATTERY,) if name == "battery_share" else tuple(_SOME_WHEELS)
        if where not in allowed:
            raise ParameterError(
                f"faults: {quoted(text)}: {where} is refused, expected {', '.join(allowed)}"
            )
    return Fault(text, name, where.replace("/", "."), value, times["from"], times["until"])


def _number(text: str, word: str, low: float, high: float, unit: str) -> float:
    try:
        value = float(word)
    except ValueError:
        value = math.nan
    if not low <= value <= high:
        raise ParameterError(
            f"faults: {quoted(text)}: {word} is refused, expected {low:g} to {high:g} {unit}"
        )
    return value
