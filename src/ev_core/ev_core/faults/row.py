"""Faults of signals in the frame.

How it works: behind an object and its sensors the faults put their output into the place of the
numbers, once per control period. A fault that knows earlier numbers remembers them also while it
does not strike, so that it has them when it begins. A row of numbers has the settings of the faults
behind one object, another one what lasts between periods:

    constants  total  size of the state  entries  period [s]
               then of each entry the numbers KIND to OTHER_UNSIGNED
    state      for each entry that remembers: whether it has begun, then the numbers

`FaultRow` makes both rows, and steps them in plain Python.
"""

import zlib
from collections.abc import Iterator, Sequence

from ev_core.elementary import cos, sin
from ev_core.faults.fault import OF_SIGNALS, Fault, parsed
from ev_core.sensors.measuring import Numbers, carried
from ev_core.sensors.random_numbers import WORD, normals, philox, uniform
from ev_core.sensors.row import Row
from ev_core.vehicle.car import GRAVITY
from ev_msgs_py.compilable import compilable
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.frame import TIME
from ev_msgs_py.contract.roles import ROLES, RoleKind
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name

CONSTANT, SCALED, OFFSET, NOISY, TILTED, SWAPPED, FROZEN, LOST, DELAYED, REORDERED, RESTARTED = (
    range(len(OF_SIGNALS))
)

# The settings of an entry, one fault of one number. OTHER is the place of the number that it is
# swapped with, NUMBER its own among those of the fault, MEMORY where the state has what it
# remembers, LENGTH numbers. A message carries PLACE in single precision if it ROUNDS; a command
# that is UNSIGNED ends at 0, as no brake gives less.
FAULT_WIDTH = 15
KIND, PLACE, OTHER, BEGIN, END, VALUE, SEED, FAULT_NAME, NUMBER, MEMORY, LENGTH = range(11)
ROUNDS, OTHER_ROUNDS, UNSIGNED, OTHER_UNSIGNED = range(11, FAULT_WIDTH)
FAULTS_HEAD = 4

# The last word of the counter is the purpose of a random number; sensors have 0 and 1.
FOR_NOISE, FOR_LOSS = 2, 3
_CODES = list(OF_SIGNALS)
_PAIR = 2
# Kinds that remember one number; a delay remembers one for each period.
_KEEP_ONE = ("frozen", "lost", "reordered", "restarted")


@compilable
def strike(frame: Numbers, state: Numbers, faults: Sequence[float]) -> None:
    """Let all faults do what they do to the numbers in a frame, one after the other."""
    period = int(frame[TIME] / faults[3] + 0.5)
    for n in range(int(faults[2])):
        begin = FAULTS_HEAD + n * FAULT_WIDTH
        suffer(frame, state, faults[begin : begin + FAULT_WIDTH], period)


@compilable
def suffer(frame: Numbers, state: Numbers, c: Sequence[float], period: int) -> None:
    """One fault of one number."""
    place, kind, value = int(c[PLACE]), c[KIND], c[VALUE]
    is_on = c[BEGIN] <= period < c[END]
    true = frame[place]
    if c[LENGTH] > 0.0:
        shown = remembered(state, c, period, is_on, true)
        frame[place] = shown if is_on else true
        return
    if not is_on:
        return
    if kind == SWAPPED:
        other = int(c[OTHER])
        frame[place] = sent(frame[other], c[ROUNDS], c[UNSIGNED])
        frame[other] = sent(true, c[OTHER_ROUNDS], c[OTHER_UNSIGNED])
        return
    shown = value
    if kind == SCALED:
        shown = true * value
    elif kind == OFFSET:
        shown = true + value
    elif kind == NOISY:
        w0, w1, w2, w3 = words(c, period, int(c[NUMBER]), FOR_NOISE)
        normal, _ = normals(w0, w1, w2, w3)
        shown = true + value * normal
    elif kind == TILTED:
        shown = true * cos(value) + GRAVITY * sin(value)
    frame[place] = sent(shown, c[ROUNDS], c[UNSIGNED])


@compilable
def sent(number: float, rounds: float, unsigned: float) -> float:
    """A number as a message carries it."""
    return 0.0 if unsigned == 1.0 and number < 0.0 else carried(number, rounds)


@compilable
def remembered(state: Numbers, c: Sequence[float], period: int, is_on: bool, true: float) -> float:
    """The number shown by a fault that knows earlier numbers, and remembers this one."""
    begun, length, kind = int(c[MEMORY]), int(c[LENGTH]), c[KIND]
    memory = begun + 1
    if state[begun] == 0.0:
        state[begun] = 1.0
        for age in range(length):
            state[memory + age] = true
    if kind == DELAYED:
        here = memory + period % length
        shown = state[here]
        state[here] = true
        return shown
    if kind == REORDERED:
        # The first of a pair comes when the second one is expected, and the second one before it,
        # unheeded.
        shown = state[memory]
        state[memory] = true
        return shown if is_drawn(c, period // 2) else true
    if not is_on or (kind == LOST and not is_drawn(c, period)):
        state[memory] = true
    return state[memory]


@compilable
def words(c: Sequence[float], period: int, block: int, purpose: int) -> tuple[int, int, int, int]:
    """Four random words of a fault in a period; the key is the seed and the text of the fault."""
    return philox(period & WORD, period >> 32, block, purpose, int(c[SEED]), int(c[FAULT_NAME]))


@compilable
def is_drawn(c: Sequence[float], period: int) -> bool:
    """Return whether a fault happens in a period, to all its numbers at once.

    Its value is the probability.
    """
    w0, w1, _, _ = words(c, period, 0, FOR_LOSS)
    return uniform(w0, w1) < c[VALUE]


def of_signals(texts: tuple[str, ...]) -> list[Fault]:
    """Those of some faults that are of signals."""
    return [fault for fault in parsed(texts) if fault.kind in OF_SIGNALS]


class FaultRow(Row):
    """Faults of signals that an object with these `writes` publishes.

    `constants` and `state` are as above. ParameterError for a number that is not among them.
    """

    head = FAULTS_HEAD
    width = FAULT_WIDTH
    key = (FAULT_NAME, NUMBER, LENGTH)
    memory = MEMORY

    def __init__(
        self, faults: Sequence[Fault], writes: tuple[type, ...], seed: int, period: float
    ) -> None:
        self.constants = [0.0] * FAULTS_HEAD
        texts = [fault.text for fault in faults]
        for n, fault in enumerate(faults):
            # Two of one text have random numbers of their own.
            again = texts[:n].count(fault.text)
            text = f"{fault.text} {again}" if again else fault.text
            name = zlib.crc32(text.encode())
            for numbers in self._entries(fault, writes, seed, name, period):
                self.constants += numbers
        total = len(self.constants)
        self.constants[:FAULTS_HEAD] = (
            float(total),
            float(self._size),
            float((total - FAULTS_HEAD) // FAULT_WIDTH),
            period,
        )
        self.start()

    def _entries(
        self, fault: Fault, writes: tuple[type, ...], seed: int, name: int, period: float
    ) -> Iterator[list[float]]:
        begin, end = fault.periods(period)
        struck = channels_of(fault, writes)
        # Only `swapped` has two numbers in an entry, any other fault one number twice.
        pairs = [struck] if fault.kind == "swapped" else [(channel, channel) for channel in struck]
        length = 0
        if fault.kind == "delayed":
            length = max(round(fault.value / period), 1)
        elif fault.kind in _KEEP_ONE:
            length = 1
        for number, (one, other) in enumerate(pairs):
            _, place, rounds, unsigned = one
            _, other_place, other_rounds, other_unsigned = other
            memory = self._size
            if length:
                self._size += 1 + length
            # In the order of the settings above.
            settings = (
                _CODES.index(fault.kind),
                place,
                other_place,
                begin,
                end,
                fault.value,
                seed,
                name,
                number,
                memory,
                length,
                rounds,
                other_rounds,
                unsigned,
                other_unsigned,
            )
            yield [float(value) for value in settings]

    def step(self, numbers: Numbers) -> None:
        """Put what the faults leave of them into the place of the numbers in a frame.

        It is called once per period.
        """
        strike(numbers, self.state, self.constants)


def channels_of(fault: Fault, writes: tuple[type, ...]) -> list[tuple[str, int, bool, bool]]:
    """Return name, place in the frame, single precision and unsigned command of struck numbers.

    ParameterError if a fault names none.
    """
    known = {}
    for signal in writes:
        shape = shape_of(signal)
        places = frame.places(signal)
        for i, name in enumerate(TOPICS[signal].channels):
            known[name] = (name, places[i], shape.single[i], i in shape.unsigned_commands)
    topics = {TOPICS[signal].name.replace("/", ".") for signal in writes}
    # A node that is killed has no output at all, so it is named by any of its topics.
    if fault.kind == "restarted":
        if fault.where not in topics:
            unknown = unknown_name("topic of this node", fault.where, topics)
            raise ParameterError(f"faults: {quoted(fault.text)}: {unknown}")
        return list(known.values())
    found = []
    for where in fault.where.split(","):
        here = [known[name] for name in known if name == where or name.startswith(f"{where}.")]
        if not here:
            # A node has up to hundreds of numbers: those of the topic that was meant are listed.
            topic = where.partition(".")[0]
            listed = [name for name in known if name.partition(".")[0] == topic] or topics
            unknown = unknown_name("number of this node", where, listed)
            raise ParameterError(f"faults: {quoted(fault.text)}: {unknown}")
        found += here
    if fault.kind == "swapped" and (len(found) != _PAIR or found[0] == found[1]):
        raise ParameterError(
            f"faults: {quoted(fault.text)} names {len(found)} numbers, expected two, NUMBER,NUMBER"
        )
    if fault.kind == "tilted" and not all("acceleration" in name for name, *_ in found):
        raise ParameterError(f"faults: {quoted(fault.text)}: expected accelerations of imu")
    return found


def refuse_faults(
    role: str, texts: tuple[str, ...], writes: tuple[type, ...], has_car: bool, period: float
) -> None:
    """Refuse, in one line, a fault that a method of a role with these `writes` cannot have.

    Nor may one lie between two instants, which are a control period [s] apart: it would never
    strike.
    """
    for fault in parsed(texts):
        begin, end = fault.periods(period)
        if begin >= end:
            raise ParameterError(
                f"faults: {quoted(fault.text)} strikes at no instant, "
                f"expected one that lasts over a multiple of control_period, {period:g} s"
            )
        if fault.kind in OF_SIGNALS:
            channels_of(fault, writes)
        elif not has_car:
            known = ", ".join(_CODES)
            raise ParameterError(
                f"faults: {quoted(fault.text)} is refused at this {role}, expected {known}"
            )
        if fault.kind == "restarted" and ROLES[role].kind is not RoleKind.ANSWERS:
            why = "which is a thing and no program"
            raise ParameterError(f"faults: {quoted(fault.text)} is refused at a {role}, {why}")
